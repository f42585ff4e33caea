// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests deform_point_set() with every kernel and every kind of point storage.

#include <pcs/deform_point_set.h>
#include <support/archetypes.h>
#include <support/deform_cloud.h>

#include <CGAL/Aff_transformation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Point_set_3.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <boost/mpl/list.hpp>
#include <boost/test/unit_test.hpp>

#include <array>
#include <deque>
#include <set>
#include <tuple>

namespace test_deform_point_set {

namespace {

using pcs_test::Points;
using pcs_test::Vec3;
using Kernels = boost::mpl::list<CGAL::Simple_cartesian<float>,
                                 CGAL::Simple_cartesian<double>,
                                 CGAL::Exact_predicates_inexact_constructions_kernel>;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

constexpr int number_of_samples = 150;

/// The edit of all tests, and its result on plain vectors.
struct Reference
{
  pcs_test::Bar_edit edit;
  std::vector<std::size_t> fixed = edit.handles[0].indices, moved = edit.handles[1].indices;
  pcs::Similarity motion = edit.handles[1].transformation;
  pcs_test::Deformed expected;

  /// The points with coordinates that numbers of type `FT` represent.
  template <class FT>
  static const Reference& of()
  {
    static const Reference r([](double x) { return static_cast<double>(static_cast<FT>(x)); });
    return r;
  }

  template <class Round>
  explicit Reference(const Round& round)
  {
    Points normals = pcs_test::arbitrary_normals(edit.points.size());
    for (Points* vectors : {&edit.points, &normals})
      for (Vec3& v : *vectors)
        v = Vec3(round(v.x()), round(v.y()), round(v.z()));
    pcs_test::Options options;
    options.number_of_samples = number_of_samples;
    expected = pcs_test::deform(edit.points, edit.handles, options, normals);
  }

  /// Largest distance to the expected points; `at(i)` returns point i.
  template <class At>
  double error(const At& at) const
  {
    double largest = 0;
    for (std::size_t i = 0; i < edit.points.size(); ++i)
      largest = std::max(largest, (to_eigen(at(i)) - expected.points[i]).norm());
    return largest;
  }
  template <class At>
  double normal_error(const At& at) const
  {
    double largest = 0;
    for (std::size_t i = 0; i < edit.points.size(); ++i)
      largest = std::max(largest, (to_eigen(at(i)) - expected.normals[i]).norm());
    return largest;
  }
  template <class Triple>
  static Vec3 to_eigen(const Triple& p)
  {
    return {double(p.x()), double(p.y()), double(p.z())};
  }
};

const Reference& reference()
{
  return Reference::of<double>();
}

template <class Triple, class FT = std::decay_t<decltype(std::declval<const Triple&>().x())>>
std::vector<Triple> converted(const Points& points)
{
  std::vector<Triple> result;
  for (const Vec3& p : points)
    result.emplace_back(FT(p.x()), FT(p.y()), FT(p.z()));
  return result;
}

/// Rounding error of the results.
template <class K>
constexpr double tolerance = std::is_same_v<typename K::FT, float> ? 1e-6 : 1e-12;

} // namespace

BOOST_AUTO_TEST_SUITE(deform_point_set)

BOOST_AUTO_TEST_CASE_TEMPLATE(points_of_every_kernel, K, Kernels)
{
  const auto& r = Reference::of<typename K::FT>();
  auto points = converted<typename K::Point_3>(r.edit.points);
  const auto report = pcs::deform_point_set(points,
                                            r.fixed,
                                            r.moved,
                                            r.motion,
                                            pcs::parameters::number_of_samples(number_of_samples));
  BOOST_TEST(report.status == pcs::Status::converged);
  BOOST_TEST(r.error([&](std::size_t i) { return points[i]; }) < tolerance<K>);
}

BOOST_AUTO_TEST_CASE_TEMPLATE(pairs_with_maps_of_every_kernel, K, Kernels)
{
  const auto& r = Reference::of<typename K::FT>();
  using Element = std::pair<typename K::Point_3, typename K::Vector_3>;
  const auto p = converted<typename K::Point_3>(r.edit.points);
  const auto n = converted<typename K::Vector_3>(pcs_test::arbitrary_normals(p.size()));
  std::vector<Element> elements;
  for (std::size_t i = 0; i < p.size(); ++i)
    elements.emplace_back(p[i], n[i]);
  pcs::deform_point_set<CGAL::Sequential_tag>(
      elements,
      r.fixed,
      r.moved,
      r.motion,
      pcs::parameters::normal_map(CGAL::Second_of_pair_property_map<Element>())
          .number_of_samples(number_of_samples)
          .point_map(CGAL::First_of_pair_property_map<Element>()));
  BOOST_TEST(r.error([&](std::size_t i) { return elements[i].first; }) < tolerance<K>);
  BOOST_TEST(r.normal_error([&](std::size_t i) { return elements[i].second; }) < 10 * tolerance<K>);
}

BOOST_AUTO_TEST_CASE(a_chain_of_cgal_serves_as_well)
{
  const auto& r = reference();
  using Element = std::tuple<int, Kernel::Point_3>;
  std::vector<Element> elements;
  for (const auto& p : converted<Kernel::Point_3>(r.edit.points))
    elements.emplace_back(7, p);
  pcs::deform_point_set(elements,
                        r.fixed,
                        r.moved,
                        r.motion,
                        CGAL::parameters::point_map(CGAL::Nth_of_tuple_property_map<1, Element>()));
  // Fewer points than the default number of samples: full resolution.
  pcs_test::Options options;
  const auto expected = pcs_test::deform(r.edit.points, r.edit.handles, options);
  for (std::size_t i = 0; i < elements.size(); ++i) {
    BOOST_TEST(std::get<0>(elements[i]) == 7);
    BOOST_REQUIRE((Reference::to_eigen(std::get<1>(elements[i])) - expected.points[i]).norm() <
                  1e-12);
  }
}

BOOST_AUTO_TEST_CASE(a_point_set_3_with_normals)
{
  const auto& r = reference();
  CGAL::Point_set_3<Kernel::Point_3> points;
  points.add_normal_map();
  const auto p = converted<Kernel::Point_3>(r.edit.points);
  const auto n = converted<Kernel::Vector_3>(pcs_test::arbitrary_normals(p.size()));
  for (std::size_t i = 0; i < p.size(); ++i)
    points.insert(p[i], n[i]);
  pcs::deform_point_set(points,
                        r.fixed,
                        r.moved,
                        r.motion,
                        pcs::parameters::point_map(points.point_map())
                            .normal_map(points.normal_map())
                            .number_of_samples(number_of_samples));
  BOOST_TEST(r.error([&](std::size_t i) { return points.point(*(points.begin() + long(i))); }) <
             1e-12);
  BOOST_TEST(r.normal_error([&](std::size_t i) {
    return points.normal(*(points.begin() + long(i)));
  }) < 1e-12);
}

BOOST_AUTO_TEST_CASE(archetypes_of_range_key_map_and_value)
{
  const auto& r = reference();
  using Point = pcs_test::Triple_archetype<double>;
  auto points = converted<Point>(r.edit.points);
  auto normals = converted<Point>(pcs_test::arbitrary_normals(points.size()));
  pcs_test::Range_archetype range(points.size());
  const auto np = pcs::parameters::point_map(pcs_test::Map_archetype<Point>(points))
                      .normal_map(pcs_test::Map_archetype<Point>(normals))
                      .number_of_samples(number_of_samples);
  pcs::deform_point_set(range, r.fixed, r.moved, r.motion, np);
  BOOST_TEST(r.error([&](std::size_t i) { return points[i]; }) < 1e-12);
  BOOST_TEST(r.normal_error([&](std::size_t i) { return normals[i]; }) < 1e-12);

  // Handles and region of interest as single pass ranges of another integer type.
  points = converted<Point>(r.edit.points);
  normals = converted<Point>(pcs_test::arbitrary_normals(points.size()));
  const auto n = static_cast<short>(points.size());
  const auto report =
      pcs::deform_point_set(range,
                            pcs_test::Index_range_archetype(0, 10),
                            pcs_test::Index_range_archetype(static_cast<short>(n - 10), n),
                            r.motion,
                            np.region_of_interest(pcs_test::Index_range_archetype(0, n)));
  BOOST_TEST(report.status == pcs::Status::converged);

  pcs::Point_set_deformation<pcs_test::Range_archetype, std::decay_t<decltype(np)>> session(range,
                                                                                            np);
  session.add_handle(pcs_test::Index_range_archetype(0, 10));
  const auto top = session.add_handle(pcs_test::Index_range_archetype(20, 25));
  session.set_rotation(top, Point(0, 0, 1), 0.1, Point(0, 0, 0));
  session.set_rotation(top, Point(0, 0, 1), 0.1);
  session.set_translation(top, Point(0, 0, 1));
  session.set_scale(top, 1.1);
  static_cast<void>(session.centroid(top).x());
  session.restore(session.snapshot());
  session.deform();
  session.accept();
  session.reset();
}

BOOST_AUTO_TEST_CASE(handles_may_be_any_range_of_integers)
{
  const auto& r = reference();
  const auto np = pcs::parameters::number_of_samples(number_of_samples);
  const auto check = [&](const auto& fixed, const auto& moved) {
    Points points = r.edit.points;
    pcs::deform_point_set(points, fixed, moved, r.motion, np);
    BOOST_TEST(r.error([&](std::size_t i) { return points[i]; }) < 1e-12);
  };
  check(std::set<std::size_t>(r.fixed.begin(), r.fixed.end()),
        std::deque<int>(r.moved.begin(), r.moved.end()));
  // Without fixed points, all points follow.
  Points points = r.edit.points;
  pcs::deform_point_set(points, std::vector<unsigned char>(), r.moved, r.motion, np);
  for (std::size_t i = 0; i < points.size(); ++i)
    BOOST_REQUIRE((points[i] - r.motion(r.edit.points[i])).norm() < 1e-9);
}

BOOST_AUTO_TEST_CASE(several_handles_with_their_own_motions)
{
  const auto& r = reference();
  Points points = r.edit.points;
  pcs::deform_point_set(points,
                        r.edit.handles,
                        pcs::parameters::number_of_samples(number_of_samples));
  BOOST_TEST(r.error([&](std::size_t i) { return points[i]; }) < 1e-12);
  const std::array<pcs::Deformation_handle, 2> handles{r.edit.handles[0], r.edit.handles[1]};
  points = r.edit.points;
  pcs::deform_point_set(points, handles, pcs::parameters::number_of_samples(number_of_samples));
  BOOST_TEST(r.error([&](std::size_t i) { return points[i]; }) < 1e-12);
}

BOOST_AUTO_TEST_CASE(a_transformation_of_cgal_moves_the_points)
{
  const auto& r = reference();
  const CGAL::Aff_transformation_3<Kernel> shift(CGAL::TRANSLATION, Kernel::Vector_3(0, .5, 0));
  Points points = r.edit.points;
  pcs::deform_point_set(points, r.fixed, r.moved, shift);
  for (const auto i : r.moved)
    BOOST_REQUIRE((points[i] - (r.edit.points[i] + Vec3(0, .5, 0))).norm() < 1e-12);
  const CGAL::Aff_transformation_3<Kernel> shear(1, .5, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0);
  points = r.edit.points;
  BOOST_CHECK_THROW(pcs::deform_point_set(points, r.fixed, r.moved, shear), pcs::Invalid_input);
  BOOST_TEST((points == r.edit.points));
}

BOOST_AUTO_TEST_CASE(numbers_of_the_parameters_may_have_any_type)
{
  const auto& r = reference();
  Points points = r.edit.points;
  pcs::deform_point_set(points,
                        r.fixed,
                        r.moved,
                        r.motion,
                        pcs::parameters::number_of_samples(static_cast<short>(number_of_samples))
                            .stiffness(1)
                            .tolerance(0.05f)
                            .poisson_ratio(0)
                            .number_of_iterations(20u));
  BOOST_TEST(r.error([&](std::size_t i) { return points[i]; }) < 1e-3);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_deform_point_set
