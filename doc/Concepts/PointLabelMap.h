/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map from the elements of a range to labels that are only read: whether a point is wood
  (`wood_map`), or the station that measured it (`station_map`; negative: unknown).

  \par Refines
  `boost::ReadablePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, which is `bool` for `wood_map` and an integer type for
  `station_map`, and `key_type`, which an element of the \link PointRange \endlink converts to

  \par Required expressions
  \code
  Value label = get(map, element);
  \endcode

  \par Checked by
  `pcs::is_readable_map_v`

  \par Models
  `boost::iterator_property_map` over `std::vector<int>`; `CGAL::Point_set_3::Property_map<bool>`
*/
class PointLabelMap
{};
