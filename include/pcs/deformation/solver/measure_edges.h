// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Elastic energy and covariance of the edges of a node, vectorised.

#ifndef PCS_DEFORMATION_SOLVER_MEASURE_EDGES_H
#define PCS_DEFORMATION_SOLVER_MEASURE_EDGES_H

#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>

namespace pcs {
namespace deformation {

/// The edges of a network, and the positions of its nodes.
struct Edge_input
{
  const std::uint32_t* first;      ///< first half-edge of a node
  const std::uint32_t* neighbor;   ///< end node of a half-edge
  const double* weight;            ///< of a half-edge [-]
  const Eigen::Vector3d* rest;     ///< [L]
  const Eigen::Vector3d* position; ///< [L]
  const Eigen::Matrix3d* target;   ///< target map of the edges at a node [-]
};

namespace internal {

template <class Lanes>
PCS_ALWAYS_INLINE void load_three(const double* from, Lanes& to)
{
  to = Lanes{};
  for (std::size_t k = 0; k < 3; ++k)
    to[k] = from[k];
}

// The last lane is not used.
template <class Arithmetic>
PCS_ALWAYS_INLINE double
measure_edges(const Edge_input& in, std::size_t node, Eigen::Matrix3d& covariance)
{
  using pcs::internal::load;
  using pcs::internal::unroll;
  using Doubles = typename Arithmetic::Doubles;
  static_assert(sizeof(Doubles) == 4 * sizeof(double));
  constexpr double half = 0.5;
  Doubles here, own[3], squared{}, sum[3] = {Doubles{}, Doubles{}, Doubles{}};
  load_three(in.position[node].data(), here);
  const double* const own_target = in.target[node].data();
  load(own_target, own[0]);
  load(own_target + 3, own[1]);
  load_three(own_target + 6, own[2]);
  const double* const own_rest = in.rest[node].data();
  for (std::size_t e = in.first[node]; e < in.first[node + 1]; ++e) {
    const std::size_t j = in.neighbor[e];
    const double *target = in.target[j].data(), *other_rest = in.rest[j].data();
    Doubles now, other[3], rest[3], half_of_all, weight;
    load_three(in.position[j].data(), now);
    load(target, other[0]);
    load(target + 3, other[1]);
    load_three(target + 6, other[2]);
    now = now - here;
    unroll<3>([&](auto c) PCS_LAMBDA_INLINE {
      Arithmetic::fill(other_rest[c] - own_rest[c], rest[c]);
      other[c] = other[c] + own[c];
    });
    Doubles twice_aim = other[0] * rest[0], error = now;
    Arithmetic::fma(other[1], rest[1], twice_aim);
    Arithmetic::fma(other[2], rest[2], twice_aim);
    Arithmetic::fill(half, half_of_all);
    Arithmetic::subtract_product(half_of_all, twice_aim, error);
    Arithmetic::fill(in.weight[e], weight);
    Arithmetic::fma(Doubles(weight * error), error, squared);
    now = now * weight;
    unroll<3>([&](auto c) PCS_LAMBDA_INLINE { Arithmetic::fma(now, rest[c], sum[c]); });
  }
  unroll<3>([&](auto c) PCS_LAMBDA_INLINE {
    for (std::size_t r = 0; r < 3; ++r)
      covariance.data()[3 * c + r] = sum[c][r];
  });
  return half * (squared[0] + squared[1] + squared[2]);
}

inline double
measure_edges_default(const Edge_input& in, std::size_t node, Eigen::Matrix3d& covariance)
{
  return measure_edges<pcs::internal::Portable_arithmetic>(in, node, covariance);
}

#if PCS_HAS_RUNTIME_DISPATCH
PCS_TARGET_AVX2 inline double
measure_edges_avx2(const Edge_input& in, std::size_t node, Eigen::Matrix3d& covariance)
{
  return measure_edges<pcs::internal::Avx2_arithmetic>(in, node, covariance);
}
#endif

} // namespace internal

/// Returns half the energy of the edges of a node; sets `covariance` to
/// `sum_j w_ij (x_j - x_i) (x0_j - x0_i)^T`.
using Measure_edges = double (*)(const Edge_input&, std::size_t node, Eigen::Matrix3d& covariance);

/// Returns the kernel for this machine. All kernels give the same bits.
inline Measure_edges choose_measure_edges()
{
#if PCS_HAS_RUNTIME_DISPATCH
  if (pcs::internal::has_avx2())
    return &internal::measure_edges_avx2;
#endif
  return &internal::measure_edges_default;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_MEASURE_EDGES_H
