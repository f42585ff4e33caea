/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map from the elements of a range to their normals, which are rotated along with
  the points.

  \par Refines
  `boost::ReadWritePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, a type `Vector` with three coordinates

  \par Required expressions
  \code
  Vector n = get(map, element);
  put(map, element, n);
  n.x(); n.y(); n.z();
  Vector m(FT(), FT(), FT());
  \endcode

  \par Checked by
  `pcs::is_point_or_vector_v` and `pcs::is_read_write_map_v`

  \par Archetype
  `Map_archetype<Triple_archetype<FT>>` in `test/support/archetypes.h`

  \par Models
  `CGAL::Second_of_pair_property_map`; the `normal_map()` of `CGAL::Point_set_3`
*/
class NormalMap
{};
