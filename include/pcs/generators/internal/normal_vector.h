// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random vectors.

#ifndef PCS_GENERATORS_INTERNAL_NORMAL_VECTOR_H
#define PCS_GENERATORS_INTERNAL_NORMAL_VECTOR_H

#include <pcs/internal/Random_stream.h>

#include <Eigen/Core>

namespace pcs {
namespace generators {
namespace internal {

/// Returns three normal random numbers, drawn one after the other. As arguments of one call, they
/// would be drawn in an order that depends on the compiler.
inline Eigen::Vector3d normal_vector(pcs::internal::Random_stream& random)
{
  const double z = random.normal();
  const double y = random.normal();
  const double x = random.normal();
  return {x, y, z};
}

} // namespace internal
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_INTERNAL_NORMAL_VECTOR_H
