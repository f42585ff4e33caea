/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map to which a vector is written for every element of a range: `normal_map` of
  `pcs::extract_tree_skeleton()` and of `pcs::Orl_shape_space::points()`.

  \par Refines
  `boost::WritablePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, a type `Vector` with three coordinates, and `key_type`,
  which an element of the \link PointRange \endlink converts to

  \par Required expressions
  \code
  Vector v(FT(), FT(), FT());
  put(map, element, v);                    // on a const map; points() may call it concurrently for
                                           // different elements
  v.x(); v.y(); v.z();                     // v.x() gives the type FT
  \endcode

  \par Checked by
  `pcs::is_point_or_vector_v` for the value and `pcs::is_map_for_v` for the map; in `points()`, the
  same by `pcs::is_writable_point_map_v`

  \par Archetype
  `Map_archetype<Triple_archetype<FT>>` in `test/support/archetypes.h`

  \par Models
  `CGAL::Second_of_pair_property_map`; the `normal_map()` of `CGAL::Point_set_3`
*/
class WritableVectorMap
{};
