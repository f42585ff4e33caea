// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The surface of a tree and its surroundings as labelled triangles.

#ifndef PCS_GENERATORS_INTERNAL_SCENE_H
#define PCS_GENERATORS_INTERNAL_SCENE_H

#include <pcs/core/errors.h>
#include <pcs/generators/Virtual_scanner.h>
#include <pcs/generators/internal/Ray_tree.h>
#include <pcs/generators/internal/normal_vector.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/constants.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

using pcs::internal::Random_stream;

//! a node of the scanned tree, relative to the root
struct Scan_node
{
  Eigen::Vector3d point, major_axis; // major_axis may be null
  double radius = 0, major_radius = 0, minor_radius = 0;
};

//! the scanned tree: its nodes, and the indices of the nodes of every branch from base to tip
struct Scan_wood
{
  std::vector<Scan_node> nodes;
  std::vector<std::vector<std::size_t>> branches;
  std::vector<std::size_t> carriers; // for each branch its parent node, or none
  std::vector<int> orders;
  std::vector<int> added; // for each additional node the node of the tree that it represents
};

class Scene
{
public:
  Scene(const Virtual_scanner& scanner, std::uint64_t seed) : m_scanner(&scanner), m_seed(seed) {}

  void add_wood(const Scan_wood& wood)
  {
    for (const Scan_node& node : wood.nodes)
      m_thickest = std::max(m_thickest, node.radius);
    for (std::size_t b = 0; b < wood.branches.size(); ++b)
      if (wood.branches[b].size() > 1)
        add_branch(wood, b);
  }

  //! throws `Invalid_input` if there would be too many leaves
  void add_leaves(const Scan_wood& wood, int label)
  {
    check_number_of_leaves(wood);
    for (const auto& branch : wood.branches)
      for (std::size_t i = 1; i < branch.size(); ++i) {
        const Scan_node& a = wood.nodes[branch[i - 1]];
        const Scan_node& b = wood.nodes[branch[i]];
        if (b.radius >= m_scanner->leaf_twig_radius)
          continue;
        Random_stream random(m_seed, 11, branch[i]);
        const double expected = m_scanner->leaves_per_length * (b.point - a.point).norm();
        const auto n = static_cast<std::size_t>(expected + random.uniform());
        for (std::size_t k = 0; k < n; ++k)
          add_leaf(a.point + random.uniform() * (b.point - a.point), b.radius, random, label);
      }
  }

  //! adds a circular patch with a gentle relief that is 0 at the trunk
  void add_ground(int label)
  {
    constexpr std::size_t n_turn = 96, n_out = 48;
    Random_stream random(m_seed, 12);
    const double phase_x = random.uniform(0, two_pi), phase_y = random.uniform(0, two_pi);
    const double wave = two_pi / m_scanner->ground_radius;
    const auto height = [&](double x, double y) {
      return m_scanner->ground_roughness *
             (std::sin(2 * wave * x + phase_x) * std::sin(3 * wave * y + phase_y) -
              std::sin(phase_x) * std::sin(phase_y));
    };
    std::vector<Eigen::Vector3d> ring(n_turn, Eigen::Vector3d(0, 0, height(0, 0)));
    for (std::size_t i = 1; i <= n_out; ++i) {
      const double r = m_scanner->ground_radius * double(i) / n_out;
      std::vector<Eigen::Vector3d> next;
      for (std::size_t k = 0; k < n_turn; ++k) {
        const double a = two_pi * double(k) / n_turn;
        next.emplace_back(r * std::cos(a), r * std::sin(a), 0);
        next.back().z() = height(next.back().x(), next.back().y());
      }
      connect(ring, next, piece(label));
      ring = next;
    }
  }

  void add_post(const Scan_post& post, int label)
  {
    constexpr std::size_t sides = 32;
    std::vector<Eigen::Vector3d> low, high;
    const double r = post.radius * radius_of_equal_area(sides);
    for (std::size_t k = 0; k < sides; ++k) {
      const double a = two_pi * double(k) / sides;
      low.emplace_back(post.x + r * std::cos(a), post.y + r * std::sin(a), 0);
      high.emplace_back(low.back().x(), low.back().y(), post.height);
    }
    const std::uint32_t p = piece(label);
    connect(low, high, p);
    close(high, Eigen::Vector3d(post.x, post.y, post.height), p);
  }

  //! returns the label of a point of a triangle: for wood, the nearest node along the axis;
  //! otherwise, the label of the object
  int label(std::uint32_t triangle, const Eigen::Vector3d& point) const
  {
    const Piece& p = m_pieces[m_piece_of[triangle]];
    const Eigen::Vector3d d = p.to - p.from;
    return 2 * (point - p.from).dot(d) < d.squaredNorm() ? p.label_from : p.label_to;
  }

  std::vector<Triangle> triangles;

private:
  void check_number_of_leaves(const Scan_wood& wood) const
  {
    constexpr double most_leaves = 1e7; // 2 triangles each
    double length = 0;
    for (const auto& branch : wood.branches)
      for (std::size_t i = 1; i < branch.size(); ++i)
        if (wood.nodes[branch[i]].radius < m_scanner->leaf_twig_radius)
          length += (wood.nodes[branch[i]].point - wood.nodes[branch[i - 1]].point).norm();
    if (length * m_scanner->leaves_per_length <= most_leaves)
      return;
    std::ostringstream message;
    message << "pcs::Virtual_scanner: `leaves_per_length` is " << m_scanner->leaves_per_length
            << ", which gives more than 1e7 leaves on twigs of a total length of " << length
            << "; expected less than " << most_leaves / length;
    throw Invalid_input(message.str());
  }

  static constexpr double two_pi = 2 * pcs::internal::pi;

  struct Piece
  {
    int label_from, label_to;
    Eigen::Vector3d from, to;
  };

  //! returns the radius at which a polygon with this many sides has the area of the unit circle
  static double radius_of_equal_area(std::size_t sides)
  {
    const double n = static_cast<double>(sides);
    return std::sqrt(two_pi / (n * std::sin(two_pi / n)));
  }

  std::uint32_t
  piece(int label_from, int label_to, const Eigen::Vector3d& from, const Eigen::Vector3d& to)
  {
    m_pieces.push_back({label_from, label_to, from, to});
    return static_cast<std::uint32_t>(m_pieces.size() - 1);
  }

  //! adds a piece that is not wood
  std::uint32_t piece(int label)
  {
    return piece(label, label, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  }

  void add_triangle(const Eigen::Vector3d& a,
                    const Eigen::Vector3d& b,
                    const Eigen::Vector3d& c,
                    std::uint32_t of_piece)
  {
    // edges between rounded corners, so that the edges of neighbours are identical
    const Vector3f corner = a.cast<float>();
    triangles.push_back({corner, b.cast<float>() - corner, c.cast<float>() - corner});
    m_piece_of.push_back(of_piece);
  }

  void connect(const std::vector<Eigen::Vector3d>& ring,
               const std::vector<Eigen::Vector3d>& next,
               std::uint32_t of_piece)
  {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const std::size_t l = (k + 1) % ring.size();
      add_triangle(ring[k], ring[l], next[k], of_piece);
      add_triangle(ring[l], next[l], next[k], of_piece);
    }
  }

  void close(const std::vector<Eigen::Vector3d>& ring,
             const Eigen::Vector3d& tip,
             std::uint32_t of_piece)
  {
    for (std::size_t k = 0; k < ring.size(); ++k)
      add_triangle(ring[k], ring[(k + 1) % ring.size()], tip, of_piece);
  }

  void add_branch(const Scan_wood& wood, std::size_t b)
  {
    const std::vector<std::size_t>& branch = wood.branches[b];
    double thickest = 0;
    for (const std::size_t v : branch)
      thickest = std::max(thickest, wood.nodes[v].radius);
    if (!(thickest > 0))
      return;
    const auto sides = static_cast<std::size_t>(8 + 88 * std::min(1.0, thickest / m_thickest));
    Random_stream random(m_seed, 10, b);
    const std::array<double, 3> phases = {random.uniform(0, two_pi),
                                          random.uniform(0, two_pi),
                                          random.uniform(0, two_pi)};

    std::vector<Eigen::Vector3d> ring, next;
    Eigen::Vector3d major = Eigen::Vector3d::Zero();
    double at = 0;
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < branch.size(); ++i) {
      const Scan_node& node = wood.nodes[branch[i]];
      const Eigen::Vector3d& before = wood.nodes[branch[i == 0 ? 0 : i - 1]].point;
      const Eigen::Vector3d& after = wood.nodes[branch[std::min(i + 1, branch.size() - 1)]].point;
      // the mean of the directions, independent of the lengths of the edges
      Eigen::Vector3d tangent =
          (node.point - before).normalized() + (after - node.point).normalized();
      if (!(tangent.squaredNorm() > 1e-12))
        tangent = major.squaredNorm() > 0 ? m_tangent : Eigen::Vector3d::UnitZ();
      m_tangent = tangent.normalized();
      major = section_axis(node, major);
      at += (node.point - before).norm();
      next = section(node, major, sides, at / m_thickest, phases);
      if (i > 0) {
        last =
            piece(static_cast<int>(branch[i - 1]), static_cast<int>(branch[i]), before, node.point);
        connect(ring, next, last);
      }
      std::swap(ring, next);
    }
    const Scan_node& tip = wood.nodes[branch.back()];
    close(ring, tip.point + 0.5 * tip.radius * m_tangent, last);
  }

  //! returns the longer axis of a section across the tangent, continuous along the branch
  Eigen::Vector3d section_axis(const Scan_node& node, const Eigen::Vector3d& before) const
  {
    for (const Eigen::Vector3d& wish : {node.major_axis, before}) {
      const Eigen::Vector3d across = wish - wish.dot(m_tangent) * m_tangent;
      if (across.squaredNorm() > 1e-6)
        return (across.dot(before) < 0 ? -1 : 1) * across.normalized();
    }
    Eigen::Index least = 0;
    m_tangent.cwiseAbs().minCoeff(&least);
    return m_tangent.cross(Eigen::Vector3d::Unit(least)).normalized();
  }

  std::vector<Eigen::Vector3d> section(const Scan_node& node,
                                       const Eigen::Vector3d& major,
                                       std::size_t sides,
                                       double along,
                                       const std::array<double, 3>& phases) const
  {
    const Eigen::Vector3d minor = m_tangent.cross(major);
    const double a = node.major_radius > 0 ? node.major_radius : node.radius;
    const double b = node.minor_radius > 0 ? node.minor_radius : node.radius;
    const double depth =
        std::min(m_scanner->bark_depth, m_scanner->bark_share * node.radius) / std::max(a, 1e-300);
    std::vector<Eigen::Vector2d> polygon;
    for (std::size_t k = 0; k < sides; ++k) {
      const double angle = two_pi * double(k) / double(sides);
      const double relief = (std::sin(9 * angle + phases[0] + 0.9 * along) +
                             std::sin(17 * angle + phases[1] - 1.7 * along) +
                             std::sin(31 * angle + phases[2] + 2.3 * along)) /
                            3;
      polygon.push_back((1 + depth * relief) *
                        Eigen::Vector2d(a * std::cos(angle), b * std::sin(angle)));
    }
    double doubled_area = 0;
    for (std::size_t k = 0; k < sides; ++k) {
      const Eigen::Vector2d &p = polygon[k], &q = polygon[(k + 1) % sides];
      doubled_area += p.x() * q.y() - p.y() * q.x();
    }
    // neither the polygon nor the bark changes the area of the section
    const double scale = doubled_area > 0 ? node.radius * std::sqrt(two_pi / doubled_area) : 1.0;
    std::vector<Eigen::Vector3d> ring;
    for (const Eigen::Vector2d& p : polygon)
      ring.push_back(node.point + scale * (p.x() * major + p.y() * minor));
    return ring;
  }

  //! adds a rhombus with the area of a disc
  void add_leaf(const Eigen::Vector3d& on_axis, double radius, Random_stream& random, int label)
  {
    const auto direction = [&] {
      const Eigen::Vector3d d = normal_vector(random);
      return Eigen::Vector3d(d.squaredNorm() > 0 ? d.normalized() : Eigen::Vector3d::UnitX());
    };
    const double size = m_scanner->leaf_radius * random.uniform(0.7, 1.3);
    const Eigen::Vector3d along = direction(), other = direction();
    const Eigen::Vector3d across = (other - other.dot(along) * along);
    if (!(across.squaredNorm() > 1e-6))
      return;
    const Eigen::Vector3d side = 0.9 * size * across.normalized(), end = 1.75 * size * along;
    const Eigen::Vector3d middle = on_axis + (radius + 1.75 * size) * along;
    const std::uint32_t p = piece(label);
    add_triangle(middle - end, middle + side, middle + end, p);
    add_triangle(middle - end, middle + end, middle - side, p);
  }

  const Virtual_scanner* m_scanner;
  std::uint64_t m_seed;
  double m_thickest = 0;
  Eigen::Vector3d m_tangent = Eigen::Vector3d::UnitZ();
  std::vector<Piece> m_pieces;
  std::vector<std::uint32_t> m_piece_of; // of each triangle
};

} // namespace internal
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_INTERNAL_SCENE_H
