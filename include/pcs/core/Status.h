// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Status of a finished algorithm.

#ifndef PCS_CORE_STATUS_H
#define PCS_CORE_STATUS_H

#include <ostream>

namespace pcs {

//! \ingroup PkgPcsCoreRef
//! how an algorithm ended; outputs are never partial
enum class Status {
  converged,        //!< the result meets the tolerance
  iteration_limit,  //!< the result is valid; more iterations might improve it
  nothing_to_do,    //!< no handle, or no point connected to a handle; the output equals the input
  cancelled,        //!< the callback returned `false`; the output is unchanged
  numerical_failure //!< a matrix could not be factorised; the output is unchanged
};

inline const char* to_string(Status status)
{
  switch (status) {
  case Status::converged:
    return "converged";
  case Status::iteration_limit:
    return "iteration_limit";
  case Status::nothing_to_do:
    return "nothing_to_do";
  case Status::cancelled:
    return "cancelled";
  case Status::numerical_failure:
    return "numerical_failure";
  }
  return "unknown";
}

inline std::ostream& operator<<(std::ostream& out, Status status)
{
  return out << to_string(status);
}

} // namespace pcs

#endif // PCS_CORE_STATUS_H
