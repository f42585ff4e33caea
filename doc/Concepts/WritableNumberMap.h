/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map to which a length is written for every element of a range, for example
  `point_residual_map`.

  \par Refines
  `boost::WritablePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, a number type that `double` converts to and that is no
  integer type, and `key_type`, which an element of the \link PointRange \endlink converts to

  \par Required expressions
  \code
  put(map, element, Value(0.5));
  \endcode

  \par Checked by
  `pcs::is_map_for_v<Map, Element, double>`, and a value type that is no integer

  \par Archetype
  `Map_archetype<double>` in `test/support/archetypes.h`

  \par Models
  `boost::iterator_property_map` over `std::vector<float>`;
  `CGAL::Point_set_3::Property_map<double>`
*/
class WritableNumberMap
{};
