// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arbitrary points and handles are deformed to finite points, or refused.

#include "Fuzz_file.h"
#include <pcs/Point_set_deformation.h>
#include <pcs/core/errors.h>

#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Points = std::vector<Kernel::Point_3>;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  pcs_fuzz::Bytes bytes(data, size);
  const std::size_t samples = bytes.count(1, 60), neighbors = bytes.count(2, 12);
  const std::size_t held = bytes.count(1, 8), moved = bytes.count(1, 8);
  const Kernel::Vector_3 shift(bytes.between(-9, 9), bytes.between(-9, 9), bytes.between(-9, 9));
  const double angle = bytes.between(-10, 10), ratio = bytes.between(-1, 0.5);
  Points points;
  while (!bytes.is_empty() && points.size() < 300) {
    const double x = bytes.coordinate(), y = bytes.coordinate(), z = bytes.coordinate();
    points.emplace_back(x, y, z);
  }
  const Points at_rest = points;
  try {
    pcs::Point_set_deformation session(
        points,
        pcs::parameters::number_of_samples(samples).number_of_neighbors(neighbors).poisson_ratio(
            ratio));
    std::vector<std::size_t> first, last;
    for (std::size_t i = 0; i < held; ++i)
      first.push_back(i);
    for (std::size_t i = 0; i < moved; ++i)
      last.push_back(points.size() - 1 - i);
    session.add_handle(first);
    const auto handle = session.add_handle(last);
    session.set_rotation(handle, Kernel::Vector_3(0, 0, 1), angle);
    session.deform();
    session.set_translation(handle, shift);
    session.deform(pcs::Solver_start::warm);
  } catch (const pcs::Invalid_input&) {
    pcs_fuzz::check(points == at_rest || !points.empty());
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    const bool was_finite = std::isfinite(at_rest[i].x() + at_rest[i].y() + at_rest[i].z());
    pcs_fuzz::check(!was_finite || std::isfinite(p.x() + p.y() + p.z()));
  }
  return 0;
}
