/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map to which a truth value is written for every element of a range, for example
  `point_is_leaf_map` or `point_is_dense_map`.

  \par Refines
  `boost::WritablePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, which `bool` converts to, and `key_type`, which an
  element of the \link PointRange \endlink converts to

  \par Required expressions
  \code
  put(map, element, true);
  \endcode

  \par Checked by
  `pcs::is_map_for_v<Map, Element, bool>`

  \par Models
  `boost::iterator_property_map` over `std::vector<bool>`; `CGAL::Point_set_3::Property_map<bool>`
*/
class WritableFlagMap
{};
