// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arbitrary bytes are a skeleton or an IO_error, as SWC, CSV, table of cylinders or .txtskl. The
// first byte selects the format. A skeleton is unchanged by writing it as SWC and reading.

#include "Fuzz_file.h"
#include <pcs/IO/read_cylinders.h>
#include <pcs/IO/read_swc.h>
#include <pcs/IO/read_tree_csv.h>
#include <pcs/IO/read_txtskl.h>
#include <pcs/IO/write_swc.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using pcs_fuzz::check;

bool read(int format, const std::string& path, Tree& tree)
{
  try {
    if (format == 0)
      pcs::IO::read_swc<Kernel>(path, tree);
    else if (format == 1)
      pcs::IO::read_tree_csv<Kernel>(path, tree);
    else if (format == 2)
      pcs::IO::read_cylinders<Kernel>(path, tree);
    else
      pcs::IO::read_txtskl<Kernel>(path, tree);
    return true;
  } catch (const pcs::IO_error&) {
    return false;
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  if (size == 0)
    return 0;
  const int format = data[0] % 4;
  const char* const names[] = {"tree.swc", "tree.csv", "cylinders.csv", "tree.txtskl"};
  const std::string path = pcs_fuzz::write_file(names[format], data + 1, size - 1);
  Tree tree, again;
  if (!read(format, path, tree))
    return 0;
  check(num_vertices(tree) > 0);
  const std::string written = pcs_fuzz::folder() + "/written.swc";
  try {
    pcs::IO::write_swc(written, tree);
  } catch (const pcs::Invalid_input&) {
    return 0;
  } catch (const pcs::IO_error&) {
    return 0;
  }
  check(read(0, written, again));
  check(num_vertices(again) == num_vertices(tree));
  return 0;
}
