/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A range of elements, each of which has a position.

  \par Refines
  the Boost concept `RandomAccessRange`

  \par Required types
  its value type is the key type of the property map `point_map` that is passed along

  \par Required expressions
  \code
  auto first = std::begin(range);          // a random access iterator
  auto last = std::end(range);
  get(point_map, *first);
  \endcode

  \par Checked by
  `pcs::is_random_access_range_v`

  \par Archetype
  `Range_archetype` in `test/support/archetypes.h`

  \par Models
  `std::vector<Kernel::Point_3>` with `CGAL::Identity_property_map`;
  `CGAL::Point_set_3` with its `point_map()`; an index range with a map into the caller's arrays
*/
class PointRange
{};
