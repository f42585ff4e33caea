// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The smallest program of a user of pcs.

#include <pcs/core/errors.h>

#include <iostream>

int main()
{
  try {
    throw pcs::Invalid_input("consumer: as expected");
  } catch (const pcs::Invalid_input& error) {
    std::cout << error.what() << '\n';
    return 0;
  }
}
