/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A function that receives the completed fraction of the work and returns whether to continue. It is
  called on the thread of the caller; the fractions never decrease.

  \par Required expressions
  \code
  bool is_to_continue = callback(0.5);     // argument in [0, 1]
  \endcode

  \par Checked by
  `pcs::is_progress_callback_v`

  \par Models
  `std::function<bool(double)>`; a lambda `[](double fraction) { return true; }`; a
  `std::reference_wrapper` around a function object
*/
class ProgressCallback
{};
