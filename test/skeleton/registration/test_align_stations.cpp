// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Displaced stations are registered, and stations at their true positions do not move.

#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/registration/align_stations.h>
#include <support/axes.h>

#include <CGAL/number_utils.h>
#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_align_stations {

using namespace pcs::skeleton;

namespace {

constexpr double noise = 0.002, radius = 0.05;

/// Branches in all directions, each seen by the surrounding stations from different sides.
struct Scene
{
  Scan scan;
  Axis_set axes;
  std::vector<Index> station;
  std::vector<Rigid_motion> moved; ///< motion applied to the points of each station

  /// Keeps the fraction `share` of the points of each station, and moves them by `motions`.
  Scene(const std::vector<Rigid_motion>& motions, const std::vector<double>& share) : moved(motions)
  {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal(0, noise);
    axes.noise = noise;
    for (int a = 0; a < 24; ++a) {
      const double turn = 2.4 * a, rise = -0.9 + 1.8 * a / 23;
      const Vec3 along(std::cos(turn) * std::sqrt(1 - rise * rise),
                       std::sin(turn) * std::sqrt(1 - rise * rise),
                       rise);
      const Vec3 middle(std::cos(1.7 * a), std::sin(1.7 * a), std::sin(2.9 * a));
      axes.axes.push_back({pcs_test::straight_axis(middle - 0.4 * along,
                                                   middle + 0.4 * along,
                                                   16,
                                                   radius,
                                                   radius)});
      const Vec3 e1 = along.unitOrthogonal(), e2 = along.cross(e1);
      for (int k = 0; k < 1500; ++k) {
        const double at = uniform(random), angle = 2 * CGAL_PI * uniform(random);
        const Vec3 out = std::cos(angle) * e1 + std::sin(angle) * e2;
        const Vec3 p = middle + 0.8 * (at - 0.5) * along + (radius + normal(random)) * out;
        const auto s = static_cast<Index>(uniform(random) * double(motions.size()));
        const double from = 2 * CGAL_PI * s / double(motions.size());
        const bool is_seen = out.dot(Vec3(3 * std::cos(from), 3 * std::sin(from), 0) - p) > 0;
        if (is_seen && uniform(random) < share[s])
          add(p, s, static_cast<Index>(a), static_cast<Index>(std::min(15.0, 16 * at)));
      }
    }
  }

  Aligned_stations align() const
  {
    return align_stations<CGAL::Sequential_tag>(scan,
                                                axes,
                                                station,
                                                moved.size(),
                                                Station_alignment_options());
  }

  /// RMS displacement of the points of all other stations relative to the first one, after the
  /// motions `back`.
  double apart(const std::vector<Rigid_motion>& back) const
  {
    double sum = 0;
    for (const Vec3& p : scan.points) {
      const Vec3 first = back[0](moved[0](p)) - p;
      for (std::size_t s = 1; s < moved.size(); ++s)
        sum += (back[s](moved[s](p)) - p - first).squaredNorm();
    }
    return std::sqrt(sum / double(scan.size() * (moved.size() - 1)));
  }

private:
  void add(const Vec3& p, Index s, Index axis, Index segment)
  {
    scan.points.push_back(moved[s](p));
    station.push_back(s);
    axes.axis_of_point.push_back(axis);
    axes.segment_of_point.push_back(segment);
    ++axes.axes[axis].number_of_points;
  }
};

const std::vector<double> all{1, 1, 1};
const std::vector<Rigid_motion> some_motions{
    {Vec3(0.003, -0.001, 0.002), Vec3(0.001, 0.002, -0.003)},
    {Vec3(-0.002, 0.003, 0), Vec3(-0.003, 0.001, 0.002)},
    {Vec3(0.001, 0.001, -0.003), Vec3(0.002, -0.002, 0.001)}};

} // namespace

BOOST_AUTO_TEST_SUITE(aligned_stations)

BOOST_AUTO_TEST_CASE(known_motions_are_found_again)
{
  const Scene scene(some_motions, all);
  const Aligned_stations found = scene.align();
  BOOST_TEST_REQUIRE(found.motions.size() == 3u);
  const double before = scene.apart(std::vector<Rigid_motion>(3));
  BOOST_TEST(before > 2 * noise);
  BOOST_TEST(scene.apart(found.motions) < 0.1 * before);
  BOOST_TEST(found.error < 0.1 * found.size); // the estimated error confirms it
}

BOOST_AUTO_TEST_CASE(stations_that_agree_stay_where_they_are)
{
  const Scene scene(std::vector<Rigid_motion>(3), all);
  const Aligned_stations found = scene.align();
  BOOST_TEST_REQUIRE(found.motions.size() == 3u);
  BOOST_TEST(found.size < 0.2 * noise);
  BOOST_TEST(scene.apart(found.motions) < 0.2 * noise);
}

BOOST_AUTO_TEST_CASE(all_points_together_stay_where_they_are)
{
  const Scene scene(some_motions, {1, 0.6, 0.3});
  const Aligned_stations found = scene.align();
  Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();
  for (const Index s : scene.station) {
    shift += found.motions[s].shift;
    turn += found.motions[s].turn;
  }
  BOOST_TEST(found.size > noise);
  BOOST_TEST(shift.norm() < 1e-9 * double(scene.scan.size()) * found.size);
  BOOST_TEST(turn.norm() < 1e-9 * double(scene.scan.size()) * found.size);
}

BOOST_AUTO_TEST_CASE(numbers_of_stations_are_but_names)
{
  Scene scene(some_motions, all);
  const Aligned_stations first = scene.align();
  for (Index& s : scene.station)
    s = (s + 1) % 3;
  const Aligned_stations second = scene.align();
  for (std::size_t s = 0; s < 3; ++s) {
    const Rigid_motion &a = first.motions[s], &b = second.motions[(s + 1) % 3];
    BOOST_TEST((a.shift - b.shift).norm() < 1e-6 * first.size);
    BOOST_TEST((a.turn - b.turn).norm() < 1e-6 * first.size);
  }
}

BOOST_AUTO_TEST_CASE(nothing_moves_where_nothing_can_tell)
{
  const auto stays = [](const Scene& scene, std::size_t number) {
    const Aligned_stations found = scene.align();
    return found.motions.size() == number && found.size == 0 &&
           std::all_of(found.motions.begin(), found.motions.end(), [](const Rigid_motion& m) {
             return m.shift.isZero(0) && m.turn.isZero(0);
           });
  };
  BOOST_TEST(stays(Scene({some_motions[0]}, {1}), 1)); // there is no other station
  BOOST_TEST(stays(Scene(some_motions, {0, 0, 0}), 3));
  Scene thin(some_motions, all); // too few points for its noise
  thin.axes.noise = radius;
  BOOST_TEST(stays(thin, 3));
  Scene unknown(some_motions, all);
  std::fill(unknown.station.begin(), unknown.station.end(), none);
  BOOST_TEST(stays(unknown, 3));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_align_stations
