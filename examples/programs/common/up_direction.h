// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The direction of the option --up.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_UP_DIRECTION_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_UP_DIRECTION_H

#include <string>

namespace program {

/// Returns the unit vector of x, y, z, -x, -y or -z.
template <class Kernel>
typename Kernel::Vector_3 up_direction(const std::string& name)
{
  const double sign = name.front() == '-' ? -1 : 1;
  const char axis = name.back();
  return {axis == 'x' ? sign : 0, axis == 'y' ? sign : 0, axis == 'z' ? sign : 0};
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_UP_DIRECTION_H
