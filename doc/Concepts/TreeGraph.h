/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A rooted tree with a position and a radius at every vertex.

  \par Refines
  `boost::VertexListGraph` and `boost::IncidenceGraph`, directed, with edges from parent to child

  \par Used by
  `pcs::orl_geodesic()`, and `pcs::extract_tree_skeleton()` for `given_skeleton`, which needs
  positions only (`given_point_map`), and no indices

  \par Required
  one vertex without parent, from which all others are reached; readable property maps from vertices
  to points (`node_point_map`), to numbers (`node_radius_map`) and to indices from 0
  (`node_index_map`)

  \par Required expressions
  \code
  num_vertices(graph);
  for (auto [v, end] = vertices(graph); v != end; ++v)
    for (auto [e, last] = out_edges(*v, graph); e != last; ++e)
      target(*e, graph);

  // for a vertex v; CGAL::to_double() accepts the coordinates
  auto p = get(node_point_map, v);         // or given_point_map
  p.x(); p.y(); p.z();
  double r = CGAL::to_double(get(node_radius_map, v));
  auto i = get(node_index_map, v);         // of an integer type
  \endcode

  \par Checked by
  `given_skeleton`: `pcs::is_tree_graph_v`, and for its map `pcs::is_coordinate_triple_v` and
  `pcs::is_readable_map_v`. Trees of the shape space: `static_assert`s check a directed graph with
  `num_vertices()`, `vertices()` and `out_edges()`, and maps whose `get()` gives a position with
  `x()`, a radius that `CGAL::to_double()` converts, and an index of an integer type. The concept
  checks of Boost.Graph follow.

  \par Archetype
  `Tree_archetype` with `Vertex_map_archetype` in `test/support/graph_archetypes.h`

  \par Models
  `pcs::Tree_skeleton<Kernel>`, whose maps are used by default; any
  `boost::adjacency_list` with these maps
*/
class TreeGraph
{};
