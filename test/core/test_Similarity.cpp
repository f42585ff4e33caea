// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Similarities keep their turns, compose like matrices, and reject matrices that are no
// similarities.

#include <pcs/core/Similarity.h>
#include <support/exceptions.h>
#include <support/point_clouds.h>

#include <CGAL/Aff_transformation_3.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>

#include <boost/mpl/list.hpp>
#include <boost/test/unit_test.hpp>

#include <limits>

namespace test_Similarity {

namespace {

using pcs::Similarity;
using pcs_test::Vec3;
constexpr double pi = 3.14159265358979323846;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Eigen::Matrix4d matrix(const Similarity& s)
{
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = s.scale() * s.rotation();
  m.topRightCorner<3, 1>() = s.translation();
  return m;
}

Similarity random_similarity(std::mt19937& random)
{
  return Similarity::from_translation(pcs_test::random_vector(random)) *
         Similarity::from_turn(3 * pcs_test::random_vector(random)) *
         Similarity::from_scale(1.5 + pcs_test::uniform(random));
}

bool is_exact_identity(const Similarity& s)
{
  return matrix(s) == Eigen::Matrix4d::Identity() && s.turns().empty();
}

Eigen::Matrix<double, 3, 4> affine(const Eigen::Matrix3d& a, const Vec3& t = Vec3::Zero())
{
  Eigen::Matrix<double, 3, 4> m;
  m << a, t;
  return m;
}

using Kernels = boost::mpl::list<CGAL::Simple_cartesian<float>,
                                 CGAL::Simple_cartesian<double>,
                                 CGAL::Exact_predicates_inexact_constructions_kernel,
                                 CGAL::Exact_predicates_exact_constructions_kernel>;

} // namespace

BOOST_AUTO_TEST_SUITE(Similarity)

BOOST_AUTO_TEST_CASE(the_default_is_the_exact_identity)
{
  const pcs::Similarity s;
  BOOST_TEST(is_exact_identity(s));
  const Vec3 x(1.1, -2.2, 3.3e10);
  BOOST_TEST((s(x) == x));
}

BOOST_AUTO_TEST_CASE(seven_hundred_and_twenty_degrees_stay_two_turns)
{
  const auto s = pcs::rotation(Vec3(0, 0, 2), 4 * pi, Vec3(5, 6, 7));
  BOOST_TEST(s.total_angle() == 4 * pi, boost::test_tools::tolerance(1e-15));
  BOOST_TEST(s.turns().size() == 1u);
  BOOST_TEST((matrix(s) - Eigen::Matrix4d::Identity()).norm() < 1e-13);
}

BOOST_AUTO_TEST_CASE(small_turns_about_one_axis_add_up)
{
  pcs::Similarity s;
  for (int i = 0; i < 72; ++i)
    s = pcs::rotation(Vec3(1, 2, 3), pi / 18, Vec3(0, 0, 0)) * s;
  BOOST_TEST(s.turns().size() == 1u);
  BOOST_TEST(s.total_angle() == 4 * pi, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(a_turn_and_its_opposite_cancel_exactly)
{
  const auto forward = pcs::rotation(Vec3(1, -2, 3), 4 * pi, Vec3(0, 0, 0));
  const auto backward = pcs::rotation(Vec3(1, -2, 3), -4 * pi, Vec3(0, 0, 0));
  BOOST_TEST(is_exact_identity(backward * forward));
  const auto other = pcs::rotation(Vec3(1, 0, 0), 1.0, Vec3(0, 0, 0));
  BOOST_TEST((backward * forward * other).turns().size() == 1u);
}

BOOST_AUTO_TEST_CASE(composition_is_that_of_the_matrices)
{
  std::mt19937 random(1);
  for (int repetition = 0; repetition < 50; ++repetition) {
    const auto a = random_similarity(random), b = random_similarity(random),
               c = random_similarity(random);
    BOOST_TEST((matrix(a * b) - matrix(a) * matrix(b)).norm() < 1e-13);
    BOOST_TEST((matrix((a * b) * c) - matrix(a * (b * c))).norm() < 1e-12);
    const Vec3 x = pcs_test::random_vector(random);
    BOOST_TEST(((a * b)(x)-a(b(x))).norm() < 1e-13);
  }
}

BOOST_AUTO_TEST_CASE(composition_with_the_identity_changes_nothing)
{
  std::mt19937 random(2);
  const auto a = random_similarity(random);
  BOOST_TEST((matrix(a * pcs::Similarity()) == matrix(a)));
  BOOST_TEST((matrix(pcs::Similarity() * a) == matrix(a)));
}

BOOST_AUTO_TEST_CASE(about_keeps_its_centre)
{
  std::mt19937 random(3);
  for (int repetition = 0; repetition < 50; ++repetition) {
    const Vec3 center = 100 * pcs_test::random_vector(random);
    const auto s =
        pcs::Similarity::about(pcs::Similarity::from_turn(5 * pcs_test::random_vector(random)) *
                                   pcs::Similarity::from_scale(2),
                               center);
    BOOST_TEST((s(center) - center).norm() < 1e-12 * (1 + center.norm()));
  }
  BOOST_TEST(is_exact_identity(pcs::Similarity::about(pcs::Similarity(), Vec3(5e6, 1e9, -3.3))));
}

BOOST_AUTO_TEST_CASE(helpers_say_what_they_do)
{
  BOOST_TEST(
      (pcs::rotation(Vec3(0, 0, 1), pi / 2, Vec3(1, 0, 0))(Vec3(2, 0, 0)) - Vec3(1, 1, 0)).norm() <
      1e-15);
  BOOST_TEST((pcs::translation(Vec3(1, 2, 3))(Vec3(1, 1, 1)) == Vec3(2, 3, 4)));
  BOOST_TEST((pcs::scaling(3, Vec3(1, 1, 1))(Vec3(2, 1, 0)) - Vec3(4, 1, -2)).norm() < 1e-15);
}

BOOST_AUTO_TEST_CASE(an_axis_of_any_length_serves)
{
  const auto one = pcs::rotation(Vec3(1, 2, 3), 1.0, Vec3(0, 0, 0));
  for (const double length : {1e-200, 1e-3, 1e200})
    BOOST_TEST(
        (matrix(pcs::rotation(Vec3(length * Vec3(1, 2, 3)), 1.0, Vec3(0, 0, 0))) - matrix(one))
            .norm() < 1e-14);
}

BOOST_AUTO_TEST_CASE(bad_values_are_refused_with_the_value)
{
  using pcs_test::message_has;
  const Vec3 o(0, 0, 0);
  BOOST_CHECK_EXCEPTION(pcs::rotation(o, 1.0, o),
                        pcs::Invalid_input,
                        message_has("rotation", "axis", "zero"));
  BOOST_CHECK_EXCEPTION(pcs::rotation(Vec3(not_a_number, 0, 0), 1.0, o),
                        pcs::Invalid_input,
                        message_has("axis"));
  BOOST_CHECK_EXCEPTION(pcs::rotation(Vec3(1, 0, 0), not_a_number, o),
                        pcs::Invalid_input,
                        message_has("angle"));
  BOOST_CHECK_EXCEPTION(pcs::rotation(Vec3(1, 0, 0), infinity, o),
                        pcs::Invalid_input,
                        message_has("angle"));
  for (const double factor : {0.0, -1.0, not_a_number, infinity})
    BOOST_CHECK_EXCEPTION(pcs::scaling(factor, o),
                          pcs::Invalid_input,
                          message_has("factor", "positive"));
}

BOOST_AUTO_TEST_CASE(a_value_that_is_not_finite_never_goes_unnoticed)
{
  for (const double bad : {not_a_number, infinity}) {
    BOOST_TEST(!pcs::translation(Vec3(0, bad, 0)).is_finite());
    BOOST_TEST(!pcs::rotation(Vec3(1, 0, 0), 1.0, Vec3(0, bad, 0)).is_finite());
    bool is_noticed = false;
    try {
      is_noticed = !pcs::Similarity::from_turn(Vec3(bad, 0, 0)).is_finite();
    } catch (const pcs::Invalid_input&) {
      is_noticed = true;
    }
    BOOST_TEST(is_noticed, "from_turn() with " << bad);
  }
}

BOOST_AUTO_TEST_CASE(matrices_of_similarities_are_accepted)
{
  std::mt19937 random(4);
  for (int repetition = 0; repetition < 100; ++repetition) {
    const auto s = random_similarity(random);
    const auto back = pcs::Similarity::from_matrix(matrix(s).topRows<3>());
    BOOST_TEST((matrix(back) - matrix(s)).norm() < 1e-12);
    BOOST_TEST(back.total_angle() <= pi + 1e-12);
  }
  BOOST_TEST(is_exact_identity(pcs::Similarity::from_matrix(affine(Eigen::Matrix3d::Identity()))));
  for (const double size : {1e-30, 1e30})
    BOOST_TEST(pcs::Similarity::from_matrix(affine(size * Eigen::Matrix3d::Identity())).scale() ==
                   size,
               boost::test_tools::tolerance(1e-12));
  // Half a turn: both directions are valid.
  const Eigen::Matrix3d half = Vec3(-1, -1, 1).asDiagonal();
  const auto s = pcs::Similarity::from_matrix(affine(half));
  BOOST_TEST((s.rotation() - half).norm() < 1e-12);
  BOOST_TEST(s.total_angle() == pi, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(matrices_of_anything_else_are_refused)
{
  using pcs_test::message_has;
  const auto from = [](const Eigen::Matrix3d& a, const Vec3& t = Vec3::Zero()) {
    return pcs::Similarity::from_matrix(affine(a, t));
  };
  Eigen::Matrix3d reflection = Vec3(1, 1, -1).asDiagonal(),
                  stretch = Vec3(1, 1, 1.001).asDiagonal(), shear = Eigen::Matrix3d::Identity(),
                  bad = shear;
  shear(0, 1) = 1e-3;
  bad(2, 2) = not_a_number;
  BOOST_CHECK_EXCEPTION(from(reflection), pcs::Invalid_input, message_has("determinant"));
  BOOST_CHECK_EXCEPTION(from(Eigen::Matrix3d::Zero()),
                        pcs::Invalid_input,
                        message_has("determinant"));
  BOOST_CHECK_EXCEPTION(from(stretch), pcs::Invalid_input, message_has("scale"));
  BOOST_CHECK_EXCEPTION(from(shear), pcs::Invalid_input, message_has("shear"));
  BOOST_CHECK_EXCEPTION(from(bad), pcs::Invalid_input, message_has("not finite"));
  BOOST_CHECK_EXCEPTION(from(Eigen::Matrix3d::Identity(), Vec3(infinity, 0, 0)),
                        pcs::Invalid_input,
                        message_has("not finite"));
}

BOOST_AUTO_TEST_CASE_TEMPLATE(transformations_of_cgal_are_accepted, Kernel, Kernels)
{
  using FT = typename Kernel::FT;
  using Transformation = CGAL::Aff_transformation_3<Kernel>;
  static_assert(pcs::is_similarity_like_v<Transformation>);
  const double tolerance = std::is_same_v<FT, float> ? 1e-6 : 1e-12;
  const Transformation shift(CGAL::TRANSLATION, typename Kernel::Vector_3(1, 2, 3));
  BOOST_TEST((pcs::to_similarity(shift).translation() - Vec3(1, 2, 3)).norm() == 0);
  BOOST_TEST(pcs::to_similarity(shift).turns().empty());

  const FT c = static_cast<FT>(std::cos(0.7)), s = static_cast<FT>(std::sin(0.7)), k = 2, o = 0;
  const Transformation turn(k * c, -k * s, o, 5, k * s, k * c, o, 6, o, o, k, 7);
  const auto found = pcs::to_similarity(turn);
  BOOST_TEST((found.turns().at(0) - Vec3(0, 0, 0.7)).norm() < tolerance);
  BOOST_TEST(std::abs(found.scale() - 2) < 2 * tolerance);

  const Transformation shear(1, FT(0.5), o, o, o, 1, o, o, o, o, 1, o);
  BOOST_CHECK_THROW(pcs::to_similarity(shear), pcs::Invalid_input);
  const Transformation mirror(-1, o, o, o, o, 1, o, o, o, o, 1, o);
  BOOST_CHECK_THROW(pcs::to_similarity(mirror), pcs::Invalid_input);

  Eigen::Isometry3d isometry(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  isometry.pretranslate(Vec3(1, 2, 3));
  const pcs::Similarity of_eigen = pcs::to_similarity(isometry);
  BOOST_TEST((of_eigen(Vec3(4, 5, 6)) - isometry * Vec3(4, 5, 6)).norm() < 1e-12);
  Eigen::Matrix4d matrix = isometry.matrix();
  BOOST_TEST((pcs::to_similarity(matrix)(Vec3(4, 5, 6)) - isometry * Vec3(4, 5, 6)).norm() < 1e-12);
  const Eigen::Affine3f single(isometry.cast<float>());
  BOOST_TEST((pcs::to_similarity(single)(Vec3(4, 5, 6)) - isometry * Vec3(4, 5, 6)).norm() < 1e-5);
  matrix(3, 0) = 0.1;
  BOOST_CHECK_THROW(pcs::to_similarity(matrix), pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE_TEMPLATE(points_and_vectors_of_cgal_serve_as_centre_and_axis, Kernel, Kernels)
{
  const auto s =
      pcs::rotation(typename Kernel::Vector_3(0, 0, 1), pi / 2, typename Kernel::Point_3(1, 0, 0));
  BOOST_TEST((s(Vec3(2, 0, 0)) - Vec3(1, 1, 0)).norm() < 1e-15);
  static_assert(!pcs::is_similarity_like_v<int>);
  static_assert(!pcs::is_similarity_like_v<typename Kernel::Point_3>);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Similarity
