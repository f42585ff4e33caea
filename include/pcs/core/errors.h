// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Exceptions of pcs: an invalid value, and a file that cannot be read or written.

#ifndef PCS_CORE_ERRORS_H
#define PCS_CORE_ERRORS_H

#include <stdexcept>
#include <string>

namespace pcs {

/*!
  \ingroup PkgPcsCoreRef
  \brief An argument breaks the contract of the function it was given to.

  The message names the function, the argument, the offending value or index, and the rule.
  Nothing was changed when it is thrown. It is thrown in release builds as well.
*/
class Invalid_input : public std::invalid_argument
{
public:
  using std::invalid_argument::invalid_argument;
};

/*!
  \ingroup PkgPcsIORef
  \brief A file is missing, malformed, or cannot be written.

  The message names the file, the line or byte, and what was expected there.
*/
class IO_error : public std::runtime_error
{
public:
  IO_error(const std::string& file_name, const std::string& what)
    : std::runtime_error(file_name + ": " + what), m_file_name(file_name)
  {
  }

  //! the name of the file as the caller gave it
  const std::string& file_name() const noexcept { return m_file_name; }

private:
  std::string m_file_name;
};

} // namespace pcs

#endif // PCS_CORE_ERRORS_H
