/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A function that is called for every point of a tree and each of its source points, in a space of
  more than two trees. Point `k` of the scan of tree `h` is a source of point `i`. The weights `w`
  in (0, 1] of the sources of a point add up to 1.

  \par Used by
  `pcs::Orl_shape_space::for_each_source()`

  \par Required expressions
  \code
  f(i, h, k, w);      // on a const object; i, h, k: std::size_t, w: double; the result is ignored
  \endcode

  \par Required
  calls for different `i` may run concurrently; calls for the same `i` never do

  \par Checked by
  a `static_assert` of `pcs::Orl_shape_space::for_each_source()`:
  `std::is_invocable_v<const F&, std::size_t, std::size_t, std::size_t, double>`

  \par Models
  a lambda `[&](std::size_t i, std::size_t h, std::size_t k, double w) {}` that is not `mutable`
*/
class SourceFunction
{};
