// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the transformation of a splat by a deformation gradient.

#include <pcs/core/errors.h>
#include <pcs/splats/Splat_transformation.h>
#include <support/exceptions.h>
#include <support/splats.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace test_Splat_transformation {

namespace {

using pcs::splats::Splat_shape;
using pcs_test::Splat_drawer;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Returns `R S^2 R^T` of the file format, without the code under test.
Mat3 covariance(const Splat_shape& s)
{
  const Mat3 r = s.rotation.normalized().toRotationMatrix();
  const Vec3 squares(std::exp(2 * s.log_scale[0]),
                     std::exp(2 * s.log_scale[1]),
                     std::exp(2 * s.log_scale[2]));
  return r * squares.asDiagonal() * r.transpose();
}

Splat_shape draw_shape(Splat_drawer& draw)
{
  return {draw.quaternion(), Vec3(2 * draw.number(), 2 * draw.number(), 2 * draw.number())};
}

bool is_finite(const Splat_shape& s)
{
  return s.rotation.coeffs().allFinite() && s.log_scale.allFinite();
}

/// Angle between the rotations of two shapes. [rad]
double angle(const Splat_shape& a, const Splat_shape& b)
{
  return a.rotation.normalized().angularDistance(b.rotation.normalized());
}

} // namespace

BOOST_AUTO_TEST_SUITE(Splat_transformation)

BOOST_AUTO_TEST_CASE(covariances_follow_the_gradient)
{
  Splat_drawer draw(1);
  for (int i = 0; i < 2000; ++i) {
    const Mat3 f = draw.gradient();
    Splat_shape s = draw_shape(draw);
    BOOST_TEST((s.covariance() - covariance(s)).norm() < 1e-13 * covariance(s).norm());
    const Mat3 expected = f * covariance(s) * f.transpose();
    BOOST_TEST(pcs::splats::Splat_transformation(f).transform(s));
    BOOST_TEST((covariance(s) - expected).norm() < 1e-8 * expected.norm());
    BOOST_TEST(std::abs(s.rotation.norm() - 1) < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(the_rotation_is_that_of_the_polar_decomposition)
{
  Splat_drawer draw(2);
  for (int i = 0; i < 2000; ++i) {
    Mat3 f = draw.gradient();
    if (i % 4 == 0) // nearly flat
      f = draw.rotation() * Vec3(1, 2, 1e-2 * (1.1 + draw.number())).asDiagonal() * draw.rotation();
    const Mat3 q = pcs::splats::Splat_transformation(f).rotation();
    BOOST_TEST((q.transpose() * q - Mat3::Identity()).norm() < 1e-13);
    BOOST_TEST(q.determinant() > 0);
    const Mat3 p = q.transpose() * f;
    BOOST_TEST((p - p.transpose()).norm() < 1e-12);
    BOOST_TEST(Eigen::SelfAdjointEigenSolver<Mat3>(p).eigenvalues().minCoeff() > 0);
  }
}

BOOST_AUTO_TEST_CASE(the_identity_keeps_all_bits)
{
  Splat_drawer draw(3);
  const pcs::splats::Splat_transformation identity(Mat3::Identity());
  const pcs::splats::Splat_transformation nearly(Mat3::Identity() +
                                                 Mat3::Constant(1e-12)); // rounding of a solver
  BOOST_TEST((identity.is_identity() && nearly.is_identity()));
  for (int i = 0; i < 100; ++i) {
    Splat_shape s = draw_shape(draw);
    s.rotation.coeffs() *= 3 * draw.number();
    const Splat_shape old = s;
    float colors[45], old_colors[45];
    for (int k = 0; k < 45; ++k)
      colors[k] = old_colors[k] = float(draw.number());
    for (const auto& t : {identity, nearly}) {
      t.transform(s);
      t.rotate_harmonics(3, colors);
    }
    BOOST_TEST((s.rotation.coeffs() == old.rotation.coeffs()));
    BOOST_TEST((s.log_scale == old.log_scale));
    BOOST_TEST(std::equal(colors, colors + 45, old_colors));
  }
}

BOOST_AUTO_TEST_CASE(similarities_turn_the_axes_and_scale_them)
{
  Splat_drawer draw(4);
  for (int i = 0; i < 500; ++i) {
    const Mat3 q = draw.rotation();
    const double factor = std::exp(draw.number());
    Splat_shape s = draw_shape(draw);
    if (i % 3 == 0)
      s.log_scale.fill(-4); // a ball: its axes are not determined by its covariance
    const Splat_shape old = s;
    pcs::splats::Splat_transformation(factor * q).transform(s);
    const Mat3 axes = s.rotation.toRotationMatrix();
    BOOST_TEST((axes - q * old.rotation.toRotationMatrix()).norm() < 1e-12);
    BOOST_TEST((s.log_scale - old.log_scale - Vec3::Constant(std::log(factor))).norm() < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(axes_keep_their_numbers)
{
  // The longest axis is compressed until it is the shortest.
  for (int step = 0; step <= 100; ++step) {
    Splat_shape s{Eigen::Quaterniond::Identity(), Vec3(1, 0, -1)};
    const double stretch = std::exp(-0.03 * step);
    pcs::splats::Splat_transformation(Vec3(stretch, 1, 1).asDiagonal().toDenseMatrix())
        .transform(s);
    BOOST_TEST((s.log_scale - Vec3(1 - 0.03 * step, 0, -1)).norm() < 1e-12, "step " << step);
    BOOST_TEST(s.rotation.isApprox(Eigen::Quaterniond::Identity(), 1e-12), "step " << step);
  }
}

BOOST_AUTO_TEST_CASE(small_changes_of_the_gradient_change_the_result_little)
{
  Splat_drawer draw(5);
  for (int path = 0; path < 50; ++path) {
    // From the identity to a bend with shear; the scales of the splat differ.
    const Mat3 turn = draw.rotation();
    Mat3 shear = Mat3::Zero();
    for (int i = 0; i < 9; ++i)
      shear(i / 3, i % 3) = 0.3 * draw.number();
    const Eigen::AngleAxisd whole(turn);
    const Splat_shape rest{draw.quaternion(), Vec3(0.8, 0, -0.8)};
    Splat_shape last = rest;
    for (int step = 1; step <= 200; ++step) {
      const double t = step / 200.0;
      const Mat3 f = Eigen::AngleAxisd(t * whole.angle(), whole.axis()).toRotationMatrix() *
                     (Mat3::Identity() + t * shear);
      Splat_shape s = rest;
      pcs::splats::Splat_transformation(f).transform(s);
      BOOST_REQUIRE((s.log_scale - last.log_scale).norm() < 0.02);
      BOOST_REQUIRE(angle(s, last) < 0.1); // a permutation of axes is a turn by 1.57 or more
      last = s;
    }
  }
}

BOOST_AUTO_TEST_CASE(quaternions_keep_their_length)
{
  Splat_drawer draw(6);
  for (const double length : {1e-30, 0.5, 1.0, 20.0, 1e30}) {
    const Mat3 f = draw.gradient();
    Splat_shape unit = draw_shape(draw), s = unit;
    s.rotation.coeffs() *= length;
    const pcs::splats::Splat_transformation t(f);
    t.transform(unit);
    t.transform(s);
    BOOST_TEST(std::abs(s.rotation.norm() / length - 1) < 1e-12);
    BOOST_TEST((s.rotation.coeffs() / length - unit.rotation.coeffs()).norm() < 1e-10);
    BOOST_TEST((s.log_scale - unit.log_scale).norm() < 1e-10);
  }
}

BOOST_AUTO_TEST_CASE(a_zero_quaternion_is_the_identity)
{
  Splat_drawer draw(7);
  const Mat3 f = draw.gradient();
  Splat_shape zero{Eigen::Quaterniond(0, 0, 0, 0), Vec3(1, 0, -1)};
  Splat_shape one{Eigen::Quaterniond(1, 0, 0, 0), Vec3(1, 0, -1)};
  BOOST_TEST((zero.covariance() - one.covariance()).norm() == 0);
  const pcs::splats::Splat_transformation t(f);
  BOOST_TEST(t.transform(zero));
  t.transform(one);
  BOOST_TEST((zero.rotation.coeffs() == one.rotation.coeffs()));
  BOOST_TEST((zero.log_scale == one.log_scale));
}

BOOST_AUTO_TEST_CASE(flat_thin_and_huge_splats_are_transformed)
{
  Splat_drawer draw(8);
  const Vec3 scales[] = {{0, 0, -30},
                         {0, 0, -300},
                         {0, -300, -300},
                         {300, 300, 300},
                         {-300, 0, 300},
                         {-5, -5, -5},
                         {-5, -5, -5 + 1e-9}};
  for (const Vec3& scale : scales)
    for (int i = 0; i < 100; ++i) {
      const Mat3 f = draw.gradient();
      Splat_shape s{draw.quaternion(), scale};
      const Splat_shape old = s;
      BOOST_TEST(pcs::splats::Splat_transformation(f).transform(s));
      BOOST_REQUIRE(is_finite(s));
      // The volume of the ellipsoid follows the determinant, whichever axes are tiny.
      BOOST_TEST(std::abs(s.log_scale.sum() - old.log_scale.sum() - std::log(f.determinant())) <
                 1e-6);
      BOOST_TEST((s.log_scale - old.log_scale).cwiseAbs().maxCoeff() < 10); // none has moved
    }
}

BOOST_AUTO_TEST_CASE(disks_of_thickness_zero_keep_it)
{
  Splat_drawer draw(9);
  for (int i = 0; i < 200; ++i) {
    const Mat3 f = draw.gradient();
    Splat_shape s{draw.quaternion(), Vec3(0.3 * draw.number(), 0.3 * draw.number(), -infinity)};
    const Mat3 expected = f * covariance(s) * f.transpose();
    const Vec3 normal = f.inverse().transpose() * (s.rotation * Vec3::UnitZ());
    BOOST_TEST(pcs::splats::Splat_transformation(f).transform(s));
    BOOST_TEST((covariance(s) - expected).norm() < 1e-8 * expected.norm());
    BOOST_TEST(s.log_scale[2] == -infinity);
    BOOST_TEST((s.rotation * Vec3::UnitZ()).cross(normal.normalized()).norm() < 1e-8);
  }
  Splat_shape point{draw.quaternion(), Vec3::Constant(-infinity)};
  BOOST_TEST(pcs::splats::Splat_transformation(draw.gradient()).transform(point));
  BOOST_TEST((point.log_scale == Vec3::Constant(-infinity)));
  BOOST_TEST(point.rotation.coeffs().allFinite());
}

BOOST_AUTO_TEST_CASE(gradients_that_collapse_or_invert_give_finite_splats)
{
  Splat_drawer draw(10);
  for (int i = 0; i < 500; ++i) {
    const Vec3 stretch[] =
        {{1, 1, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0.5, -1}, {-1, -1, -1}, {1, 2, -1e-9}};
    Mat3 f = draw.rotation() * stretch[i % 6].asDiagonal() * draw.rotation();
    Splat_shape s = draw_shape(draw);
    const Mat3 expected = f * covariance(s) * f.transpose();
    const pcs::splats::Splat_transformation t(f);
    BOOST_TEST((t.rotation().transpose() * t.rotation() - Mat3::Identity()).norm() < 1e-12);
    BOOST_TEST(t.transform(s));
    BOOST_TEST(is_finite(s));
    BOOST_TEST((covariance(s) - expected).norm() < 1e-8 * (expected.norm() + 1e-18));
    BOOST_TEST(std::abs(s.rotation.norm() - 1) < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(mirrored_splats_keep_their_axes)
{
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 mirror = Vec3::Ones();
    mirror[axis] = -1;
    Splat_shape s{Eigen::Quaterniond::Identity(), Vec3(0.5, 0, -0.5)};
    const Splat_shape old = s;
    pcs::splats::Splat_transformation(mirror.asDiagonal().toDenseMatrix()).transform(s);
    BOOST_TEST((covariance(s) - covariance(old)).norm() < 1e-12);
    BOOST_TEST(angle(s, old) < 1e-6, "axis " << axis);
    BOOST_TEST((s.log_scale - old.log_scale).norm() < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(invalid_shapes_are_left_unchanged)
{
  Splat_drawer draw(11);
  const pcs::splats::Splat_transformation t(draw.gradient());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int which = 0; which < 4; ++which) {
    Splat_shape s{Eigen::Quaterniond(1, 2, 3, 4), Vec3(1, 2, 3)};
    (which < 2 ? s.rotation.coeffs()[1] : s.log_scale[1]) = which % 2 ? nan : infinity;
    BOOST_TEST(!t.transform(s));
    BOOST_TEST(s.rotation.w() == 1);
    BOOST_TEST(s.log_scale[0] == 1);
  }
  Mat3 wrong = Mat3::Identity();
  wrong(1, 2) = nan;
  BOOST_CHECK_EXCEPTION(pcs::splats::Splat_transformation{wrong},
                        pcs::Invalid_input,
                        pcs_test::message_has("not finite"));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Splat_transformation
