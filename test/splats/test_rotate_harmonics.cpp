// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the spherical harmonics of splats and their rotation.

#include <pcs/core/errors.h>
#include <pcs/splats/rotate_harmonics.h>
#include <pcs/splats/spherical_harmonics.h>
#include <support/exceptions.h>
#include <support/splats.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <vector>

namespace test_rotate_harmonics {

namespace {

using pcs_test::Splat_drawer;
using Vec3 = Eigen::Vector3d;

/// Largest difference between the functions of a band and their definition.
template <int Band>
double error_of_band()
{
  Splat_drawer draw(Band + 1);
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 d = draw.direction();
    double values[2 * Band + 1];
    pcs::splats::evaluate_band<Band>(d.x(), d.y(), d.z(), values);
    for (int m = -Band; m <= Band; ++m)
      worst = std::max(worst, std::abs(values[m + Band] - pcs_test::harmonic(Band, m, d)));
  }
  return worst;
}

template <class FT>
std::vector<FT> draw_coefficients(int degree, Splat_drawer& draw)
{
  std::vector<FT> result;
  for (std::size_t i = 0; i < pcs::splats::number_of_rest_coefficients(degree); ++i)
    result.push_back(FT(draw.number()));
  return result;
}

/// Largest difference between the colour of rotated coefficients in the direction `R d` and that of
/// the original ones in the direction `d`.
template <class FT>
double error_of_rotation(int degree)
{
  Splat_drawer draw(unsigned(10 + degree));
  const int n = pcs::splats::number_of_coefficients(degree) - 1;
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix3d r = draw.rotation();
    const std::vector<FT> old = draw_coefficients<FT>(degree, draw);
    std::vector<FT> turned = old;
    pcs::splats::rotate_harmonics(r, degree, turned.data());
    for (int k = 0; k < 10; ++k) {
      const Vec3 d = draw.direction();
      for (int channel = 0; channel < 3; ++channel)
        worst = std::max(worst,
                         std::abs(pcs_test::color(degree, turned.data() + n * channel, r * d) -
                                  pcs_test::color(degree, old.data() + n * channel, d)));
    }
  }
  return worst;
}

} // namespace

BOOST_AUTO_TEST_SUITE(spherical_harmonics)

BOOST_AUTO_TEST_CASE(functions_are_those_of_the_definition)
{
  BOOST_TEST(error_of_band<0>() < 1e-14);
  BOOST_TEST(error_of_band<1>() < 1e-14);
  BOOST_TEST(error_of_band<2>() < 1e-14);
  BOOST_TEST(error_of_band<3>() < 1e-14);
  BOOST_TEST(error_of_band<4>() < 1e-13);
}

// The order and the signs of the file format, with the constants that its renderers use.
BOOST_AUTO_TEST_CASE(functions_are_those_of_renderers)
{
  Splat_drawer draw(3);
  for (int i = 0; i < 20; ++i) {
    const Vec3 d = draw.direction();
    const double x = d.x(), y = d.y(), z = d.z(), xx = x * x, yy = y * y, zz = z * z;
    const double expected[15] = {-0.4886025119029199 * y,
                                 0.4886025119029199 * z,
                                 -0.4886025119029199 * x,
                                 1.0925484305920792 * x * y,
                                 -1.0925484305920792 * y * z,
                                 0.31539156525252005 * (2 * zz - xx - yy),
                                 -1.0925484305920792 * x * z,
                                 0.5462742152960396 * (xx - yy),
                                 -0.5900435899266435 * y * (3 * xx - yy),
                                 2.890611442640554 * x * y * z,
                                 -0.4570457994644658 * y * (4 * zz - xx - yy),
                                 0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy),
                                 -0.4570457994644658 * x * (4 * zz - xx - yy),
                                 1.445305721320277 * z * (xx - yy),
                                 -0.5900435899266435 * x * (xx - 3 * yy)};
    double values[15];
    pcs::splats::evaluate_band<1>(x, y, z, values);
    pcs::splats::evaluate_band<2>(x, y, z, values + 3);
    pcs::splats::evaluate_band<3>(x, y, z, values + 8);
    for (int k = 0; k < 15; ++k)
      BOOST_TEST(std::abs(values[k] - expected[k]) < 1e-14, "function " << k);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(rotate_harmonics)

BOOST_AUTO_TEST_CASE(colors_turn_with_the_splat)
{
  for (int degree = 1; degree <= 4; ++degree) {
    BOOST_TEST(error_of_rotation<double>(degree) < 1e-13, "degree " << degree);
    const double error = error_of_rotation<float>(degree);
    BOOST_TEST_MESSAGE("degree " << degree << ", float: colours differ by " << error);
    BOOST_TEST(error < 1e-6, "degree " << degree);
  }
}

BOOST_AUTO_TEST_CASE(rotations_are_composed_and_reversed)
{
  Splat_drawer draw(5);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Matrix3d a = draw.rotation(), b = draw.rotation();
    const std::vector<double> old = draw_coefficients<double>(4, draw);
    std::vector<double> twice = old, once = old;
    pcs::splats::rotate_harmonics(a, 4, twice.data());
    pcs::splats::rotate_harmonics(b, 4, twice.data());
    pcs::splats::rotate_harmonics(b * a, 4, once.data());
    for (std::size_t k = 0; k < old.size(); ++k)
      BOOST_TEST(std::abs(once[k] - twice[k]) < 1e-13);
    pcs::splats::rotate_harmonics((b * a).transpose(), 4, once.data());
    for (std::size_t k = 0; k < old.size(); ++k)
      BOOST_TEST(std::abs(once[k] - old[k]) < 1e-13);
  }
}

BOOST_AUTO_TEST_CASE(the_number_of_coefficients_determines_the_degree)
{
  const std::size_t counts[] = {0, 9, 24, 45, 72};
  for (int degree = 0; degree <= 4; ++degree) {
    BOOST_TEST(pcs::splats::number_of_rest_coefficients(degree) == counts[degree]);
    BOOST_TEST(pcs::splats::degree_of_harmonics(counts[degree]) == degree);
  }
  for (const std::size_t wrong : std::initializer_list<std::size_t>{1, 3, 8, 10, 44, 46, 48, 105})
    BOOST_CHECK_EXCEPTION(pcs::splats::degree_of_harmonics(wrong),
                          pcs::Invalid_input,
                          pcs_test::message_has("0, 9, 24, 45 or 72"));
}

BOOST_AUTO_TEST_CASE(wrong_degrees_are_refused)
{
  double none[1] = {7};
  for (const int wrong : {-1, 5})
    BOOST_CHECK_EXCEPTION(
        pcs::splats::rotate_harmonics(Eigen::Matrix3d::Identity().eval(), wrong, none),
        pcs::Invalid_input,
        pcs_test::message_has("must be 0 to 4"));
  pcs::splats::rotate_harmonics(Eigen::Matrix3d::Identity().eval(), 0, none);
  BOOST_TEST(none[0] == 7);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_rotate_harmonics
