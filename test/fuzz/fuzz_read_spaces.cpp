// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arbitrary bytes are a shape space, correspondences, or an IO_error; the first byte selects which.
// What was read is the same after writing and reading.

#include "Fuzz_file.h"
#include <pcs/IO/read_correspondences.h>
#include <pcs/IO/read_shape_space.h>
#include <pcs/IO/write_correspondences.h>
#include <pcs/IO/write_shape_space.h>
#include <pcs/core/errors.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>

namespace {

std::string text_of(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Reads, writes, reads and writes; the written files are the same.
template <class Read, class Write>
void go_round(const std::string& path, const Read& read, const Write& write)
{
  try {
    const auto first = read(path);
    const std::string a = pcs_fuzz::folder() + "/a", b = pcs_fuzz::folder() + "/b";
    write(a, first);
    write(b, read(a));
    pcs_fuzz::check(text_of(a) == text_of(b));
  } catch (const pcs::IO_error&) {
  } catch (const pcs::Invalid_input&) {
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  if (size == 0)
    return 0;
  const std::string path = pcs_fuzz::write_file("input", data + 1, size - 1);
  if (data[0] % 2 == 0)
    go_round(
        path,
        [](const std::string& p) { return pcs::IO::read_shape_space(p); },
        [](const std::string& p, const auto& s) { pcs::IO::write_shape_space(p, s); });
  else
    go_round(
        path,
        [](const std::string& p) { return pcs::IO::read_correspondences(p); },
        [](const std::string& p, const auto& c) { pcs::IO::write_correspondences(p, c); });
  return 0;
}
