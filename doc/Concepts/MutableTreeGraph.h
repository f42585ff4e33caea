/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A graph of Boost.Graph to which a skeleton is written: vertices and edges are added.

  \par Used by
  `pcs::extract_tree_skeleton()` and `pcs::Tree_skeletonization::extract()`, for the result

  \par Refines
  `boost::MutableGraph`, as far as the expressions below

  \par Required types
  `boost::graph_traits<Graph>::vertex_descriptor`

  \par Required expressions
  \code
  auto v = add_vertex(graph), w = add_vertex(graph);
  add_edge(v, w, graph);      // from parent to child
  \endcode

  \par Required
  for a graph other than `pcs::Tree_skeleton`, writable property maps from vertices to points
  (`node_point_map`) and to radii of a floating point type (`node_radius_map`)

  \par Checked by
  a `static_assert` of `pcs::extract_tree_skeleton()`

  \par Models
  `pcs::Tree_skeleton<Kernel>`; any directed `boost::adjacency_list` with these maps
*/
class MutableTreeGraph
{};
