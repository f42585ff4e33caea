// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arbitrary bytes are an edit of the program deform_point_set, or an error in one sentence.

#include "Fuzz_file.h"
#include "deformation/read_edit.h"
#include <pcs/core/errors.h>

#include <cstddef>
#include <cstdint>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const std::string path = pcs_fuzz::write_file("edit.json", data, size);
  try {
    program::read_edit(path);
  } catch (const pcs::IO_error&) {
  } catch (const pcs::Invalid_input&) {
  }
  return 0;
}
