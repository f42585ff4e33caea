// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a tree skeleton to an SWC file.

#ifndef PCS_IO_WRITE_SWC_H
#define PCS_IO_WRITE_SWC_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/Tree_rows.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Tree_skeleton.h>

#include <boost/property_map/property_map.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

template <class Graph, class PointMap, class RadiusMap, class Type>
void write_swc(const std::string& path,
               const Graph& graph,
               std::size_t root,
               const PointMap& point_map,
               const RadiusMap& radius_map,
               const Type& type)
{
  const std::vector<std::size_t> order = writing_order(graph, root, "write_swc");
  std::vector<std::size_t> id(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    id[order[i]] = i + 1;
  std::vector<std::size_t> parent(order.size(), 0); // 0 is not the id of a node
  for (const std::size_t v : order)
    for (const auto e : boost::make_iterator_range(out_edges(v, graph)))
      parent[target(e, graph)] = id[v];

  Output_file file(path);
  file.write("# id type x y z radius parent\n");
  std::string line;
  for (const std::size_t v : order) {
    line.clear();
    append_number(line, id[v]);
    line += ' ';
    append_number(line, type(v));
    const auto& point = get(point_map, v);
    for (const double value : {finite_value(point.x(), "x", v, "write_swc"),
                               finite_value(point.y(), "y", v, "write_swc"),
                               finite_value(point.z(), "z", v, "write_swc"),
                               finite_value(get(radius_map, v), "the radius", v, "write_swc")}) {
      line += ' ';
      append_number(line, value);
    }
    if (CGAL::to_double(get(radius_map, v)) < 0)
      throw Invalid_input("pcs::IO::write_swc(): the radius of node " + std::to_string(v) +
                          " is negative");
    line += ' ';
    if (parent[v] == 0)
      line += "-1";
    else
      append_number(line, parent[v]);
    line += '\n';
    file.write(line);
  }
  file.commit();
}

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief writes any graph that is a tree to an SWC file.

  Ids begin with 1; parents precede their children. Numbers have as many digits as required to read
  them back unchanged. The type of all nodes is 0. The file is written completely or not at all.

  \tparam Graph a model of `boost::VertexListGraph` and `boost::IncidenceGraph` with edges from
          parent to child, whose vertices are the numbers `0, ..., n - 1`
  \tparam PointMap a readable property map from vertices to points with `x()`, `y()`, `z()`
  \tparam RadiusMap a readable property map from vertices to numbers
  \param path name of the file
  \param graph the tree, with `n` nodes
  \param root the root of the tree
  \param point_map the position of each node [L]
  \param radius_map the radius of each node, `>= 0` [L]
  \throws pcs::IO_error when the file cannot be written
  \throws pcs::Invalid_input when the graph is not a tree with the root `root`, a number is not
          finite, or a radius is negative
  \par Complexity
  Linear in the number of nodes.
*/
template <class Graph, class PointMap, class RadiusMap>
void write_swc(const std::string& path,
               const Graph& graph,
               std::size_t root,
               const PointMap& point_map,
               const RadiusMap& radius_map)
{
  internal::write_swc(path, graph, root, point_map, radius_map, [](std::size_t) { return 0; });
}

/*!
  \ingroup PkgPcsIORef
  \brief writes a tree skeleton to an SWC file.

  Format, errors and cost are those of the first overload, except for the types: the type of a node
  is 5 plus the order of its branch, or 0 without a branch. Types from 5 on are user-defined in SWC.

  \param path name of the file
  \param tree a tree with positions and radii [L]
*/
template <class Kernel>
void write_swc(const std::string& path, const Tree_skeleton<Kernel>& tree)
{
  const Tree_bundle& bundle = tree[boost::graph_bundle];
  internal::write_swc(path,
                      tree,
                      bundle.root,
                      get(&Tree_node<Kernel>::point, tree),
                      get(&Tree_node<Kernel>::radius, tree),
                      [&](std::size_t v) {
                        const std::size_t b = tree[v].branch;
                        return b < bundle.branches.size() ? 5 + bundle.branches[b].order : 0;
                      });
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_WRITE_SWC_H
