// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the results of all public algorithms: sequential, and twice each on 1, 2, 4 and 8
// threads. With the name of a folder, writes them there instead, for compare_builds.py.

#include "Results.h"
#include <support/threads.h>

#include <cstddef>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

pcs_test::Results record(bool is_sequential)
{
  pcs_test::Results results;
  pcs_test::record_generators(is_sequential, results);
  pcs_test::record_deformations(is_sequential, results);
  pcs_test::record_skeletons(is_sequential, results);
  pcs_test::record_shape_spaces(is_sequential, results);
  return results;
}

/// Writes the values as they are in memory, one file for each result, and the sums.
void write(const pcs_test::Results& results, const std::string& folder)
{
  std::ofstream list(folder + "/sums.txt");
  for (const pcs_test::Result& result : results.all()) {
    std::ofstream file(folder + '/' + result.name + ".f64", std::ios::binary);
    file.write(reinterpret_cast<const char*>(result.values.data()),
               static_cast<std::streamsize>(result.values.size() * sizeof(double)));
    file.close();
    if (!file)
      throw std::runtime_error("`" + folder + "` must be a folder that can be written");
    list << std::hex << std::setw(16) << std::setfill('0') << result.sum() << std::dec << ' '
         << result.values.size() << ' ' << result.name << '\n';
  }
  list.close();
  if (!list)
    throw std::runtime_error("the list in `" + folder + "` was not written");
}

/// Returns the number of results that depend on the threads.
int compare()
{
  const pcs_test::Results sequential = record(true);
  std::vector<std::string> differences(sequential.all().size());
  for (const int threads : {1, 2, 4, 8})
    for (int repetition = 0; repetition < 2; ++repetition)
      pcs_test::with_threads(threads, [&] {
        const pcs_test::Results parallel = record(false);
        for (std::size_t k = 0; k < differences.size(); ++k)
          if (sequential.all()[k].sum() != parallel.all().at(k).sum())
            differences[k] += ' ' + std::to_string(threads);
      });
  int count = 0;
  for (std::size_t k = 0; k < differences.size(); ++k) {
    std::cout << std::hex << std::setw(16) << std::setfill('0') << sequential.all()[k].sum()
              << std::dec << ' ' << sequential.all()[k].name;
    if (!differences[k].empty()) {
      std::cout << ": other bits on this number of threads:" << differences[k];
      ++count;
    }
    std::cout << '\n';
  }
  std::cout << count << " of " << differences.size() << " results depend on the threads\n";
  return count;
}

} // namespace

int main(int argc, char** argv)
{
  try {
    if (argc == 1)
      return compare() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
    write(record(false), argv[1]);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::cerr << "record_results: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
}
