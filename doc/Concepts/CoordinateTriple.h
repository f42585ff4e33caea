/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A point or vector that is only read, for example `up_direction` or `root_position`. It needs no
  constructor.

  \par Required expressions
  \code
  triple.x(); triple.y(); triple.z();      // on a const object; CGAL::to_double() takes them
  \endcode

  \par Checked by
  `pcs::is_coordinate_triple_v`

  \par Models
  `Kernel::Point_3`, `Kernel::Vector_3`, `Eigen::Vector3d`
*/
class CoordinateTriple
{};
