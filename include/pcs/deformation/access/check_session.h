// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks whether a session may be called, with messages that begin with the name of the caller.

#ifndef PCS_DEFORMATION_ACCESS_CHECK_SESSION_H
#define PCS_DEFORMATION_ACCESS_CHECK_SESSION_H

#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>

#include <cstddef>
#include <string>

namespace pcs {
namespace deformation {

// These calls allocate no memory unless they throw `Invalid_input`.

/// Checks that the session, a pointer, is not null.
template <class Pointer>
void check_session(const Pointer& session, const char* caller)
{
  pcs::internal::check(session != nullptr, caller, "this object was moved from");
}

/// Checks that the session was constructed completely.
template <class Pointer>
void check_ready(const Pointer& session, const char* caller)
{
  check_session(session, caller);
  pcs::internal::check(session->is_ready(),
                       caller,
                       "the construction of this object was cancelled");
}

/// Checks that the session is ready and has the handle.
template <class Pointer>
void check_handle(const Pointer& session, std::size_t handle, const char* caller)
{
  check_ready(session, caller);
  if (!session->is_handle(handle))
    throw Invalid_input(std::string(caller) + ": there is no handle " + std::to_string(handle));
}

/// Checks that the session has the point.
template <class Pointer>
void check_point(const Pointer& session, std::size_t i, const char* caller)
{
  if (i >= session->number_of_points())
    throw Invalid_input(std::string(caller) + ": there is no point " + std::to_string(i) +
                        "; points are numbered from 0 to " +
                        std::to_string(session->number_of_points() - 1));
}

/// Checks that there are still as many points as at the construction of the session.
template <class Pointer>
void check_number_of_points(const Pointer& session, std::size_t n, const char* caller)
{
  if (n != session->number_of_points())
    throw Invalid_input(std::string(caller) + ": there are " + std::to_string(n) + " points, " +
                        std::to_string(session->number_of_points()) + " in the beginning");
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ACCESS_CHECK_SESSION_H
