// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the borders of handles with a search over all edges, and the bands around them with
// Bellman's equations.

#include <pcs/deformation/handles/Border_finder.h>
#include <pcs/deformation/upsampling/border_fade.h>
#include <support/networks.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace test_border_fade {

namespace {

using namespace pcs::deformation;
using pcs_test::Points;
using pcs_test::Vec3;
using Tag = CGAL::Sequential_tag;

/// A cloud of several search blocks, with two handles, and the spacings of four samples.
struct Cloud
{
  Points sites = pcs_test::in_spatial_order(pcs_test::plate(60, 40, 0.5));
  pcs::neighborhood::Proximity_graph graph =
      pcs::neighborhood::nearest_neighbor_graph<Tag>(sites, 6);
  std::vector<std::uint32_t> sample_of_site;
  std::vector<double> spacing{3, 5, 1, 4};

  Cloud()
  {
    for (const Vec3& p : sites)
      sample_of_site.push_back((p.x() < 15 ? 0u : 1u) + (p.y() < 10 ? 0u : 2u));
  }

  Node_constraint handle(std::size_t site) const
  {
    const Vec3& p = sites[site];
    return (p - Vec3(20, 20, 0)).norm() < 8 ? 0 : p.x() < 6 ? 1 : free_node;
  }

  std::vector<Border_edge> border() const
  {
    return Border_finder(graph).find<Tag>(graph, [&](std::size_t s) { return handle(s) >= 0; });
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(border_fade)

BOOST_AUTO_TEST_CASE(all_edges_out_of_handles_are_found_in_order)
{
  const Cloud cloud;
  BOOST_REQUIRE(cloud.sites.size() > 4 * 256);
  std::vector<Border_edge> all;
  for (std::uint32_t i = 0; i < cloud.graph.size(); ++i)
    for (auto j = cloud.graph.begin(i); j != cloud.graph.end(i); ++j)
      if (cloud.handle(i) >= 0 && cloud.handle(*j) < 0)
        all.push_back({i, *j});
  const auto found = cloud.border();
  BOOST_REQUIRE(found.size() == all.size());
  BOOST_TEST(all.size() > 100u);
  for (std::size_t e = 0; e < all.size(); ++e)
    BOOST_TEST((found[e].inside == all[e].inside && found[e].outside == all[e].outside));
}

BOOST_AUTO_TEST_CASE(edges_between_whole_blocks_are_found)
{
  const Cloud cloud;
  const auto is_inside = [](std::size_t site) { return site / 256 % 3 == 0; };
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.graph.size(); ++i)
    for (auto j = cloud.graph.begin(i); j != cloud.graph.end(i); ++j)
      count += is_inside(i) && !is_inside(*j) ? 1 : 0;
  BOOST_TEST(count > 100u);
  BOOST_TEST(Border_finder(cloud.graph).find<Tag>(cloud.graph, is_inside).size() == count);
}

BOOST_AUTO_TEST_CASE(one_site_and_none_have_no_borders)
{
  const pcs::neighborhood::Proximity_graph none, one{{0, 0}, {}};
  const auto inside = [](std::size_t) { return true; };
  BOOST_TEST(Border_finder(none).find<Tag>(none, inside).empty());
  BOOST_TEST(Border_finder(one).find<Tag>(one, inside).empty());
}

/// Weights of the handles after all fades of a site, in order of the handles; the last value is the
/// weight of the samples.
std::array<double, 3> parts(const std::vector<Border_fade>& fades, std::size_t site)
{
  std::array<double, 3> part{0, 0, 1};
  for (const Border_fade& f : fades)
    if (f.site == site) {
      for (double& p : part)
        p *= 1 - f.weight;
      part[static_cast<std::size_t>(f.handle)] += f.weight;
    }
  return part;
}

/// Iterates to convergence: distances of all sites to one handle, in spacings; infinite beyond 1.
std::vector<double> distances(const Cloud& cloud, Node_constraint handle)
{
  const auto rate = [&](std::size_t i) { return 1 / cloud.spacing[cloud.sample_of_site[i]]; };
  std::vector<double> distance(cloud.sites.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < distance.size(); ++i)
    if (cloud.handle(i) == handle)
      distance[i] = 0;
  for (bool changes = true; changes;) {
    changes = false;
    for (std::size_t i = 0; i < distance.size(); ++i)
      for (auto j = cloud.graph.begin(i); j != cloud.graph.end(i); ++j) {
        const double d =
            distance[i] + (cloud.sites[*j] - cloud.sites[i]).norm() * (rate(i) + rate(*j)) / 2;
        if (cloud.handle(*j) < 0 && d < 1 && d < distance[*j]) {
          distance[*j] = d;
          changes = true;
        }
      }
  }
  return distance;
}

std::vector<Border_fade> fades_of(const Cloud& cloud)
{
  return border_fades(
      cloud.graph,
      cloud.border(),
      cloud.sample_of_site,
      cloud.spacing,
      [&](std::size_t s) { return cloud.handle(s); },
      [&](std::size_t s) { return cloud.sites[s]; });
}

BOOST_AUTO_TEST_CASE(shares_are_those_of_the_distance_to_the_handle)
{
  const Cloud cloud;
  const auto fades = fades_of(cloud);
  const std::vector<double> to_first = distances(cloud, 0), to_second = distances(cloud, 1);
  std::size_t count = 0;
  double largest_error = 0;
  for (std::size_t i = 0; i < cloud.sites.size(); ++i) {
    const double d = std::min(to_first[i], to_second[i]);
    if (cloud.handle(i) >= 0 || !(d < 1))
      continue;
    BOOST_REQUIRE(count < fades.size());
    BOOST_REQUIRE(fades[count].site == i);
    BOOST_TEST(fades[count].handle == (to_first[i] < 1 ? 0 : 1));
    largest_error = std::max(largest_error, std::abs(fades[count].weight - std::pow(1 - d, 2)));
    ++count;
  }
  BOOST_TEST(count == fades.size()); // the bands of the two handles do not overlap
  BOOST_TEST(count > 200u);
  BOOST_TEST(largest_error < 1e-12);
}

BOOST_AUTO_TEST_CASE(between_two_handles_the_shares_pass_from_one_to_the_other)
{
  Cloud cloud;
  cloud.spacing = {8, 9, 10, 8.5}; // the bands overlap: 6 lie between the handles
  const auto fades = fades_of(cloud);
  const std::vector<double> to_first = distances(cloud, 0), to_second = distances(cloud, 1);
  std::size_t shared = 0, far = 0;
  double steepest = 0;
  for (std::size_t i = 0; i < cloud.sites.size(); ++i) {
    if (cloud.handle(i) >= 0)
      continue;
    const auto part = parts(fades, i);
    const double a = std::min(1.0, to_first[i]), b = std::min(1.0, to_second[i]);
    shared += a < 1 && b < 1 ? 1 : 0;
    far += part[2] > 0.3 ? 1 : 0;
    BOOST_TEST(part[0] + part[1] + part[2] == 1, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(*std::min_element(part.begin(), part.end()) >= 0);
    // The weight of a handle is one at its border, and at least its weight with both handles
    // merged.
    BOOST_TEST(part[0] + part[1] >= std::pow(1 - std::min(a, b), 2) - 1e-12);
    BOOST_TEST(part[a < b ? 0 : 1] >= part[a < b ? 1 : 0]);
    for (auto j = cloud.graph.begin(i); j != cloud.graph.end(i); ++j) {
      if (cloud.handle(*j) >= 0)
        continue;
      const auto other = parts(fades, *j);
      const double spacings = (cloud.sites[*j] - cloud.sites[i]).norm() / 8;
      for (std::size_t h = 0; h < 3; ++h)
        steepest = std::max(steepest, std::abs(other[h] - part[h]) / spacings);
    }
  }
  BOOST_TEST(shared > 100u);
  BOOST_TEST(far > 10u);
  // With one handle the slope is 2. Using only the nearest handle causes a jump in the middle.
  BOOST_TEST(steepest < 2.5);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_border_fade
