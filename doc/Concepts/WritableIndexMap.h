/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map to which the index of a branch (`point_branch_map`) or of a tree (`point_tree_map`
  of `pcs::segment_trees()`) is written for every element of a range. The index of points without a
  branch or tree is `pcs::npos`, converted to the value type.

  \par Refines
  `boost::WritablePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, an integer type other than `bool`, and `key_type`,
  which an element of the \link PointRange \endlink converts to

  \par Required expressions
  \code
  put(map, element, static_cast<Value>(index));
  \endcode

  \par Checked by
  `pcs::is_map_for_v<Map, Element, std::size_t>`, and for `point_branch_map` an integer value type

  \par Archetype
  `Map_archetype<std::size_t>` in `test/support/archetypes.h`

  \par Models
  `boost::associative_property_map<std::map<Kernel::Point_3, std::size_t>>`;
  `CGAL::Point_set_3::Property_map<int>`
*/
class WritableIndexMap
{};
