/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A range of points that are only read, for example `scanner_positions`. One pass over it is enough.

  \par Required types
  an iterator whose value type is a model of \link CoordinateTriple \endlink

  \par Required expressions
  \code
  for (const auto& point : range)    // begin(range), end(range) on a const object
    point.x();
  \endcode

  \par Checked by
  a `static_assert` of `pcs::extract_tree_skeleton()`

  \par Models
  `std::vector<Kernel::Point_3>`, `std::list<Eigen::Vector3d>`
*/
class CoordinateTripleRange
{};
