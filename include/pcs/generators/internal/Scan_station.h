// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// One station of the virtual scanner: its beams and their returns.

#ifndef PCS_GENERATORS_INTERNAL_SCAN_STATION_H
#define PCS_GENERATORS_INTERNAL_SCAN_STATION_H

#include <pcs/core/errors.h>
#include <pcs/generators/Virtual_scanner.h>
#include <pcs/generators/internal/Ray_tree.h>
#include <pcs/generators/internal/Scene.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/constants.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

constexpr int label_ghost = -1, label_ground = -2, label_leaf = -3, label_post = -4;

struct Scan_return
{
  Eigen::Vector3d point;
  int label;
};

/*
  The beam grid covers only the directions from the station to the triangles of the scene. Each beam
  has a separate random stream.
*/
class Scan_station
{
public:
  Scan_station(const Virtual_scanner& scanner,
               std::uint64_t seed,
               std::size_t number,
               const Eigen::Vector3d& position,
               const std::vector<Triangle>& triangles)
    : m_scanner(scanner), m_seed(seed), m_number(number), m_position(position)
  {
    Random_stream random(seed, 20, number);
    for (int axis = 0; axis < 3; ++axis)
      m_shift[axis] = scanner.registration_error * random.normal();
    if (!triangles.empty())
      set_grid(triangles, random);
    for (std::size_t k = 0; k < m_rolls.size(); ++k) {
      const double roll = pcs::internal::pi * double(k) / double(m_rolls.size());
      m_rolls[k] = 0.5 * scanner.beam_width * Eigen::Vector2d(std::cos(roll), std::sin(roll));
    }
  }

  std::size_t number_of_rows() const { return m_rows; }
  std::size_t number_of_columns() const { return m_directions.size(); }

  //! emits the beams of one row
  void scan_row(const Ray_tree& tree,
                const Scene& scene,
                std::size_t row,
                std::vector<Scan_return>& returns) const
  {
    const double elevation = m_low + double(row) * m_scanner.angular_step;
    const double c = std::cos(elevation), s = std::sin(elevation);
    Beam beam;
    beam.origin = m_position.cast<float>();
    for (std::size_t column = 0; column < m_directions.size(); ++column) {
      const Eigen::Vector2d& azimuth = m_directions[column];
      const Eigen::Vector3d direction(c * azimuth.x(), c * azimuth.y(), s);
      Random_stream random(m_seed, m_number, row, column);
      // two rays on opposite sides of the central one; the fourth lane repeats the central ray
      const Eigen::Vector2d& roll = m_rolls[random.bits() % m_rolls.size()];
      const Eigen::Vector3d side =
          roll.x() * Eigen::Vector3d(-azimuth.y(), azimuth.x(), 0) +
          roll.y() * Eigen::Vector3d(-s * azimuth.x(), -s * azimuth.y(), c);
      beam.direction[0] = beam.direction[3] = direction.cast<float>();
      beam.direction[1] = (direction + side).cast<float>();
      beam.direction[2] = (direction - side).cast<float>();
      const Beam_hits hits = tree.first_hits(beam);
      add_return(hits, scene, direction, random, returns);
    }
  }

private:
  static constexpr float none = std::numeric_limits<float>::infinity();

  //! intervals of azimuth (relative to the front) and elevation that enclose given boxes
  struct Window
  {
    double left = pcs::internal::pi, right = -pcs::internal::pi, down = pcs::internal::pi / 2,
           up = -pcs::internal::pi / 2;

    //! adds a box; `low` and `high` are relative to the station
    void
    extend(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Eigen::Vector2d& front)
    {
      const double gap_x = std::max({0.0, low.x(), -high.x()});
      const double gap_y = std::max({0.0, low.y(), -high.y()});
      const double near = std::hypot(gap_x, gap_y);
      const double far = std::hypot(std::max(-low.x(), high.x()), std::max(-low.y(), high.y()));
      up = std::max(up, std::atan2(high.z(), high.z() > 0 ? near : far));
      down = std::min(down, std::atan2(low.z(), low.z() < 0 ? near : far));
      bool is_ahead = near > 0;
      for (const double x : {low.x(), high.x()})
        for (const double y : {low.y(), high.y()}) {
          const double ahead = front.x() * x + front.y() * y;
          const double azimuth = std::atan2(front.x() * y - front.y() * x, ahead);
          left = std::min(left, azimuth);
          right = std::max(right, azimuth);
          is_ahead = is_ahead && ahead > 0;
        }
      // the azimuths of the corners do not bound a box beside, behind or around the station
      if (!is_ahead) {
        left = -pcs::internal::pi;
        right = pcs::internal::pi;
      }
    }
  };

  void set_grid(const std::vector<Triangle>& triangles, Random_stream& random)
  {
    // neighbours in the list are close in space, so bounding boxes of groups suffice
    constexpr std::size_t group = 32;
    std::vector<Eigen::AlignedBox3f> boxes((triangles.size() + group - 1) / group);
    Eigen::AlignedBox3f whole;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const Triangle& t = triangles[i];
      Eigen::AlignedBox3f& box = boxes[i / group];
      box.extend(t.corner).extend(Vector3f(t.corner + t.edge_1));
      box.extend(Vector3f(t.corner + t.edge_2));
    }
    for (const Eigen::AlignedBox3f& box : boxes)
      whole.extend(box);
    const Eigen::Vector3d middle = whole.center().cast<double>() - m_position;
    const double front = std::atan2(middle.y(), middle.x());
    const Eigen::Vector2d toward(std::cos(front), std::sin(front));
    Window window;
    for (const Eigen::AlignedBox3f& box : boxes)
      window.extend(box.min().cast<double>() - m_position,
                    box.max().cast<double>() - m_position,
                    toward);
    // a beam beside the tree may hit it because of its width
    const double margin = 0.5 * m_scanner.beam_width;
    const double down = window.down - margin, up = window.up + margin;
    const double left = window.left - margin, right = window.right + margin;
    const double step = m_scanner.angular_step;
    m_low = down - random.uniform() * step;
    const double first = front + left - random.uniform() * step;
    const double columns =
        std::min(std::floor((right - left) / step) + 2, std::ceil(2 * pcs::internal::pi / step));
    const double rows = std::floor((up - down) / step) + 2;
    if (!(rows * columns < 4e9))
      throw Invalid_input("pcs::scan_tree(): a station would send " +
                          pcs::internal::to_text(rows * columns) +
                          " beams, at most 4e9 are possible; enlarge `angular_step`");
    m_rows = static_cast<std::size_t>(rows);
    for (std::size_t i = 0; i < static_cast<std::size_t>(columns); ++i) {
      const double azimuth = first + double(i) * step;
      m_directions.emplace_back(std::cos(azimuth), std::sin(azimuth));
    }
  }

  void add_return(const Beam_hits& hits,
                  const Scene& scene,
                  const Eigen::Vector3d& direction,
                  Random_stream& random,
                  std::vector<Scan_return>& returns) const
  {
    std::size_t nearest = 0;
    float least = none, largest = 0;
    for (std::size_t lane = 0; lane < 3; ++lane)
      if (hits.range[lane] < none) {
        if (hits.range[lane] < least)
          nearest = lane;
        least = std::min(least, hits.range[lane]);
        largest = std::max(largest, hits.range[lane]);
      }
    if (!(least < none))
      return;
    const bool is_split = double(largest) - double(least) > m_scanner.ghost_gap;
    const bool is_ghost = is_split && random.uniform() < m_scanner.ghost_share;
    if (hits.range[0] < none)
      nearest = 0;
    else if (!is_ghost && random.uniform() >= m_scanner.edge_share)
      return;
    const double true_range =
        is_ghost ? random.uniform(least, largest) : double(hits.range[nearest]);
    if (true_range > m_scanner.largest_range)
      return;
    const double noise =
        m_scanner.range_noise * (1 + true_range / m_scanner.noise_distance) * random.normal();
    // the scanner assigns the direction of the central ray to all returns of a beam
    const Eigen::Vector3d point = m_position + (true_range + noise) * direction + m_shift;
    const int label =
        is_ghost ? label_ghost
                 : scene.label(hits.triangle[nearest], m_position + true_range * direction);
    returns.push_back({point, label});
  }

  const Virtual_scanner& m_scanner;
  std::uint64_t m_seed;
  std::size_t m_number;
  Eigen::Vector3d m_position, m_shift = Eigen::Vector3d::Zero();
  double m_low = 0;
  std::size_t m_rows = 0;
  std::vector<Eigen::Vector2d> m_directions; // cosine and sine of the azimuths
  std::array<Eigen::Vector2d, 16> m_rolls;
};

} // namespace internal
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_INTERNAL_SCAN_STATION_H
