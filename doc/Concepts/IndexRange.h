/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A range of the indices of points, for example the points of one handle. One pass over it is
  enough.

  \par Required types
  an iterator whose value type is integral

  \par Required expressions
  \code
  for (auto index : range)    // begin(range), end(range) on a const object
    std::size_t i = index;
  \endcode

  \par Checked by
  `pcs::is_index_range_v`

  \par Archetype
  `Index_range_archetype` in `test/support/archetypes.h`

  \par Models
  `std::vector<std::size_t>`, `std::set<int>`, `std::array<std::uint32_t, n>`
*/
class IndexRange
{};
