// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A minimal tree graph: code that compiles with it compiles with every model of the concepts of
// Boost.Graph.

#ifndef PCS_TEST_SUPPORT_GRAPH_ARCHETYPES_H
#define PCS_TEST_SUPPORT_GRAPH_ARCHETYPES_H

#include <boost/graph/graph_traits.hpp>
#include <boost/property_map/property_map.hpp>

#include <cstddef>
#include <utility>
#include <vector>

namespace pcs_test {

/// A model of `VertexListGraph` and `IncidenceGraph` only; descriptors are not integers.
class Tree_archetype
{
public:
  class Vertex
  {
  public:
    Vertex() = default;
    bool operator==(const Vertex& other) const { return m_index == other.m_index; }
    bool operator!=(const Vertex& other) const { return m_index != other.m_index; }
    std::size_t index() const { return m_index; } // for the maps below

  private:
    friend class Tree_archetype;
    explicit Vertex(std::size_t i) : m_index(i) {}
    std::size_t m_index = 0;
  };
  struct Edge
  {
    Vertex from, to;
    bool operator==(const Edge& other) const { return from == other.from && to == other.to; }
    bool operator!=(const Edge& other) const { return !(*this == other); }
  };
  struct Category : boost::vertex_list_graph_tag, boost::incidence_graph_tag
  {
  };
  using vertex_descriptor = Vertex;
  using edge_descriptor = Edge;
  using directed_category = boost::directed_tag;
  using edge_parallel_category = boost::disallow_parallel_edge_tag;
  using traversal_category = Category;
  using vertices_size_type = std::size_t;
  using degree_size_type = std::size_t;
  using vertex_iterator = std::vector<Vertex>::const_iterator;
  using out_edge_iterator = std::vector<Edge>::const_iterator;
  static Vertex null_vertex() { return Vertex(static_cast<std::size_t>(-1)); }

  /// Edges from parents to children.
  Tree_archetype(std::size_t n, const std::vector<std::pair<std::size_t, std::size_t>>& edges)
    : m_out(n)
  {
    for (std::size_t i = 0; i < n; ++i)
      m_vertices.push_back(Vertex(i));
    for (const auto& [u, v] : edges)
      m_out[u].push_back({Vertex(u), Vertex(v)});
  }

  friend std::size_t num_vertices(const Tree_archetype& g) { return g.m_vertices.size(); }
  friend std::pair<vertex_iterator, vertex_iterator> vertices(const Tree_archetype& g)
  {
    return {g.m_vertices.begin(), g.m_vertices.end()};
  }
  friend std::pair<out_edge_iterator, out_edge_iterator> out_edges(Vertex v,
                                                                   const Tree_archetype& g)
  {
    return {g.m_out[v.index()].begin(), g.m_out[v.index()].end()};
  }
  friend std::size_t out_degree(Vertex v, const Tree_archetype& g)
  {
    return g.m_out[v.index()].size();
  }
  friend Vertex source(const Edge& e, const Tree_archetype&) { return e.from; }
  friend Vertex target(const Edge& e, const Tree_archetype&) { return e.to; }

private:
  std::vector<Vertex> m_vertices;
  std::vector<std::vector<Edge>> m_out;
};

/// Reads a value of a vertex only.
template <class Value>
class Vertex_map_archetype
{
public:
  using key_type = Tree_archetype::Vertex;
  using value_type = Value;
  using reference = Value;
  using category = boost::readable_property_map_tag;

  explicit Vertex_map_archetype(const std::vector<Value>& values) : m_values(values) {}
  friend Value get(const Vertex_map_archetype& map, const Tree_archetype::Vertex& v)
  {
    return map.m_values[v.index()];
  }

private:
  const std::vector<Value>& m_values;
};

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_GRAPH_ARCHETYPES_H
