// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Graphs of a caller that receive a tree: what they must offer, and how they are emptied.

#ifndef PCS_CORE_PARAMETERS_RESULT_GRAPH_H
#define PCS_CORE_PARAMETERS_RESULT_GRAPH_H

#include <pcs/core/Tree_skeleton.h>

#include <boost/graph/graph_traits.hpp>

#include <type_traits>
#include <utility>

namespace pcs {
namespace internal {

template <class Graph, class = void>
struct Is_mutable_graph : std::false_type
{
};
template <class Graph>
struct Is_mutable_graph<
    Graph,
    std::void_t<decltype(add_vertex(std::declval<Graph&>())),
                decltype(add_edge(
                    std::declval<typename boost::graph_traits<Graph>::vertex_descriptor>(),
                    std::declval<typename boost::graph_traits<Graph>::vertex_descriptor>(),
                    std::declval<Graph&>()))>> : std::true_type
{
};

template <class Kernel>
std::true_type test_tree_skeleton(const Tree_skeleton<Kernel>*);
std::false_type test_tree_skeleton(const void*);

/// Whether `Graph` is a `Tree_skeleton`, or a class derived from one.
template <class Graph>
constexpr bool is_tree_skeleton_v =
    decltype(test_tree_skeleton(static_cast<const Graph*>(nullptr)))::value;

template <class Graph, class = void>
struct Has_clear : std::false_type
{
};
template <class Graph>
struct Has_clear<Graph, std::void_t<decltype(std::declval<Graph&>().clear())>> : std::true_type
{
};

/// Removes all vertices. For graphs without `clear()`, removes them one after the other; with
/// vertices in a vector, each removal is O(size).
template <class Graph>
void clear_graph(Graph& graph)
{
  if constexpr (Has_clear<Graph>::value)
    graph.clear();
  else
    while (num_vertices(graph) > 0) {
      const auto v = *vertices(graph).first;
      clear_vertex(v, graph);
      remove_vertex(v, graph);
    }
}

/// Calls `write()`, which writes to a graph. The graph is empty if this throws, for example because
/// memory runs out.
template <class Graph, class Write>
void write_or_clear(Graph& graph, const Write& write)
{
  try {
    write();
  } catch (...) {
    clear_graph(graph);
    throw;
  }
}

} // namespace internal
} // namespace pcs

#endif // PCS_CORE_PARAMETERS_RESULT_GRAPH_H
