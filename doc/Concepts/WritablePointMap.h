/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map to which a position is written for every element of a range: `point_map` of
  `pcs::Orl_shape_space::points()`.

  \par Refines
  `boost::WritablePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, a type `Point` with three coordinates, and `key_type`,
  which an element of the \link PointRange \endlink converts to

  \par Required expressions
  \code
  Point p(FT(), FT(), FT());
  put(map, element, p);                    // on a const map; calls for different elements may run
                                           // concurrently
  p.x(); p.y(); p.z();                     // p.x() gives the type FT
  \endcode

  \par Checked by
  `pcs::is_writable_point_map_v`: `pcs::is_point_or_vector_v` for the value, and `put()` with a
  value of this type

  \par Archetype
  `Map_archetype<Triple_archetype<FT>>` in `test/support/archetypes.h`

  \par Models
  `CGAL::Identity_property_map<Kernel::Point_3>`; `CGAL::First_of_pair_property_map`; the
  `point_map()` of `CGAL::Point_set_3`
*/
class WritablePointMap
{};
