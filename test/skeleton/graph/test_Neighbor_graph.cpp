// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares merged points, links and shortest paths of a scan with brute-force results.

#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <support/drawn.h>

#include <CGAL/tags.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/connected_components.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <boost/property_map/function_property_map.hpp>
#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace test_neighbor_graph {

namespace {

using Any_tag = CGAL::Parallel_if_available_tag;
using pcs::skeleton::Index;
using pcs::skeleton::Link;
using pcs::skeleton::Links;
using pcs::skeleton::Neighbor_graph;
using pcs::skeleton::none;
using pcs::skeleton::Scan;
using pcs::skeleton::Vec3;

/// Sheets of `count` points each, stacked at a distance that only gap closing bridges.
struct Sheets
{
  Scan scan;
  std::vector<std::uint8_t> is_used;

  Sheets(int number, int count, double apart)
  {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share(0, 1);
    std::vector<Vec3> points;
    const double side =
        std::sqrt(double(count)); // one point per unit of area: half a unit to the nearest
    for (int sheet = 0; sheet < number; ++sheet)
      for (int i = 0; i < count; ++i)
        points.emplace_back(side * share(random), side * share(random), apart * sheet);
    pcs::skeleton::prepare_scan<Any_tag>(points, Vec3::UnitZ(), scan);
    for (std::size_t i = 0; i < scan.size(); ++i)
      is_used.push_back(share(random) < 0.9);
  }
};

std::vector<std::pair<Index, Index>> sorted(const Links& links)
{
  std::vector<std::pair<Index, Index>> pairs;
  for (const Link& l : links)
    pairs.emplace_back(l.first, l.second);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// The smallest point index in the component of each point; `none` for unused points.
std::vector<Index> least_of_parts(const std::vector<Index>& part)
{
  std::vector<Index> least(part.size(), none), result(part.size(), none);
  for (Index i = 0; i < part.size(); ++i)
    if (part[i] != none)
      result[i] = least[part[i]] = std::min(least[part[i]], i);
  return result;
}

using Boost_graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;

Boost_graph to_boost(const Neighbor_graph& graph)
{
  Boost_graph result(graph.number_of_points());
  for (Index v = 0; v < graph.number_of_points(); ++v)
    for (const Index* w = graph.begin(v); w != graph.end(v); ++w)
      add_edge(v, *w, result);
  return result;
}

bool are_equal(const Neighbor_graph& a, const Neighbor_graph& b)
{
  bool are = a.number_of_points() == b.number_of_points();
  for (Index v = 0; are && v < a.number_of_points(); ++v)
    are = std::equal(a.begin(v), a.end(v), b.begin(v), b.end(v));
  return are;
}

void check_paths(const Scan& scan,
                 const Neighbor_graph& neighbors,
                 const std::vector<Index>& sources)
{
  const pcs::skeleton::Shortest_paths found = shortest_paths(scan, neighbors, sources);
  const Boost_graph graph = to_boost(neighbors);
  using Edge = boost::graph_traits<Boost_graph>::edge_descriptor;
  const auto cost = boost::make_function_property_map<Edge, double>([&](const Edge& e) {
    return pcs::skeleton::step_cost(scan,
                                    static_cast<Index>(source(e, graph)),
                                    static_cast<Index>(target(e, graph)));
  });
  std::vector<double> distance(scan.size());
  boost::dijkstra_shortest_paths(
      graph,
      sources.begin(),
      sources.end(),
      boost::dummy_property_map(),
      boost::make_iterator_property_map(distance.begin(), get(boost::vertex_index, graph)),
      cost,
      get(boost::vertex_index, graph),
      std::less<double>(),
      std::plus<double>(),
      std::numeric_limits<double>::infinity(),
      0.0,
      boost::default_dijkstra_visitor());
  BOOST_TEST((found.distance == distance)); // bit-identical
  std::size_t wrong = 0, reached = 0;
  for (Index i = 0; i < scan.size(); ++i) {
    const Index from = found.predecessor[i];
    reached += std::isfinite(distance[i]);
    if (from != i)
      wrong += found.distance[from] + pcs::skeleton::step_cost(scan, from, i) != distance[i];
    else
      wrong += std::isfinite(distance[i]) &&
               std::find(sources.begin(), sources.end(), i) == sources.end();
  }
  BOOST_TEST(wrong == 0u);
  BOOST_TEST(reached >= sources.size());
}

} // namespace

BOOST_AUTO_TEST_SUITE(neighbor_graph)

BOOST_AUTO_TEST_CASE(links_are_those_of_near_neighbours_each_once)
{
  const Sheets s(2, 6000, 40);
  const pcs::skeleton::Link_rule rule;
  std::vector<std::pair<Index, Index>> expected;
  for (Index i = 0; i < s.scan.size(); ++i)
    for (const Index j : s.scan.neighbors[i]) {
      const double longest = std::max(rule.longest(s.scan, i), rule.longest(s.scan, j));
      if (s.is_used[i] && s.is_used[j] &&
          (s.scan.points[i] - s.scan.points[j]).squaredNorm() <= longest * longest)
        expected.emplace_back(std::min(i, j), std::max(i, j));
    }
  std::sort(expected.begin(), expected.end());
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  const Links links = pcs::skeleton::neighbor_links<Any_tag>(s.scan, s.is_used, rule);
  BOOST_TEST(expected.size() > 10000u);
  BOOST_TEST((sorted(links) == expected));
  const Links others = pcs::skeleton::neighbor_links<CGAL::Sequential_tag>(s.scan, s.is_used, rule);
  BOOST_TEST(std::equal(links.begin(),
                        links.end(),
                        others.begin(),
                        others.end(),
                        [](const Link& a, const Link& b) { return !(a < b) && !(b < a); }));
}

BOOST_AUTO_TEST_CASE(parts_are_those_of_boost)
{
  const Sheets s(3, 25000, 40);
  Links links = pcs::skeleton::neighbor_links<Any_tag>(s.scan, s.is_used, {});
  BOOST_TEST(links.size() > 3u * (1 << 17)); // several blocks
  const Boost_graph graph = to_boost(pcs::skeleton::graph_of(s.scan.size(), links));
  std::vector<Index> component(s.scan.size());
  boost::connected_components(
      graph,
      boost::make_iterator_property_map(component.begin(), get(boost::vertex_index, graph)));
  for (std::size_t i = 0; i < component.size(); ++i)
    if (!s.is_used[i])
      component[i] = none;
  const std::vector<Index> expected = least_of_parts(component);
  const auto check = [&](const pcs::skeleton::Point_parts& parts) {
    BOOST_TEST((least_of_parts(parts.part) == expected));
    std::vector<Index> size(parts.part.size(), 0);
    for (const Index p : parts.part)
      if (p != none)
        ++size[p];
    BOOST_TEST((size == parts.size));
  };
  check(pcs::skeleton::connected_parts<Any_tag>(s.is_used, links));
  std::shuffle(links.begin(), links.end(), std::mt19937(1)); // random order
  check(pcs::skeleton::connected_parts<Any_tag>(s.is_used, links));
}

BOOST_AUTO_TEST_CASE(compact_links_are_those_of_the_list)
{
  const Sheets s(2, 6000, 40);
  Links list = pcs::skeleton::neighbor_links<Any_tag>(s.scan, s.is_used, {});
  pcs::skeleton::Compact_links compact(Any_tag(), s.scan, s.is_used, {});
  BOOST_TEST(compact.size() == list.size());
  const Links others{{0, 7000}, {1, 8000}, {2, 9000}};
  list.insert(list.end(), others.begin(), others.end());
  compact.append(others);
  const std::size_t n = list.size(), middle = n / 2;
  for (const auto& range : {std::make_pair(std::size_t(0), n),
                            std::make_pair(std::size_t(1), middle),
                            std::make_pair(middle, middle + 1),
                            std::make_pair(middle, n - 1),
                            std::make_pair(n - 2, n),
                            std::make_pair(n, n)}) {
    const std::size_t begin = range.first, end = range.second;
    std::size_t k = begin, wrong = 0;
    compact.for_each(begin, end, [&](const Link& l) {
      wrong += k >= end || l.first != list[k].first || l.second != list[k].second;
      ++k;
    });
    BOOST_TEST(wrong == 0u);
    BOOST_TEST(k == end);
  }
  BOOST_TEST((pcs::skeleton::connected_parts<Any_tag>(s.is_used, compact).part ==
              pcs::skeleton::connected_parts<Any_tag>(s.is_used, list).part));
}

BOOST_AUTO_TEST_CASE(links_and_gaps_make_one_graph)
{
  const Sheets s(1, 300, 0);
  const Links all = pcs::skeleton::neighbor_links<Any_tag>(s.scan, s.is_used, {});
  const Neighbor_graph expected = pcs::skeleton::graph_of(s.scan.size(), all);
  for (const std::size_t cut : {std::size_t(0), std::size_t(1), all.size() / 2, all.size()}) {
    const auto at = all.begin() + static_cast<std::ptrdiff_t>(cut);
    const Links first(all.begin(), at), second(at, all.end());
    const Neighbor_graph graph = pcs::skeleton::graph_of(s.scan.size(), first, second);
    BOOST_TEST(graph.number_of_edges() == 2 * all.size());
    BOOST_TEST(are_equal(graph, expected));
  }
  std::vector<std::vector<Index>> rows(s.scan.size());
  for (const Link& l : all) {
    rows[l.first].push_back(l.second);
    rows[l.second].push_back(l.first);
  }
  for (Index v = 0; v < rows.size(); ++v)
    BOOST_TEST(std::equal(rows[v].begin(), rows[v].end(), expected.begin(v), expected.end(v)));
  const Links gaps{all.front(), all.back()};
  pcs::skeleton::Compact_links compact(Any_tag(), s.scan, s.is_used, {});
  compact.append(gaps);
  BOOST_TEST(are_equal(pcs::skeleton::graph_of(s.scan.size(), compact),
                       pcs::skeleton::graph_of(s.scan.size(), all, gaps)));
  BOOST_TEST(pcs::skeleton::graph_of(3, Links()).number_of_edges() == 0u);
}

BOOST_AUTO_TEST_CASE(shortest_paths_are_those_of_boost)
{
  // Sheets are 20 units, about 40 spacings, apart; the cost of such a gap is hundreds of spacings.
  const Sheets s(5, 2000, 20);
  pcs::skeleton::Link_rule rule;
  rule.gap = 60;
  const Links links = pcs::skeleton::neighbor_links<Any_tag>(s.scan, s.is_used, rule);
  const Links gaps = pcs::skeleton::links_across_gaps<Any_tag>(
      s.scan,
      s.is_used,
      rule,
      pcs::skeleton::connected_parts<Any_tag>(s.is_used, links));
  BOOST_TEST(gaps.size() >= 4u);
  const Neighbor_graph graph = pcs::skeleton::graph_of(s.scan.size(), links, gaps);
  check_paths(s.scan, graph, {0});
  check_paths(s.scan, graph, {5, 17, 4000});
  check_paths(s.scan, pcs::skeleton::graph_of(s.scan.size(), links), {0}); // most are out of reach
  check_paths(s.scan,
              pcs::skeleton::graph_of(s.scan.size(), gaps),
              {gaps[0].first, gaps[1].second});
  const pcs::skeleton::Shortest_paths nowhere = shortest_paths(s.scan, graph, {});
  BOOST_TEST(std::all_of(nowhere.distance.begin(), nowhere.distance.end(), [](double d) {
    return std::isinf(d);
  }));
}

BOOST_AUTO_TEST_CASE(gaps_are_closed_by_the_shortest_links)
{
  // Few large components, and many small ones. In the first case, only points with neighbours of
  // other components are searched.
  for (const auto& [number, size] : {std::make_pair(4, 600), std::make_pair(30, 25)}) {
    const Sheets s(number, size, 20);
    for (const double gap : {30.0, 60.0}) {
      pcs::skeleton::Link_rule rule;
      rule.gap = gap;
      const Links links = pcs::skeleton::neighbor_links<Any_tag>(s.scan, s.is_used, rule);
      const auto parts = pcs::skeleton::connected_parts<Any_tag>(s.is_used, links);
      // Minimum spanning tree of the components by Kruskal's algorithm, over all pairs of points.
      std::vector<std::pair<double, Link>> pairs;
      const double widest = gap * s.scan.spacing;
      for (Index i = 0; i < s.scan.size(); ++i)
        for (Index j = i + 1; j < s.scan.size(); ++j)
          if (s.is_used[i] && s.is_used[j] && parts.part[i] != parts.part[j])
            if (const double d = (s.scan.points[i] - s.scan.points[j]).norm(); d < widest)
              pairs.push_back({d, {i, j}});
      std::sort(pairs.begin(), pairs.end());
      pcs::skeleton::Point_sets sets(s.scan.size());
      double expected = 0, found = 0;
      std::size_t number_expected = 0;
      for (const auto& [d, link] : pairs)
        if (const Index a = parts.part[link.first], b = parts.part[link.second];
            sets.find(a) != sets.find(b)) {
          sets.unite(a, b);
          expected += d;
          ++number_expected;
        }
      const Links gaps = pcs::skeleton::links_across_gaps<Any_tag>(s.scan, s.is_used, rule, parts);
      for (const Link& l : gaps)
        found += (s.scan.points[l.first] - s.scan.points[l.second]).norm();
      BOOST_TEST_CONTEXT(number << " parts, gap " << gap)
      {
        BOOST_TEST(gaps.size() == number_expected);
        BOOST_TEST(std::abs(found - expected) <= 1e-9 * (1 + expected));
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(copies_of_a_point_are_one_place)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0, 1);
  std::uniform_int_distribution<int> copies(1, 3);
  std::vector<Vec3> points;
  for (int i = 0; i < 8000; ++i) {
    Vec3 p = pcs_test::drawn<Vec3>([&] { return share(random); });
    p.z() *= 3;
    for (int k = i == 4000 ? 20000 : copies(random); k > 0;
         --k)                                      // one of them more than blocks are long
      points.push_back(p + Vec3(1e-12 * k, 0, 0)); // far below the cell size
  }
  std::shuffle(points.begin(), points.end(), random);
  const auto frame = pcs::skeleton::find_scan_frame<Any_tag>(points, Vec3::UnitZ());
  const auto found = pcs::skeleton::internal::distinct_places<Any_tag>(points, frame);
  BOOST_TEST(found.places.size() > 7990u);
  BOOST_TEST(found.places.size() <= 8100u); // some lie at the border of two cells
  BOOST_REQUIRE(found.chosen.size() == found.places.size());
  std::vector<Index> least(found.places.size(), none);
  std::size_t wrong = 0;
  for (Index i = 0; i < points.size(); ++i) {
    const Index place = found.of_point[i];
    wrong += frame.to_grid(points[i]) != found.places[place];
    if (least[place] == none ||
        pcs::neighborhood::lexicographically_less(points[i], points[least[place]]))
      least[place] = i;
  }
  BOOST_TEST(wrong == 0u);
  for (std::size_t k = 0; k < least.size(); ++k)
    wrong += points[found.chosen[k]] != points[least[k]];
  BOOST_TEST(wrong == 0u);
  const auto others = pcs::skeleton::internal::distinct_places<CGAL::Sequential_tag>(points, frame);
  BOOST_TEST((others.of_point == found.of_point));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_neighbor_graph
