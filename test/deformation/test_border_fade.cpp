// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Borders of handles against a search through all edges, and the bands around them against Bellman's equations.

#include <pcs/deformation/Border_finder.h>
#include <pcs/deformation/border_fade.h>
#include <support/networks.h>

#include <boost/test/unit_test.hpp>

namespace {

using namespace pcs::deformation;
using pcs_test::Points;
using pcs_test::Vec3;
using Tag = CGAL::Sequential_tag;

/// A cloud of several blocks of the finder, with two handles, and four samples' spacings.
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
      sample_of_site.push_back((p.x() < 30 ? 0u : 1u) + (p.y() < 20 ? 0u : 2u));
  }

  Node_constraint handle(std::size_t site) const
  {
    const Vec3& p = sites[site];
    return (p - Vec3(20, 20, 0)).norm() < 8 ? 0 : p.x() > 50 ? 1 : free_node;
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

BOOST_AUTO_TEST_CASE(shares_are_those_of_the_distance_to_the_handle)
{
  const Cloud cloud;
  const auto handle = [&](std::size_t s) { return cloud.handle(s); };
  const auto fades = border_fades(cloud.graph,
                                  cloud.border(),
                                  cloud.sample_of_site,
                                  cloud.spacing,
                                  handle,
                                  [&](std::size_t s) { return cloud.sites[s]; });
  // Sweeps until nothing changes; a site inherits the width of the band from where it was reached.
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> distance(cloud.sites.size(), infinity), radius(cloud.sites.size(), 0);
  for (std::size_t i = 0; i < distance.size(); ++i)
    if (cloud.handle(i) >= 0) {
      distance[i] = 0;
      radius[i] = cloud.spacing[cloud.sample_of_site[i]];
    }
  for (bool changes = true; changes;) {
    changes = false;
    for (std::size_t i = 0; i < distance.size(); ++i)
      for (auto j = cloud.graph.begin(i); j != cloud.graph.end(i); ++j) {
        const double d = distance[i] + (cloud.sites[*j] - cloud.sites[i]).norm();
        if (cloud.handle(*j) < 0 && d < radius[i] && d < distance[*j]) {
          distance[*j] = d;
          radius[*j] = radius[i];
          changes = true;
        }
      }
  }
  std::size_t count = 0;
  double largest_error = 0;
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (cloud.handle(i) >= 0 || distance[i] == infinity)
      continue;
    BOOST_REQUIRE(count < fades.size());
    BOOST_REQUIRE(fades[count].site == i);
    BOOST_TEST((fades[count].weight > 0 && fades[count].weight <= 1));
    const double share = distance[i] / radius[i];
    largest_error =
        std::max(largest_error, std::abs(fades[count].weight - std::pow(1 - share * share, 2)));
    ++count;
  }
  BOOST_TEST(count == fades.size());
  BOOST_TEST(count > 200u);
  BOOST_TEST(largest_error < 1e-12);
}

BOOST_AUTO_TEST_SUITE_END()
