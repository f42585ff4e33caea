// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random vectors that are equal for all compilers.

#ifndef PCS_TEST_SUPPORT_DRAWN_H
#define PCS_TEST_SUPPORT_DRAWN_H

namespace pcs_test {

/// Three draws, the third coordinate first. As arguments of one call they come in an order that
/// compilers choose.
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
