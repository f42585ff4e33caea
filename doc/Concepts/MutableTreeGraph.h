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
  add_edge(v, w, graph);                   // from parent to child

  // for a graph other than pcs::Tree_skeleton:
  graph.clear();                           // or, without clear(), the four expressions below
  num_vertices(graph);
  auto first = *vertices(graph).first;
  clear_vertex(v, graph);
  remove_vertex(v, graph);

  Point p(FT(), FT(), FT());               // the value type of node_point_map
  p.x(); p.y(); p.z();                     // p.x() gives the type FT
  put(node_point_map, v, p);
  put(node_radius_map, v, Radius(0.5));    // the value type, a floating point type
  put(node_radius_error_map, v, Error(0)); // optional; likewise
  put(node_branch_map, v, Branch(0));      // optional; an integer type
  \endcode

  \par Required
  for a graph other than `pcs::Tree_skeleton`, the property maps `node_point_map` and
  `node_radius_map`, which must accept new vertices as keys; so must the optional maps
  `node_radius_error_map` (floating point) and `node_branch_map` (integers)

  \par Checked by
  `static_assert`s of `pcs::extract_tree_skeleton()`: `add_vertex()` and `add_edge()` of the graph,
  both maps given, `pcs::is_point_or_vector_v` for the value of `node_point_map`,
  `std::is_floating_point_v` for that of `node_radius_map`, and `pcs::is_map_for_v` for both

  \par Models
  `pcs::Tree_skeleton<Kernel>`; any directed `boost::adjacency_list` with these maps
*/
class MutableTreeGraph
{};
