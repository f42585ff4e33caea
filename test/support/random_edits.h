// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random small degenerate clouds with random handles and parameters.

#ifndef PCS_TEST_SUPPORT_RANDOM_EDITS_H
#define PCS_TEST_SUPPORT_RANDOM_EDITS_H

#include <support/deform_cloud.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace pcs_test {

struct Random_edit
{
  Points points;
  Handles handles;
  Options options;
};

inline Points random_shape(std::mt19937& random)
{
  const std::size_t most = random() % 4 == 0 ? 600 : 40; // operands are unordered
  const std::size_t n = 1 + random() % most;
  Points points = random_points(n, static_cast<unsigned>(random()));
  switch (random() % 9) {
  case 0: // a line
    for (Vec3& p : points)
      p = p.x() * Vec3(1, 2, 3);
    break;
  case 1: // a plane
    for (Vec3& p : points)
      p.z() = 0.5 * p.x();
    break;
  case 2: // a grid with duplicates
    for (Vec3& p : points)
      p = (3 * p).array().round() / 3;
    break;
  case 3: // clusters far apart
    for (Vec3& p : points)
      p += 1e3 * std::floor(2.99 * std::abs(p.x())) * Vec3(1, 1, 0);
    break;
  case 4: // a geometric sequence, limited by the range of squared lengths
    for (std::size_t i = 0; i < n; ++i)
      points[i] *= std::ldexp(1.0, -static_cast<int>(i % 400));
    break;
  case 5: // a sphere
    for (Vec3& p : points)
      p = p.norm() > 0 ? Vec3(p.normalized()) : Vec3(Vec3::UnitX());
    break;
  case 6: { // an outlier
    const std::size_t i = random() % n;
    points[i] *= std::pow(10.0, double(random() % 7));
    break;
  }
  case 7: // a flat slab of nearly coincident points
    for (Vec3& p : points)
      p.z() *= 1e-13;
    break;
  default:
    break;
  }
  const double size = random() % 3 == 0 ? std::pow(10.0, 9 * uniform(random)) : 1;
  const Vec3 offset = random() % 3 == 0 ? Vec3(5e6 * random_vector(random)) : Vec3(0, 0, 0);
  for (Vec3& p : points)
    p = size * p + offset;
  return points;
}

inline pcs::Similarity random_motion(std::mt19937& random, const Points& points)
{
  const double size = diagonal(points);
  const Vec3 center = points[random() % points.size()];
  const double angle = 8 * uniform(random), other_angle = 3 * uniform(random);
  const Vec3 axis = random_direction(random), other_axis = random_direction(random);
  const Vec3 offset = size * random_vector(random);
  const double factor = std::pow(10.0, uniform(random));
  pcs::Similarity motion;
  if (random() % 2)
    motion = pcs::rotation(axis, angle, center) * motion;
  if (random() % 4 == 0)
    motion = pcs::rotation(other_axis, other_angle, center) * motion;
  if (random() % 2)
    motion = pcs::translation(offset) * motion;
  if (random() % 4 == 0)
    motion = motion * pcs::scaling(factor, center);
  return motion;
}

inline Random_edit random_edit(unsigned seed)
{
  std::mt19937 random(seed);
  Random_edit edit;
  edit.points = random_shape(random);
  const std::size_t n = edit.points.size();
  for (std::size_t h = 1 + random() % 4; h-- > 0;) {
    pcs::Deformation_handle handle;
    const std::size_t most = random() % 3 == 0 ? n : 3;
    for (std::size_t k = 1 + random() % most; k-- > 0;)
      handle.indices.push_back(random() % n);
    handle.transformation = random_motion(random, edit.points);
    if (random() % 4 == 0)
      handle.softness = std::pow(10.0, 4 * uniform(random));
    edit.handles.push_back(handle);
  }
  Options& o = edit.options;
  o.number_of_samples = static_cast<long long>(random() % 2 ? 1 + random() % 30 : 2000);
  o.number_of_neighbors = static_cast<long long>(random() % 3 ? 6 : 2 + random() % 59);
  o.number_of_sample_neighbors = static_cast<long long>(random() % 3 ? 6 : 1 + random() % 32);
  o.number_of_iterations = static_cast<long long>(random() % 25);
  if (random() % 3 == 0)
    o.poisson_ratio = -0.25 + 0.75 * uniform(random);
  if (random() % 3 == 0)
    o.stiffness = std::pow(10.0, 3 * uniform(random));
  o.do_preserve_volume = random() % 4 != 0;
  o.sample_search =
      random() % 4 ? pcs::Sample_search::regions : pcs::Sample_search::breadth_first_hops;
  o.sample_weights =
      random() % 4 ? pcs::Sample_weights::compact : pcs::Sample_weights::inverse_square;
  o.rotation_field = random() % 4 ? pcs::Rotation_field::geodesic : pcs::Rotation_field::quaternion;
  if (random() % 5 == 0) {
    std::vector<std::size_t> region;
    for (std::size_t i = 0; i < n; ++i)
      if (random() % 4)
        region.push_back(i);
    o.region_of_interest = region;
  }
  o.is_sequential = random() % 4 == 0;
  return edit;
}

/// Describes the error of an edit; empty if there is none. A thrown error is a defined result.
inline std::string fault_of(const Random_edit& edit)
{
  try {
    const auto result = deform(edit.points, edit.handles, edit.options);
    if (!is_finite(result))
      return "a result is not finite";
    if (!std::isfinite(result.report.energy) || result.report.energy < 0)
      return "the energy is " + std::to_string(result.report.energy);
    if (result.report.status == pcs::Status::numerical_failure)
      return is_untouched(result, edit.points) ? "numerical failure" : "half written";
    double reach = diagonal(edit.points);
    for (const auto& handle : edit.handles)
      for (const auto i : handle.indices)
        reach = std::max(reach, (handle.transformation(edit.points[i]) - edit.points[i]).norm());
    for (const auto& handle : edit.handles)
      for (const auto i : handle.indices)
        if (handle.softness == 0 &&
            !((result.points[i] - handle.transformation(edit.points[i])).norm() <=
              1e-9 * (reach + edit.points[i].norm())))
          return "a handle misses its target by " +
                 std::to_string((result.points[i] - handle.transformation(edit.points[i])).norm());
    for (std::size_t i = 0; i < edit.points.size(); ++i)
      if (!((result.points[i] - edit.points[i]).norm() <= 1e4 * reach))
        return "point " + std::to_string(i) + " went " +
               std::to_string((result.points[i] - edit.points[i]).norm() / reach) + " reaches away";
    return {};
  } catch (const pcs::Invalid_input&) {
    return {};
  }
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_RANDOM_EDITS_H
