// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the transformation of many splats that are stored by columns.

#include <pcs/core/errors.h>
#include <pcs/splats/Splat_transformation.h>
#include <pcs/splats/transform_splats.h>
#include <support/exceptions.h>
#include <support/splats.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <vector>

namespace test_transform_splats {

namespace {

using pcs_test::Splat_drawer;
using Mat3 = Eigen::Matrix3d;

/// Splats by columns, each a vector.
template <class FT>
struct Splat_cloud
{
  std::vector<std::vector<FT>> values; // rotation, scales, harmonics
  std::vector<Mat3> gradients;
  bool is_flat = false;

  Splat_cloud(std::size_t n, int degree, unsigned seed)
  {
    Splat_drawer draw(seed);
    values.resize(7 + pcs::splats::number_of_rest_coefficients(degree));
    for (std::size_t i = 0; i < n; ++i) {
      for (auto& column : values)
        column.push_back(FT(draw.number()));
      gradients.push_back(i % 5 == 3 ? Mat3(Mat3::Identity()) : draw.gradient());
    }
  }

  pcs::splats::Splat_columns<FT> columns()
  {
    pcs::splats::Splat_columns<FT> result;
    for (std::size_t k = 0; k < 4; ++k)
      result.rotation[k] = values[k].data();
    for (std::size_t k = 0; k < (is_flat ? 2 : 3); ++k)
      result.log_scale[k] = values[4 + k].data();
    for (std::size_t k = 7; k < values.size(); ++k)
      result.harmonics.push_back(values[k].data());
    return result;
  }

  pcs::splats::Splat_shape shape(std::size_t i) const
  {
    const auto at = [&](std::size_t k) { return double(values[k][i]); };
    return {Eigen::Quaterniond(at(0), at(1), at(2), at(3)), {at(4), at(5), at(6)}};
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(transform_splats)

BOOST_AUTO_TEST_CASE(columns_give_what_single_splats_give)
{
  for (int degree = 0; degree <= 4; ++degree)
    for (const std::size_t n : std::initializer_list<std::size_t>{0, 1, 2, 7, 100}) {
      Splat_cloud<float> cloud(n, degree, 1);
      const Splat_cloud<float> rest = cloud;
      BOOST_TEST(pcs::splats::transform_splats(cloud.gradients, cloud.columns()) == 0u);
      for (std::size_t i = 0; i < n; ++i) {
        const pcs::splats::Splat_transformation t(rest.gradients[i]);
        pcs::splats::Splat_shape s = rest.shape(i);
        t.transform(s);
        const double expected[7] = {s.rotation.w(),
                                    s.rotation.x(),
                                    s.rotation.y(),
                                    s.rotation.z(),
                                    s.log_scale[0],
                                    s.log_scale[1],
                                    s.log_scale[2]};
        for (std::size_t k = 0; k < 7; ++k)
          BOOST_TEST(cloud.values[k][i] == float(expected[k]));
        std::vector<double> colors;
        for (std::size_t k = 7; k < rest.values.size(); ++k)
          colors.push_back(double(rest.values[k][i]));
        t.rotate_harmonics(degree, colors.data());
        for (std::size_t k = 0; k < colors.size(); ++k)
          BOOST_TEST(std::abs(cloud.values[7 + k][i] - colors[k]) < 2e-7);
        if (t.is_identity())
          for (std::size_t k = 0; k < rest.values.size(); ++k)
            BOOST_TEST(cloud.values[k][i] == rest.values[k][i]);
      }
    }
}

BOOST_AUTO_TEST_CASE(results_are_the_same_for_threads_and_in_place)
{
  Splat_cloud<float> rest(5000, 3, 2), sequential = rest, parallel = rest, in_place = rest;
  const pcs::splats::Splat_columns<const float> from = rest.columns();
  pcs::splats::transform_splats<CGAL::Sequential_tag, float>(rest.gradients,
                                                             from,
                                                             sequential.columns());
  pcs::splats::transform_splats<CGAL::Parallel_if_available_tag, float>(rest.gradients,
                                                                        from,
                                                                        parallel.columns());
  pcs::splats::transform_splats(rest.gradients, in_place.columns());
  BOOST_TEST((sequential.values == parallel.values));
  BOOST_TEST((sequential.values == in_place.values));
  BOOST_TEST((sequential.values != rest.values));
}

BOOST_AUTO_TEST_CASE(a_second_deformation_starts_from_the_same_rest)
{
  Splat_cloud<double> rest(100, 2, 3), moved = rest;
  const pcs::splats::Splat_columns<const double> from = rest.columns();
  pcs::splats::transform_splats(rest.gradients, from, moved.columns());
  const std::vector<Mat3> identity(rest.gradients.size(), Mat3::Identity());
  pcs::splats::transform_splats(identity, from, moved.columns());
  BOOST_TEST((moved.values == rest.values));
}

BOOST_AUTO_TEST_CASE(flat_splats_have_two_scales)
{
  Splat_cloud<double> flat(100, 1, 4), thin = flat;
  flat.is_flat = true;
  thin.values[6].assign(100, -std::numeric_limits<double>::infinity());
  pcs::splats::transform_splats(flat.gradients, flat.columns());
  pcs::splats::transform_splats(thin.gradients, thin.columns());
  for (std::size_t k = 0; k < flat.values.size(); ++k)
    if (k != 6)
      BOOST_TEST((flat.values[k] == thin.values[k]));
}

BOOST_AUTO_TEST_CASE(invalid_splats_are_counted_and_kept)
{
  Splat_cloud<float> cloud(64, 3, 5);
  cloud.values[2][10] = std::numeric_limits<float>::quiet_NaN();
  cloud.values[5][21] = std::numeric_limits<float>::infinity();
  cloud.gradients[32](1, 1) = std::numeric_limits<double>::quiet_NaN();
  cloud.values[20][40] = std::numeric_limits<float>::quiet_NaN(); // a colour
  const Splat_cloud<float> rest = cloud;
  BOOST_TEST(pcs::splats::transform_splats(cloud.gradients, cloud.columns()) == 3u);
  for (const std::size_t i : std::initializer_list<std::size_t>{10, 21, 32})
    for (std::size_t k = 0; k < cloud.values.size(); ++k)
      BOOST_TEST((cloud.values[k][i] == rest.values[k][i] || (k == 2 && i == 10)));
  for (std::size_t i = 0; i < 64; ++i)
    if (i != 40 && i != 10)
      for (const auto& column : cloud.values)
        BOOST_TEST(!std::isnan(column[i]));
}

BOOST_AUTO_TEST_CASE(missing_columns_are_refused)
{
  Splat_cloud<float> cloud(10, 3, 6);
  const Splat_cloud<float> rest = cloud;
  const auto refuses = [&](const pcs::splats::Splat_columns<float>& columns, const char* text) {
    BOOST_CHECK_EXCEPTION(pcs::splats::transform_splats(cloud.gradients, columns),
                          pcs::Invalid_input,
                          pcs_test::message_has(text));
  };
  auto columns = cloud.columns();
  columns.rotation[3] = nullptr;
  refuses(columns, "rotation is null");
  columns = cloud.columns();
  columns.log_scale[1] = nullptr;
  refuses(columns, "only the third may be");
  columns = cloud.columns();
  columns.harmonics.pop_back();
  refuses(columns, "0, 9, 24, 45 or 72");
  columns = cloud.columns();
  columns.harmonics[7] = nullptr;
  refuses(columns, "column 7 of the colours is null");
  auto fewer = cloud.columns();
  fewer.harmonics.resize(24);
  const pcs::splats::Splat_columns<const float> from = cloud.columns();
  BOOST_CHECK_EXCEPTION(pcs::splats::transform_splats(cloud.gradients, from, fewer),
                        pcs::Invalid_input,
                        pcs_test::message_has("45 coefficients of colours at rest and 24"));
  BOOST_TEST((cloud.values == rest.values));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_transform_splats
