/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A function that is called for every point of a tree, in a space of two trees. Point `i` is
  interpolated between point `a` of the first scan and point `b` of the second one. An index is
  `pcs::npos` if there is no such point. `w` in [0, 1] is the weight of the second point.

  \par Used by
  `pcs::Orl_shape_space::for_each_point()`

  \par Required expressions
  \code
  f(i, a, b, w);      // on a const object; i, a, b: std::size_t, w: double; the result is ignored
  \endcode

  \par Required
  calls for different points may run concurrently

  \par Checked by
  a `static_assert` of `pcs::Orl_shape_space::for_each_point()`:
  `std::is_invocable_v<const F&, std::size_t, std::size_t, std::size_t, double>`

  \par Models
  a lambda `[&](std::size_t i, std::size_t a, std::size_t b, double w) {}` that is not `mutable`
*/
class PointFunction
{};
