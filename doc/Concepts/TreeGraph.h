/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A rooted tree with a position and a radius at every vertex.

  \par Refines
  `boost::VertexListGraph` and `boost::IncidenceGraph`, directed, with edges from parent to child

  \par Used by
  `pcs::orl_geodesic()`, and `pcs::extract_tree_skeleton()` for `given_skeleton`, which needs positions only
  (`given_point_map`), and no indices

  \par Required
  one vertex without parent, from which all others are reached; readable property maps from vertices to points
  (`node_point_map`), to numbers (`node_radius_map`) and to indices from 0 (`node_index_map`)

  \par Models
  `pcs::Tree_skeleton<Kernel>`, whose maps are found without being named; any `boost::adjacency_list` with such maps
*/
class TreeGraph
{};
