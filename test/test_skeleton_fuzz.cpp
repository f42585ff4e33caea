// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Skeletons and surfaces of random degenerate clouds: a valid tree or a clear result, never a
// crash, a NaN or an endless loop. PCS_FUZZ_FIRST and PCS_FUZZ_COUNT select the seeds.

#include <pcs/extract_tree_skeleton.h>
#include <pcs/make_branch_surface.h>
#include <support/tree_clouds.h>

#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace test_skeleton_fuzz {

using pcs_test::Tree;
using Point = pcs_test::Tree_point;
using Vector = pcs_test::Tree_vector;
using Cloud = std::vector<Point>;

namespace {

/// All random parameters of one round.
class Round
{
public:
  explicit Round(unsigned seed) : m_random(seed) {}

  double share() { return std::uniform_real_distribution<double>(0, 1)(m_random); }
  double normal() { return std::normal_distribution<double>()(m_random); }
  std::size_t below(std::size_t n) { return m_random() % n; }
  bool one_in(std::size_t n) { return below(n) == 0; }

  /// One to four bodies: quantised, repeated, shifted, scaled or with outliers.
  Cloud cloud()
  {
    Cloud points;
    for (std::size_t k = 1 + below(4); k > 0; --k)
      pcs_test::append(points, body());
    if (one_in(3))
      for (Point& p : points)
        p = rounded(p, 0.1);
    if (one_in(3))
      for (std::size_t k = below(200); k > 0 && !points.empty(); --k)
        points.push_back(points[below(points.size())]);
    if (one_in(4))
      points.insert(points.end(), below(300), Point(0, 0, 0));
    if (one_in(4))
      for (std::size_t k = below(4); k > 0; --k)
        points.emplace_back(1e3 * normal(), 1e6 * normal(), 1e2 * normal());
    const double scale = one_in(3) ? std::pow(10.0, -12 + 24 * share()) : 1;
    const Vector shift = one_in(3) ? Vector(5e5, 5e6, 300) : Vector(0, 0, 0);
    for (Point& p : points)
      p = Point(scale * p.x(), scale * p.y(), scale * p.z()) + shift;
    if (one_in(40) && !points.empty())
      points[below(points.size())] = Point(0, one_in(2) ? std::nan("") : 1e308, 0);
    return points;
  }

private:
  static Point rounded(const Point& p, double step)
  {
    return Point(step * std::round(p.x() / step),
                 step * std::round(p.y() / step),
                 step * std::round(p.z() / step));
  }

  Cloud body()
  {
    const std::size_t n = below(one_in(4) ? 600 : 60), kind = below(9);
    const Point base(normal(), normal(), one_in(2) ? 0 : normal());
    const Vector a(normal(), normal(), normal()), b(normal(), normal(), normal());
    const double thin = std::pow(10.0, -6 * share());
    Cloud points;
    for (std::size_t i = 0; i < n; ++i) {
      const double t = share(), s = share(), angle = 2 * CGAL_PI * s;
      switch (kind) {
      case 0: // line, with or without width
        points.push_back(base + t * a + 1e-3 * thin * normal() * b);
        break;
      case 1: // equal steps on a line
        points.push_back(base + double(i) * 0.01 * a);
        break;
      case 2: // parallelogram
        points.push_back(base + t * a + s * b);
        break;
      case 3: // coincident points
        points.push_back(base);
        break;
      case 4: // random points
        points.push_back(base + thin * Vector(normal(), normal(), normal()));
        break;
      case 5: // upright tube
        points.push_back(base +
                         Vector(0.2 * thin * std::cos(angle), 0.2 * thin * std::sin(angle), 3 * t));
        break;
      case 6: // grid
        points.push_back(base + 0.1 * Vector(double(i % 5), double(i / 5 % 5), double(i / 25)));
        break;
      case 7: // hoop
        points.push_back(base + Vector(std::cos(angle), std::sin(angle), 0));
        break;
      default: // two distant positions
        points.push_back(base + (i % 2 == 0 ? 1e-3 : 100.0) * a + 1e-3 * t * b);
      }
    }
    return points;
  }

  std::mt19937 m_random;
};

unsigned number_from(const char* name, unsigned otherwise)
{
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

/// Checks that all edges are closed, and that no vertex is missing or infinite.
std::string fault_of(const std::vector<Point>& points,
                     const std::vector<std::array<std::size_t, 3>>& triangles)
{
  for (const Point& p : points)
    if (!std::isfinite(p.x()) || !std::isfinite(p.y()) || !std::isfinite(p.z()))
      return "a vertex is not finite";
  std::vector<std::array<std::size_t, 2>> ahead, back;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      if (t[k] >= points.size())
        return "a vertex does not exist";
      ahead.push_back({t[k], t[(k + 1) % 3]});
      back.push_back({t[(k + 1) % 3], t[k]});
    }
  std::sort(ahead.begin(), ahead.end());
  std::sort(back.begin(), back.end());
  return ahead == back ? "" : "the surface is not closed";
}

std::string run(unsigned seed)
{
  Round round(seed);
  const Cloud points = round.cloud();
  std::vector<std::size_t> numbers(points.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = i;
  const auto identity = boost::typed_identity_property_map<std::size_t>();
  std::vector<std::size_t> branch(points.size(), 0);
  std::vector<double> residual(points.size(), 0);
  const auto method =
      round.one_in(3) ? pcs::Skeleton_method::sections : pcs::Skeleton_method::chains;
  const auto np =
      pcs::parameters::point_map(boost::make_iterator_property_map(points.begin(), identity))
          .point_branch_map(boost::make_iterator_property_map(branch.begin(), identity))
          .point_residual_map(boost::make_iterator_property_map(residual.begin(), identity))
          .skeleton_method(method)
          .do_remove_ground(!round.one_in(4))
          .up_direction(Vector(round.normal(), round.normal(), round.normal()));
  Tree tree;
  pcs::Skeleton_report report;
  try {
    report = pcs::extract_tree_skeleton(numbers, tree, np);
  } catch (const pcs::Invalid_input&) {
    return num_vertices(tree) == 0 ? "" : "the tree was touched";
  }
  if (report.status == pcs::Status::nothing_to_do)
    return num_vertices(tree) == 0 ? "" : "nothing to do, but there are nodes";
  const std::string fault = pcs_test::fault_of(tree);
  if (!fault.empty())
    return fault;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::isfinite(residual[i]) ||
        (branch[i] != pcs::npos && branch[i] >= report.number_of_branches))
      return "point " + std::to_string(i) + " has a wrong branch or residual";
  for (const double value : {report.height, report.total.length, report.total.volume})
    if (!std::isfinite(value) || value < 0)
      return "a figure of the report is wrong";
  for (const bool do_join : {true, false}) {
    std::vector<Point> vertices;
    std::vector<std::array<std::size_t, 3>> triangles;
    pcs::make_branch_surface(tree, vertices, triangles, pcs::parameters::do_join(do_join));
    const std::string surface_fault = fault_of(vertices, triangles);
    if (!surface_fault.empty())
      return surface_fault;
  }
  return "";
}

} // namespace

BOOST_AUTO_TEST_SUITE(tree_skeleton_fuzz)

BOOST_AUTO_TEST_CASE(any_cloud_has_a_valid_tree_or_none)
{
  const unsigned first = number_from("PCS_FUZZ_FIRST", 1);
  const unsigned count = number_from("PCS_FUZZ_COUNT", 400);
  for (unsigned seed = first; seed < first + count; ++seed) {
    std::string fault;
    BOOST_CHECK_NO_THROW(fault = run(seed));
    BOOST_TEST(fault == "", "seed " << seed << ": " << fault);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_skeleton_fuzz
