// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Exceptions of pcs: an invalid value, and a file that cannot be read or written.

#ifndef PCS_CORE_ERRORS_H
#define PCS_CORE_ERRORS_H

#include <stdexcept>
#include <string>

// With -ffast-math, compilers remove std::isnan() and std::isfinite(), hence the checks of values.
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "pcs checks for NaN and infinity, which -ffast-math removes: add -fno-finite-math-only"
#endif

namespace pcs {

/*!
  \ingroup PkgPcsCoreRef
  \brief An argument violates a precondition of the called function.

  The message names the function, the argument, the offending value or index, and the rule. A
  function that throws it has no other effect. Release builds throw it as well.
*/
class Invalid_input : public std::invalid_argument
{
public:
  using std::invalid_argument::invalid_argument;
};

/*!
  \ingroup PkgPcsIORef
  \brief A file is missing, malformed, or cannot be written.

  The message names the file, the line or byte, and the expected content.
*/
class IO_error : public std::runtime_error
{
public:
  IO_error(const std::string& file_name, const std::string& what)
    : std::runtime_error(file_name + ": " + what), m_file_name(file_name)
  {
  }

  //! the name of the file as passed by the caller
  const std::string& file_name() const noexcept { return m_file_name; }

private:
  std::string m_file_name;
};

} // namespace pcs

#endif // PCS_CORE_ERRORS_H
