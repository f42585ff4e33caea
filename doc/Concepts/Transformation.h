/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A motion of a handle from rest: a rotation, a uniform scale and a translation. A matrix that
  reflects, shears or scales unequally is rejected at run time by `pcs::Invalid_input`.

  \par Used by
  `pcs::deform_point_set()`, `pcs::Point_set_deformation::set_transformation()` and
  `pcs::to_similarity()`

  \par Required expressions
  one of
  \code
  pcs::Similarity s = transformation;      // implicit conversion; preferred if both are valid
  CGAL::to_double(transformation.m(i, j)); // on a const object, for i in 0 to 2 and j in 0 to 3
  \endcode

  \par Checked by
  `pcs::is_similarity_like_v`: the type converts to `pcs::Similarity`, or `m(0, 3)` is valid on a
  const object

  \par Models
  `pcs::Similarity`, also as returned by `pcs::rotation()`, `pcs::translation()` and
  `pcs::scaling()`; `CGAL::Aff_transformation_3<Kernel>`
*/
class Transformation
{};
