// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The main function of all programs: parses the command line, prints errors in one sentence,
// returns an exit code.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_RUN_PROGRAM_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_RUN_PROGRAM_H

#include <pcs/core/errors.h>
#include <pcs/core/keep_memory.h>

#include <CLI/CLI.hpp>

#include <cmath>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <type_traits>

namespace program {

/// Rejects values that no option accepts: empty ones, for example of an undefined variable of a
/// script, and NaN, which the comparisons of `CLI::Range` accept.
inline void check_values(const CLI::App& app)
{
  for (const CLI::Option* const option : app.get_options())
    for (const std::string& value : option->results()) {
      if (value.empty())
        throw pcs::Invalid_input(option->get_name() + " has an empty value");
      double number = 0;
      if (option->get_type_name().rfind("FLOAT", 0) == 0 &&
          CLI::detail::lexical_cast(value, number) && std::isnan(number))
        throw pcs::Invalid_input(option->get_name() + " must be a number, found " + value);
    }
}

/// Parses the options, then calls `work()`, which returns whether it succeeded, or an exit code.
/// Without arguments, prints what the program does, and a call with the arguments `example`.
/// Returns 0: success, 1: invalid input, 2: internal error, or the code of `work()`.
template <class Work>
int run_program(CLI::App& app, int argc, char** argv, const std::string& example, const Work& work)
{
  constexpr int bad_input = 1, internal_error = 2;
  const auto fail = [&app](int exit_code, const std::string& what) {
    std::cerr << app.get_name() << ": " << what << '\n';
    return exit_code;
  };
  if (argc <= 1) {
    const std::string name = app.get_name();
    std::cerr << app.get_description() << "\nExample: " << name << ' ' << example
              << "\nAll options: " << name << " --help\n";
    return bad_input;
  }
#ifdef SIGXFSZ
  std::signal(SIGXFSZ, SIG_IGN); // exceeding a limit of the file size is an error like a full disk
#endif
  pcs::keep_memory();
  try {
    app.parse(argc, argv);
    check_values(app);
    if constexpr (std::is_same_v<decltype(work()), bool>)
      return work() ? 0 : bad_input;
    else
      return work();
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0)
      return app.exit(e); // --help, --version
    return fail(bad_input, std::string(e.what()) + "\nRun with --help for more information.");
  } catch (const pcs::IO_error& e) {
    return fail(bad_input, e.what());
  } catch (const pcs::Invalid_input& e) {
    return fail(bad_input, e.what());
  } catch (const std::bad_alloc&) {
    return fail(internal_error, "not enough memory");
  } catch (const std::exception& e) {
    return fail(internal_error, std::string("internal error: ") + e.what());
  }
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_RUN_PROGRAM_H
