/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A range of handles: the points of each handle, and their motion. The range must not be empty. Its
  beginning is read twice, so the range must permit several passes.

  \par Used by
  `pcs::deform_point_set()`, for `handles`

  \par Required types
  an iterator whose reference type converts to `const pcs::Deformation_handle&`

  \par Required expressions
  \code
  std::begin(range) == std::end(range);    // on a const object
  for (const pcs::Deformation_handle& handle : range)
    handle.indices;
  \endcode

  \par Checked by
  a `static_assert` of `pcs::deform_point_set()`: on a const object, `std::begin()` and `std::end()`
  are valid, and elements convert to `const pcs::Deformation_handle&`

  \par Models
  `std::vector<pcs::Deformation_handle>`, `std::array<pcs::Deformation_handle, n>`
*/
class HandleRange
{};
