// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks the message of an error.

#ifndef PCS_TEST_SUPPORT_EXCEPTIONS_H
#define PCS_TEST_SUPPORT_EXCEPTIONS_H

#include <boost/test/unit_test.hpp>

#include <exception>
#include <string>

namespace pcs_test {

/// A predicate for BOOST_CHECK_EXCEPTION: the message contains each of the given words.
template <class... Words>
auto message_has(Words... words)
{
  return [=](const std::exception& error) {
    const std::string message = error.what();
    bool has_all = true;
    for (const std::string& word : {std::string(words)...})
      if (message.find(word) == std::string::npos) {
        BOOST_TEST_MESSAGE("\"" << message << "\" lacks \"" << word << '"');
        has_all = false;
      }
    return has_all;
  };
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_EXCEPTIONS_H
