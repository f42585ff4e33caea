// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random vectors that are equal for all compilers.

#ifndef PCS_TEST_SUPPORT_DRAWN_H
#define PCS_TEST_SUPPORT_DRAWN_H

namespace pcs_test {

/// Draws three values, the third coordinate first. The order of arguments of one call depends on
/// the compiler.
template <class Vector, class Draw>
Vector drawn(const Draw& draw)
{
  const double z = draw();
  const double y = draw();
  const double x = draw();
  return Vector(x, y, z);
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_DRAWN_H
