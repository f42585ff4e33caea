// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Densities and visible sides by position and direction.

#include <pcs/internal/Random_stream.h>
#include <pcs/internal/median.h>
#include <pcs/skeleton/axes/fit_fields.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Density_field.h>
#include <pcs/skeleton/model/Visibility_field.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_Density_field {

using namespace pcs::skeleton;

namespace {

const Vec3 station(10, 0, 0);

/// Point density of a thin branch as seen by one station.
double true_density(const Vec3& place, const Vec3& along)
{
  const Vec3 view = place - station;
  return 1e5 * view.cross(along).norm() / (view.norm() * view.squaredNorm());
}

Vec3 random_place(pcs::internal::Random_stream& random)
{
  return {random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(0, 8)};
}

Vec3 random_direction(pcs::internal::Random_stream& random)
{
  Vec3 d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  return d.normalized();
}

/// Samples of the density, of which every tenth one is far too low.
std::vector<Density_sample> samples_of(std::size_t n, const Eigen::Matrix3d& rotation)
{
  pcs::internal::Random_stream random(5, 1);
  std::vector<Density_sample> samples;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 place = random_place(random), along = random_direction(random);
    const double factor = i % 10 == 0 ? 0.1 : std::exp(random.uniform(-0.2, 0.2));
    samples.push_back(
        {factor * true_density(place, along), 0.02, rotation * place, rotation * along});
  }
  return samples;
}

/// The mean outward normal of the half of a branch that the station sees.
Vec3 true_facing(const Vec3& place, const Vec3& along)
{
  const Vec3 view = (station - place).normalized();
  return 0.25 * 3.14159265358979323846 * (view - view.dot(along) * along).normalized();
}

/// Mean error of the logarithm.
template <class Density>
double error_of(const Density& density)
{
  pcs::internal::Random_stream random(6, 1);
  double sum = 0;
  constexpr int n = 500;
  for (int i = 0; i < n; ++i) {
    const Vec3 place = random_place(random), along = random_direction(random);
    sum += std::abs(std::log(density(place, along) / true_density(place, along)));
  }
  return sum / n;
}

} // namespace

BOOST_AUTO_TEST_SUITE(visibility_field)

BOOST_AUTO_TEST_CASE(it_tells_the_side_that_a_station_sees)
{
  std::vector<Density_sample> samples = samples_of(1000, Eigen::Matrix3d::Identity());
  Visibility_field field;
  field.learn(std::vector<Density_sample>(samples.begin(), samples.begin() + 10));
  BOOST_TEST(!field.is_known());
  for (std::size_t i = 0; i < samples.size(); ++i) // every tenth one is fitted on the wrong side
    samples[i].facing = (i % 10 == 0 ? -1 : 1) * true_facing(samples[i].place, samples[i].along);
  field.learn(samples);
  BOOST_TEST_REQUIRE(field.is_known());
  double error = 0;
  for (const Density_sample& s : samples) {
    const Vec3 facing = field(s.place, s.along);
    BOOST_TEST(std::abs(facing.dot(s.along)) < 1e-12);
    BOOST_TEST(facing.norm() < 0.79);
    error += (facing - true_facing(s.place, s.along)).norm() / double(samples.size());
  }
  BOOST_TEST(error < 0.15);
}

BOOST_AUTO_TEST_CASE(it_is_zero_where_points_lie_on_all_sides)
{
  Visibility_field field;
  field.learn(samples_of(500, Eigen::Matrix3d::Identity()));
  BOOST_TEST(field(Vec3(1, 1, 1), Vec3::UnitZ()).norm() < 1e-12);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(density_field)

BOOST_AUTO_TEST_CASE(it_follows_distance_and_direction_in_spite_of_odd_samples)
{
  const std::vector<Density_sample> samples = samples_of(2000, Eigen::Matrix3d::Identity());
  std::vector<double> densities;
  for (const Density_sample& s : samples)
    densities.push_back(s.density);
  const double middle = pcs::internal::lower_median(densities);
  Density_field field;
  field.learn(samples);
  BOOST_TEST_REQUIRE(field.is_known());
  const double constant = error_of([&](const Vec3&, const Vec3&) { return middle; });
  BOOST_TEST(constant > 0.35);
  BOOST_TEST(error_of(field) < 0.5 * constant);
}

BOOST_AUTO_TEST_CASE(it_turns_with_the_scan)
{
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  Density_field field, turned;
  field.learn(samples_of(500, Eigen::Matrix3d::Identity()));
  turned.learn(samples_of(500, rotation));
  pcs::internal::Random_stream random(7, 1);
  for (int i = 0; i < 20; ++i) {
    const Vec3 place = random_place(random), along = random_direction(random);
    BOOST_TEST(turned(rotation * place, rotation * along) == field(place, along),
               boost::test_tools::tolerance(1e-8));
    BOOST_TEST(field(place, -along) == field(place, along), boost::test_tools::tolerance(1e-12));
  }
}

BOOST_AUTO_TEST_CASE(predictions_stay_within_the_samples)
{
  const std::vector<Density_sample> samples = samples_of(500, Eigen::Matrix3d::Identity());
  double lowest = samples[0].density, highest = lowest;
  for (const Density_sample& s : samples) {
    lowest = std::min(lowest, s.density);
    highest = std::max(highest, s.density);
  }
  Density_field field;
  field.learn(samples);
  for (const Vec3& far : {Vec3(100, 0, 0), Vec3(-100, 50, 0), Vec3(0, 0, 1000)}) {
    BOOST_TEST(field(far, Vec3::UnitZ()) >= lowest);
    BOOST_TEST(field(far, Vec3::UnitZ()) <= highest);
  }
}

BOOST_AUTO_TEST_CASE(a_trunk_says_nothing_of_the_crown)
{
  // A slightly bent trunk is extrapolated along the direction of its end, independent of its sides.
  pcs::internal::Random_stream random(8, 1);
  std::vector<Density_sample> samples;
  for (int k = 0; k < 150; ++k) {
    const double z = 0.02 * k, bend = 0.05 * std::sin(2 * z);
    const Vec3 place(bend, 0, z), along = Vec3(0.1 * std::cos(2 * z), 0, 1).normalized();
    const double density = 1000 * std::exp(10 * bend - 0.2 * z + random.uniform(-0.05, 0.05));
    const Vec3 facing(0.3 + 5 * bend, random.uniform(-0.05, 0.05), 0);
    samples.push_back({density, 0.05, place, along, facing - facing.dot(along) * along});
  }
  Density_field density;
  Visibility_field facing;
  density.learn(samples);
  facing.learn(samples);
  const Vec3 up = Vec3::UnitZ(), top(0, 0, 3);
  for (const Vec3& far : {Vec3(2, 0, 3), Vec3(0, 2, 3), Vec3(-2, 1, 4), Vec3(0, 0, 8)}) {
    BOOST_TEST(std::abs(std::log(density(far, up) / density(top, up))) < 0.5);
    BOOST_TEST((facing(far, up) - facing(top, up)).norm() < 0.35);
  }
}

BOOST_AUTO_TEST_CASE(few_samples_leave_the_median)
{
  Axis_set set;
  set.density = 700;
  set.density_field.learn(
      samples_of(Density_field::fewest_samples - 1, Eigen::Matrix3d::Identity()));
  BOOST_TEST(!set.density_field.is_known());
  BOOST_TEST(set.density_at(Vec3::Zero(), Vec3::UnitX()) == 700);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Density_field
