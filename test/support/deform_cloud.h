// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Runs one edit of a test. It is compiled once, with options as plain data.

#ifndef PCS_TEST_SUPPORT_DEFORM_CLOUD_H
#define PCS_TEST_SUPPORT_DEFORM_CLOUD_H

#include <pcs/core/Deformation_report.h>
#include <pcs/deform_point_set.h>
#include <support/point_clouds.h>

#include <functional>
#include <optional>
#include <vector>

namespace pcs_test {

/// The named parameters of pcs::deform_point_set(), with their documented defaults.
struct Options
{
  long long number_of_samples = pcs::default_number_of_samples;
  long long number_of_neighbors = pcs::default_number_of_neighbors;
  long long number_of_sample_neighbors = pcs::default_number_of_sample_neighbors;
  long long number_of_iterations = pcs::deformation::default_maximal_number_of_passes;
  double tolerance = pcs::deformation::default_tolerance;
  double stiffness = 1;
  double poisson_ratio = 0;
  bool do_preserve_volume = true;
  pcs::Sample_search sample_search = pcs::Sample_search::regions;
  pcs::Sample_weights sample_weights = pcs::Sample_weights::compact;
  pcs::Rotation_field rotation_field = pcs::Rotation_field::geodesic;
  std::optional<std::vector<std::size_t>> region_of_interest;
  std::function<bool(double)> callback;
  bool is_sequential = false;
};

struct Deformed
{
  pcs::Deformation_report report;
  Points points;
  Points normals; ///< of the points; deformed with them
};

using Handles = std::vector<pcs::Deformation_handle>;

/// Deforms a copy. Normals are `normals`, or an arbitrary unit vector for each point.
Deformed deform(const Points& points,
                const Handles& handles,
                const Options& options = {},
                const Points& normals = {});

/// The arbitrary normals of `deform()`.
Points arbitrary_normals(std::size_t n);

/// The points are bit-identical.
inline bool is_untouched(const Deformed& result, const Points& points)
{
  return result.points == points && result.normals == arbitrary_normals(points.size());
}

inline bool is_finite(const Points& points)
{
  return std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
}

inline bool is_finite(const Deformed& result)
{
  return is_finite(result.points) && is_finite(result.normals);
}

/// Two handles: points accepted by `is_fixed` are fixed, those accepted by `is_moved` are moved.
template <class Fixed, class Moved>
Handles two_handles(const Points& points,
                    const Fixed& is_fixed,
                    const Moved& is_moved,
                    const pcs::Similarity& motion)
{
  return {{select(points, is_fixed), pcs::Similarity(), 0}, {select(points, is_moved), motion, 0}};
}

/// A general edit: a bar along z with 45 degrees of twist, some bending and lifting.
struct Bar_edit
{
  Points points;
  Handles handles;

  /// `size` and `offset` are applied to the bar, the handles, and their motion.
  explicit Bar_edit(int width = 6,
                    int length = 24,
                    double size = 1,
                    const Vec3& offset = Vec3(0, 0, 0))
  {
    points = box(width, width, length, 1.0 / width);
    const double height = double(length) / width;
    const auto motion = pcs::translation(Vec3(.2, -.1, .1)) *
                        pcs::rotation(Vec3(.2, .3, 1), 0.8, Vec3(.5, .5, height));
    handles = two_handles(
        points,
        [](const Vec3& p) { return p.z() < .2; },
        [&](const Vec3& p) { return p.z() > height - .2; },
        to_frame(motion, size, offset));
    for (Vec3& p : points)
      p = size * p + offset;
  }

  /// The same motion in the frame `x -> size x + offset`.
  static pcs::Similarity to_frame(const pcs::Similarity& motion, double size, const Vec3& offset)
  {
    pcs::Similarity linear = pcs::Similarity::from_scale(motion.scale());
    for (const auto& turn : motion.turns())
      linear = pcs::Similarity::from_turn(turn) * linear;
    const Vec3 t = size * motion.translation() + offset - linear(offset);
    return pcs::Similarity::from_translation(t) * linear;
  }
};

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_DEFORM_CLOUD_H
