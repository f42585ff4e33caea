// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Components, hop counts and shortest paths on the neighbour graph of a large cloud, beside the
// algorithms of Boost.Graph on the same arrays.

#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/body/octree_samples.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/spatial_order.h>
#include <support/Table.h>
#include <support/measuring.h>
#include <support/models.h>

#include <CGAL/tags.h>

#include <boost/graph/breadth_first_search.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/connected_components.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <boost/pending/disjoint_sets.hpp>
#include <boost/property_map/property_map.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iostream>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

using pcs::neighborhood::Proximity_graph;
using Vec3 = Eigen::Vector3d;

namespace {

struct Edge_length
{
  double length;
};
using Boost_graph =
    boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, Edge_length>;

struct Cloud
{
  std::vector<Vec3> points; ///< in spatial order, as in a session
  Proximity_graph graph;
  std::vector<std::uint32_t> samples;
  Boost_graph boost_graph; ///< with lengths of edges
};

Cloud make_cloud(std::vector<Vec3> given, std::size_t number_of_samples)
{
  Cloud c;
  for (const auto i : pcs::neighborhood::spatial_order<CGAL::Sequential_tag>(given))
    c.points.push_back(given[i]);
  c.graph = pcs::neighborhood::nearest_neighbor_graph<CGAL::Sequential_tag>(c.points, 6);
  c.samples = pcs::deformation::octree_samples<CGAL::Sequential_tag>(c.points, number_of_samples);
  std::vector<std::pair<std::size_t, std::size_t>> edges;
  std::vector<Edge_length> lengths;
  for (std::size_t i = 0; i < c.points.size(); ++i)
    for (auto j = c.graph.begin(i); j != c.graph.end(i); ++j) {
      edges.emplace_back(i, *j);
      lengths.push_back({(c.points[i] - c.points[*j]).norm()});
    }
  c.boost_graph = Boost_graph(boost::edges_are_sorted,
                              edges.begin(),
                              edges.end(),
                              lengths.begin(),
                              c.points.size());
  return c;
}

std::size_t count_with_boost(const Cloud& c, std::vector<std::uint32_t>& component)
{
  component.resize(c.points.size());
  return boost::connected_components(
      c.boost_graph,
      boost::make_iterator_property_map(component.begin(),
                                        get(boost::vertex_index, c.boost_graph)));
}

std::size_t count_with_disjoint_sets(const Cloud& c, std::vector<std::uint32_t>& component)
{
  std::vector<std::uint8_t> rank(c.points.size(), 0);
  std::vector<std::size_t> parent(c.points.size());
  std::iota(parent.begin(), parent.end(), std::size_t(0)); // each vertex is a set
  const auto index = get(boost::vertex_index, c.boost_graph);
  const auto ranks = boost::make_iterator_property_map(rank.begin(), index);
  const auto parents = boost::make_iterator_property_map(parent.begin(), index);
  boost::disjoint_sets<decltype(ranks), decltype(parents)> sets(ranks, parents);
  for (std::size_t i = 0; i < c.points.size(); ++i)
    for (auto j = c.graph.begin(i); j != c.graph.end(i); ++j)
      if (*j > i)
        sets.union_set(i, std::size_t(*j));
  component.resize(c.points.size());
  std::vector<std::uint32_t> number(c.points.size(), 0);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    const std::size_t root = sets.find_set(i);
    if (number[root] == 0)
      number[root] = ++count;
    component[i] = number[root] - 1;
  }
  return count;
}

/// Nearest sample along the graph of each point, by the algorithm of Dijkstra from a vertex that is
/// joined to all samples: boost::dijkstra_shortest_paths_no_init with several sources.
std::vector<std::size_t> regions_with_boost(const Cloud& c)
{
  const std::size_t n = c.points.size();
  std::vector<double> distance(n, std::numeric_limits<double>::max());
  std::vector<std::size_t> predecessor(n), region(n, n);
  for (std::size_t i = 0; i < n; ++i)
    predecessor[i] = i;
  const auto index = get(boost::vertex_index, c.boost_graph);
  for (const auto s : c.samples)
    distance[s] = 0;
  struct Visitor : boost::dijkstra_visitor<>
  {
    std::vector<std::size_t>*region, *predecessor;
    void examine_vertex(std::size_t v, const Boost_graph&)
    {
      (*region)[v] = (*predecessor)[v] == v ? v : (*region)[(*predecessor)[v]];
    }
  } visitor;
  visitor.region = &region;
  visitor.predecessor = &predecessor;
  const auto distances = boost::make_iterator_property_map(distance.begin(), index);
  boost::two_bit_color_map<decltype(index)> color(n, index);
  boost::dijkstra_shortest_paths_no_init(
      c.boost_graph,
      c.samples.begin(),
      c.samples.end(),
      boost::make_iterator_property_map(predecessor.begin(), index),
      distances,
      get(&Edge_length::length, c.boost_graph),
      index,
      std::less<>(),
      boost::closed_plus<double>(),
      0.0,
      visitor,
      color);
  return region;
}

/// Hops from a point, level by level.
std::vector<std::uint32_t> hops(const Cloud& c, std::uint32_t from)
{
  constexpr std::uint32_t unreached = ~std::uint32_t(0);
  std::vector<std::uint32_t> level(c.points.size(), unreached), front = {from}, next;
  level[from] = 0;
  for (std::uint32_t depth = 1; !front.empty(); ++depth) {
    next.clear();
    for (const auto i : front)
      for (auto j = c.graph.begin(i); j != c.graph.end(i); ++j)
        if (level[*j] == unreached) {
          level[*j] = depth;
          next.push_back(*j);
        }
    front.swap(next);
  }
  return level;
}

std::vector<std::uint32_t> hops_with_boost(const Cloud& c, std::uint32_t from)
{
  std::vector<std::uint32_t> level(c.points.size(), ~std::uint32_t(0));
  level[from] = 0;
  const auto levels =
      boost::make_iterator_property_map(level.begin(), get(boost::vertex_index, c.boost_graph));
  boost::breadth_first_search(c.boost_graph,
                              from,
                              boost::visitor(boost::make_bfs_visitor(
                                  boost::record_distances(levels, boost::on_tree_edge()))));
  return level;
}

} // namespace

int main(int argc, char** argv)
{
  std::size_t side = 1000, number_of_samples = 2000, repetitions = 5;
  CLI::App app("Graph algorithms of pcs and of Boost.Graph.", "bench_graphs");
  app.add_option("--side", side, "the cloud is a wavy square with this number squared of points")
      ->check(CLI::Range(std::size_t(100), std::size_t(10000)))
      ->capture_default_str();
  app.add_option("--samples", number_of_samples)->capture_default_str();
  app.add_option("--repetitions", repetitions, "the least time counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const Cloud c = make_cloud(pcs_bench::make_plain(side), number_of_samples);
  pcs_bench::Table table({"task", "implementation", "seconds", "result"});
  const auto add = [&](const std::string& task, const std::string& name, const auto& run) {
    double least = std::numeric_limits<double>::max();
    std::size_t result = 0;
    for (std::size_t k = 0; k < repetitions; ++k) {
      const pcs_bench::Timer timer;
      result = run();
      least = std::min(least, timer.seconds());
    }
    table.add({task, name, pcs_bench::number(least), std::to_string(result)});
  };
  std::vector<std::uint32_t> component;
  const auto count = [&](auto tag) {
    std::size_t number = 0;
    component = pcs::neighborhood::connected_components<decltype(tag)>(c.graph, number);
    return number;
  };
  add("components", "pcs, one thread", [&] { return count(CGAL::Sequential_tag()); });
  add("components", "pcs", [&] { return count(CGAL::Parallel_if_available_tag()); });
  add("components", "boost::connected_components", [&] { return count_with_boost(c, component); });
  add("components", "boost::disjoint_sets", [&] { return count_with_disjoint_sets(c, component); });
  const auto grow = [&](auto tag) {
    const auto regions =
        pcs::deformation::grow_regions<decltype(tag)>(c.points, c.graph, c.samples);
    return std::size_t(regions.sample_of_point[c.points.size() / 2]);
  };
  const auto sample_at = [&](std::size_t point) {
    const auto i = std::find(c.samples.begin(), c.samples.end(), point);
    return std::size_t(i - c.samples.begin());
  };
  add("nearest samples by paths", "pcs, one thread", [&] { return grow(CGAL::Sequential_tag()); });
  add("nearest samples by paths", "pcs", [&] { return grow(CGAL::Parallel_if_available_tag()); });
  add("nearest samples by paths", "boost::dijkstra_shortest_paths", [&] {
    return sample_at(regions_with_boost(c)[c.points.size() / 2]);
  });
  const std::uint32_t from = c.samples.front();
  add("hops from a point", "levels of vertices", [&] {
    return std::size_t(hops(c, from)[c.points.size() / 2]);
  });
  add("hops from a point", "boost::breadth_first_search", [&] {
    return std::size_t(hops_with_boost(c, from)[c.points.size() / 2]);
  });
  table.print(std::cout);
}
