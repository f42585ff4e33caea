// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sessions write deformation gradients, with which splats follow the deformation.

#include <pcs/Point_set_deformation.h>
#include <pcs/splats/Splat_transformation.h>
#include <pcs/splats/transform_splats.h>
#include <support/deform_cloud.h>
#include <support/splats.h>

#include <CGAL/tags.h>

#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace test_deform_splats {

namespace {

using pcs_test::Bar_edit;
using pcs_test::Points;
using pcs_test::Vec3;
using Mat3 = Eigen::Matrix3d;
constexpr int degree = 3, number_of_colors = 45;

/// Accesses `(*values)[i]` for the point number `i`.
template <class Value>
struct Vector_map
{
  using key_type = std::size_t;
  using value_type = Value;
  using reference = const Value&;
  using category = boost::read_write_property_map_tag;
  std::vector<Value>* values;
  friend const Value& get(const Vector_map& map, std::size_t i) { return (*map.values)[i]; }
  friend void put(const Vector_map& map, std::size_t i, const Value& v) { (*map.values)[i] = v; }
};

/// Only writes.
struct Gradient_map
{
  using key_type = std::size_t;
  using value_type = Mat3;
  using reference = void;
  using category = boost::writable_property_map_tag;
  std::vector<Mat3>* values;
  friend void put(const Gradient_map& map, std::size_t i, const Mat3& g) { (*map.values)[i] = g; }
};

/// Counts how often each point is written.
struct Count_map
{
  using key_type = std::size_t;
  using value_type = Mat3;
  using reference = void;
  using category = boost::writable_property_map_tag;
  std::vector<int>* counts;
  friend void put(const Count_map& map, std::size_t i, const Mat3&) { ++(*map.counts)[i]; }
};

/// Splats on a bar. Their columns are stored as in files.
struct Splat_bar
{
  Bar_edit edit{8, 32};
  Points points = edit.points;
  std::size_t n = points.size();
  std::vector<std::size_t> numbers = std::vector<std::size_t>(n);
  std::vector<Vec3> vectors = std::vector<Vec3>(n, Vec3(0.1, -0.2, 0.3));
  std::vector<Mat3> tensors = std::vector<Mat3>(n);
  std::vector<Mat3> gradients = std::vector<Mat3>(n, Mat3::Identity());
  std::vector<std::vector<float>> rest, moved;

  Splat_bar()
  {
    std::iota(numbers.begin(), numbers.end(), std::size_t(0));
    pcs_test::Splat_drawer draw(1);
    rest.resize(7 + number_of_colors);
    for (std::size_t k = 0; k < rest.size(); ++k)
      for (std::size_t i = 0; i < n; ++i)
        rest[k].push_back(float((k >= 4 && k < 7 ? -3 : 0) + draw.number()));
    moved = rest;
    for (std::size_t i = 0; i < n; ++i)
      tensors[i] = shape(rest, i).covariance();
  }

  template <class Tag>
  void deform(int samples, const pcs::Similarity& bottom, const pcs::Similarity& top)
  {
    const auto np = pcs::parameters::point_map(Vector_map<Vec3>{&points})
                        .vector_map(Vector_map<Vec3>{&vectors})
                        .tensor_map(Vector_map<Mat3>{&tensors})
                        .gradient_map(Gradient_map{&gradients})
                        .number_of_samples(samples);
    pcs::Point_set_deformation<std::vector<std::size_t>, decltype(np), Tag> session(numbers, np);
    session.set_transformation(session.add_handle(edit.handles[0].indices), bottom);
    session.set_transformation(session.add_handle(edit.handles[1].indices), top);
    session.deform();
    const pcs::splats::Splat_columns<const float> from = columns(rest);
    BOOST_TEST((pcs::splats::transform_splats<Tag, float>(gradients, from, columns(moved)) == 0u));
  }

  static pcs::splats::Splat_columns<float> columns(std::vector<std::vector<float>>& values)
  {
    pcs::splats::Splat_columns<float> result;
    for (std::size_t k = 0; k < 4; ++k)
      result.rotation[k] = values[k].data();
    for (std::size_t k = 0; k < 3; ++k)
      result.log_scale[k] = values[4 + k].data();
    for (std::size_t k = 7; k < values.size(); ++k)
      result.harmonics.push_back(values[k].data());
    return result;
  }

  static pcs::splats::Splat_shape shape(const std::vector<std::vector<float>>& v, std::size_t i)
  {
    const auto at = [&](std::size_t k) { return double(v[k][i]); };
    return {Eigen::Quaterniond(at(0), at(1), at(2), at(3)), {at(4), at(5), at(6)}};
  }

  /// Relative difference of the covariance of a moved splat from `f C f^T`.
  double covariance_error(std::size_t i, const Mat3& f) const
  {
    const Mat3 expected = f * shape(rest, i).covariance() * f.transpose();
    return (shape(moved, i).covariance() - expected).norm() / expected.norm();
  }

  /// Difference of the colour of a moved splat in a direction from that of the splat at rest in the
  /// direction turned back by `q`.
  double color_error(std::size_t i, const Mat3& q, const Vec3& direction) const
  {
    double worst = 0;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      float before[15], after[15];
      for (std::size_t k = 0; k < 15; ++k) {
        before[k] = rest[7 + 15 * channel + k][i];
        after[k] = moved[7 + 15 * channel + k][i];
      }
      const double expected = pcs_test::color(degree, before, q.transpose() * direction);
      worst = std::max(worst, std::abs(pcs_test::color(degree, after, direction) - expected));
    }
    return worst;
  }
};

pcs::Similarity bend()
{
  return pcs::rotation(Vec3(0, 1, 0), 1.2, Vec3(2, 0.5, 2));
}

} // namespace

BOOST_AUTO_TEST_SUITE(deform_splats)

BOOST_AUTO_TEST_CASE(splats_follow_a_rigid_motion_of_all_handles)
{
  for (const int samples : {1000000, 400}) {
    Splat_bar bar;
    const auto motion =
        pcs::translation(Vec3(3, 2, 1)) * pcs::rotation(Vec3(1, 2, 3), 2.0, Vec3(0, 0, 0));
    bar.deform<CGAL::Parallel_if_available_tag>(samples, motion, motion);
    const Mat3 r = motion.rotation();
    double covariance = 0, color = 0;
    for (std::size_t i = 0; i < bar.n; ++i) {
      covariance = std::max(covariance, bar.covariance_error(i, r));
      color = std::max(color, bar.color_error(i, r, Vec3(2, -1, 2) / 3));
    }
    BOOST_TEST_MESSAGE("rigid, " << samples << " samples: covariances off by " << covariance
                                 << ", colours by " << color);
    BOOST_TEST(covariance < 1e-6); // float
    BOOST_TEST(color < 2e-6);
  }
}

BOOST_AUTO_TEST_CASE(covariances_and_colors_follow_the_gradient_of_a_bend)
{
  for (const int samples : {1000000, 400}) {
    Splat_bar bar;
    const std::vector<Vec3> rest_vectors = bar.vectors;
    bar.deform<CGAL::Parallel_if_available_tag>(samples, pcs::Similarity(), bend());
    pcs_test::Splat_drawer draw(2);
    double covariance = 0, tensor = 0, color = 0, vector = 0, largest_turn = 0;
    for (std::size_t i = 0; i < bar.n; ++i) {
      const Mat3 f = bar.gradients[i];
      // the gradient is the one that vectors and tensors follow
      vector = std::max(vector, (bar.vectors[i] - f * rest_vectors[i]).norm());
      tensor = std::max(tensor,
                        (Splat_bar::shape(bar.moved, i).covariance() - bar.tensors[i]).norm() /
                            bar.tensors[i].norm());
      covariance = std::max(covariance, bar.covariance_error(i, f));
      const Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
      const Mat3 q = svd.matrixU() * svd.matrixV().transpose();
      BOOST_REQUIRE(q.determinant() > 0);
      for (int k = 0; k < 4; ++k)
        color = std::max(color, bar.color_error(i, q, draw.direction()));
      largest_turn = std::max(largest_turn, Eigen::AngleAxisd(q).angle());
    }
    BOOST_TEST_MESSAGE("bend, " << samples << " samples: covariances off by " << covariance
                                << ", colours by " << color);
    BOOST_TEST(vector < 1e-12);
    BOOST_TEST(tensor < 1e-6);
    BOOST_TEST(covariance < 1e-6);
    BOOST_TEST(color < 1e-5);
    BOOST_TEST(largest_turn > 1.1);
  }
}

BOOST_AUTO_TEST_CASE(splats_keep_their_bits_without_motion)
{
  for (const int samples : {1000000, 400}) {
    Splat_bar bar;
    bar.deform<CGAL::Parallel_if_available_tag>(samples, pcs::Similarity(), pcs::Similarity());
    double largest = 0;
    for (const Mat3& f : bar.gradients)
      largest = std::max(largest, (f - Mat3::Identity()).cwiseAbs().maxCoeff());
    BOOST_TEST_MESSAGE("at rest, " << samples << " samples: gradients off by " << largest);
    BOOST_TEST((bar.moved == bar.rest));
  }
}

BOOST_AUTO_TEST_CASE(splats_are_the_same_for_all_numbers_of_threads)
{
  Splat_bar parallel, sequential;
  parallel.deform<CGAL::Parallel_if_available_tag>(400, pcs::Similarity(), bend());
  sequential.deform<CGAL::Sequential_tag>(400, pcs::Similarity(), bend());
  BOOST_TEST((parallel.gradients == sequential.gradients));
  BOOST_TEST((parallel.moved == sequential.moved));
  BOOST_TEST((parallel.moved != parallel.rest));
}

// The map may transform its splat as soon as the gradient arrives.
BOOST_AUTO_TEST_CASE(gradients_are_written_once)
{
  for (const int samples : {1000000, 400}) {
    const Bar_edit edit(8, 32);
    Points points = edit.points;
    std::vector<std::size_t> numbers(points.size());
    std::iota(numbers.begin(), numbers.end(), std::size_t(0));
    std::vector<int> counts(points.size(), 0), expected(points.size(), 1);
    const auto np = pcs::parameters::point_map(Vector_map<Vec3>{&points})
                        .gradient_map(Count_map{&counts})
                        .number_of_samples(samples);
    pcs::Point_set_deformation<std::vector<std::size_t>, decltype(np)> session(numbers, np);
    session.add_handle(edit.handles[0].indices);
    session.set_transformation(session.add_handle(edit.handles[1].indices), bend());
    session.deform();
    for (const auto i : edit.handles[0].indices)
      expected[i] = 0; // they do not move
    BOOST_TEST(counts == expected, boost::test_tools::per_element());
  }
}

BOOST_AUTO_TEST_CASE(other_points_obtain_the_gradients_of_the_points_around_them)
{
  for (const int samples : {1000000, 400}) {
    const Bar_edit edit(8, 32);
    Points points = edit.points;
    std::vector<std::size_t> numbers(points.size());
    std::iota(numbers.begin(), numbers.end(), std::size_t(0));
    std::vector<Mat3> gradients(points.size(), Mat3::Identity()), others = gradients;
    const auto np = pcs::parameters::point_map(Vector_map<Vec3>{&points})
                        .gradient_map(Gradient_map{&gradients})
                        .number_of_samples(samples);
    pcs::Point_set_deformation<std::vector<std::size_t>, decltype(np)> session(numbers, np);
    session.add_handle(edit.handles[0].indices);
    session.set_transformation(session.add_handle(edit.handles[1].indices), bend());
    session.deform();
    Points carried = edit.points;
    session.apply(
        numbers,
        pcs::parameters::point_map(Vector_map<Vec3>{&carried}).gradient_map(Gradient_map{&others}));
    double worst = 0, turn = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      worst = std::max(worst, (gradients[i] - others[i]).cwiseAbs().maxCoeff());
      turn = std::max(turn, (others[i] - Mat3::Identity()).norm());
    }
    BOOST_TEST(worst < 1e-6);
    BOOST_TEST(turn > 1);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_deform_splats
