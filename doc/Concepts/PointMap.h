/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map from the elements of a range to positions. The deformation reads and writes
  through it; the skeleton and the shape space only read.

  \par Refines
  `boost::ReadablePropertyMap`; where positions are written, `boost::ReadWritePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, a type `Point` with three coordinates, and `key_type`,
  which an element of the \link PointRange \endlink converts to

  \par Required expressions
  \code
  Point p = get(map, element);
  put(map, element, p);                    // read-write maps only
  p.x(); p.y(); p.z();                     // of one number type FT, no integer type
  Point q(FT(), FT(), FT());
  \endcode

  \par Checked by
  `pcs::is_point_or_vector_v` for the value, `pcs::is_readable_map_v` or `pcs::is_read_write_map_v`
  for the map

  \par Archetype
  `Map_archetype<Triple_archetype<FT>>` in `test/support/archetypes.h`

  \par Models
  `CGAL::Identity_property_map<Kernel::Point_3>`; `CGAL::First_of_pair_property_map`; the
  `point_map()` of `CGAL::Point_set_3`
*/
class PointMap
{};
