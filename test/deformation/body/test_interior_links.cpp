// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Interior springs exist exactly where a body has an inside.

#include <pcs/deformation/body/interior_links.h>
#include <support/networks.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <map>

namespace test_interior_links {

namespace {

using pcs::deformation::Weighted_graph;
using pcs_test::Points;
using pcs_test::Vec3;
using Any_tag = CGAL::Parallel_if_available_tag;

Weighted_graph links_of(const pcs::deformation::Elastic_network& network)
{
  std::size_t count = 0;
  const auto component = connected_components(network.surface, count);
  return pcs::deformation::interior_links<Any_tag>(network, component);
}

Weighted_graph links_of(const Points& points)
{
  return links_of(pcs_test::network_of(points));
}

Points open_tube(int around, int rings, double radius, double length)
{
  Points points;
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < around; ++k) {
      const double a = 2 * 3.14159265358979323846 * (k + (r % 2 ? .5 : 0)) / around;
      points.emplace_back(radius * std::cos(a), radius * std::sin(a), length * r / (rings - 1));
    }
  return points;
}

struct Length_statistics
{
  double median = 0, longest = 0;
  std::size_t linked_nodes = 0;
};

Length_statistics lengths(const pcs::deformation::Elastic_network& network,
                          const Weighted_graph& links)
{
  std::vector<double> all;
  Length_statistics result;
  for (std::size_t i = 0; i < links.size(); ++i) {
    result.linked_nodes += links.degree(i) > 0 ? 1 : 0;
    for (auto j = links.begin(i); j != links.end(i); ++j)
      all.push_back((network.rest[*j] - network.rest[i]).norm());
  }
  if (all.empty())
    return result;
  std::sort(all.begin(), all.end());
  result.median = all[all.size() / 2];
  result.longest = all.back();
  return result;
}

void check_thickness(const Points& points, double thickness)
{
  const auto network = pcs_test::network_of(points);
  const auto links = links_of(network);
  BOOST_REQUIRE(links.size() == network.size());
  const auto l = lengths(network, links);
  BOOST_TEST(l.median == thickness, boost::test_tools::tolerance(0.1));
  BOOST_TEST(l.longest < 2.01 * thickness);
  BOOST_TEST(l.linked_nodes > network.size() / 2);
}

} // namespace

BOOST_AUTO_TEST_SUITE(interior_links)

BOOST_AUTO_TEST_CASE(a_closed_box_gets_links_of_its_thickness)
{
  check_thickness(pcs_test::box(10, 10, 40, 0.1), 1);
}

BOOST_AUTO_TEST_CASE(an_open_tube_gets_links_of_its_diameter)
{
  check_thickness(open_tube(40, 80, 0.5, 6), 1);
}

BOOST_AUTO_TEST_CASE(a_sphere_gets_links_of_its_diameter)
{
  check_thickness(pcs_test::sphere(2000), 2);
}

BOOST_AUTO_TEST_CASE(links_are_symmetric_positive_and_join_opposite_sides)
{
  const auto network = pcs_test::network_of(pcs_test::box(10, 10, 40, 0.1));
  const auto links = links_of(network);
  BOOST_REQUIRE(links.size() == network.size());
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> weight;
  for (std::uint32_t i = 0; i < links.size(); ++i)
    for (std::size_t e = links.first[i]; e < links.first[i + 1]; ++e)
      weight[{i, links.neighbor[e]}] = links.weight[e];
  for (const auto& [pair, w] : weight) {
    BOOST_REQUIRE((weight.at({pair.second, pair.first}) == w));
    BOOST_REQUIRE((std::isfinite(w) && w > 0));
    const Vec3 d = network.rest[pair.first] - network.rest[pair.second];
    BOOST_REQUIRE(d.norm() > 0.5); // not along the surface
  }
}

BOOST_AUTO_TEST_CASE(open_surfaces_get_none)
{
  BOOST_TEST(links_of(pcs_test::plate(40, 40, 0.1)).size() == 0u);
  Points wave = pcs_test::plate(60, 60, 0.1);
  for (Vec3& p : wave)
    p.z() = 0.5 * std::sin(p.x()) * std::cos(1.3 * p.y());
  BOOST_TEST(links_of(wave).size() == 0u);
}

BOOST_AUTO_TEST_CASE(two_sheets_joined_at_one_end_get_none)
{
  for (const double gap : {3.0, 5.0, 8.0})
    BOOST_TEST(links_of(pcs_test::sheets(60, 30, gap, true)).size() == 0u, "gap " << gap);
}

BOOST_AUTO_TEST_CASE(two_separate_sheets_are_not_linked)
{
  for (const double gap : {1.5, 3.0, 5.0})
    BOOST_TEST(links_of(pcs_test::sheets(40, 40, gap, false)).size() == 0u, "gap " << gap);
}

BOOST_AUTO_TEST_CASE(two_boxes_are_linked_within_and_not_between)
{
  Points points = pcs_test::box(8, 8, 24, 0.125);
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    points.push_back(points[i] + Vec3(2, 0, 0));
  const auto network = pcs_test::network_of(points);
  const auto links = links_of(network);
  BOOST_REQUIRE(links.size() == 2 * n);
  for (std::size_t i = 0; i < links.size(); ++i)
    for (auto j = links.begin(i); j != links.end(i); ++j)
      BOOST_REQUIRE((network.rest[i].x() < 1.5) == (network.rest[*j].x() < 1.5));
}

BOOST_AUTO_TEST_CASE(degenerate_clouds_get_none_and_no_harm)
{
  Points line, random = pcs_test::random_points(300, 1);
  for (int i = 0; i < 100; ++i)
    line.push_back(i * Vec3(.1, .2, .3));
  BOOST_TEST(links_of(line).size() == 0u);
  BOOST_TEST(links_of(Points{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}).size() == 0u);
  BOOST_TEST(links_of(Points{Vec3(0, 0, 0)}).size() == 0u);
  for (const double w : links_of(random).weight) // a filled cube has no surface: any finite weights
    BOOST_REQUIRE((std::isfinite(w) && w > 0));
  Points outlier = pcs_test::box(6, 6, 18, 1. / 6);
  outlier.push_back(Vec3(1e6, 1e6, 1e6)); // the rays must not traverse this distance step by step
  static_cast<void>(links_of(outlier));
}

BOOST_AUTO_TEST_CASE(rounding_does_not_choose_the_links)
{
  // On a regular box, rays from the edges pass two nodes at equal distances. A shifted or scaled
  // copy has differently rounded coordinates and must give the same choice.
  const Points points = pcs_test::box(6, 6, 24, 1. / 6);
  const auto network = pcs_test::network_of(points);
  const auto expected = links_of(network);
  for (const double size : {10.0, 1. / 3, 7.7}) {
    auto other = network;
    for (Vec3& p : other.rest)
      p *= size;
    const auto found = links_of(other);
    BOOST_TEST((found.neighbor == expected.neighbor), "size " << size);
  }
  auto shifted = network;
  const Vec3 shift(5e6, -5e6, 100);
  for (Vec3& p : shifted.rest)
    p = (p + shift) - shift;
  BOOST_TEST((links_of(shifted).neighbor == expected.neighbor), "shifted");
}

BOOST_AUTO_TEST_CASE(every_number_of_threads_gives_the_same_bits)
{
  const auto network = pcs_test::network_of(pcs_test::box(12, 12, 48, 1. / 12));
  std::size_t count = 0;
  const auto component = connected_components(network.surface, count);
  const auto expected = pcs::deformation::interior_links<CGAL::Sequential_tag>(network, component);
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      const auto found = pcs::deformation::interior_links<Any_tag>(network, component);
      BOOST_TEST((found.neighbor == expected.neighbor && found.weight == expected.weight));
    });
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_interior_links
