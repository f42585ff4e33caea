// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The axes found so far, which points they explain, and what was learned from them about the scan.

#ifndef PCS_SKELETON_AXIS_SET_H
#define PCS_SKELETON_AXIS_SET_H

#include <pcs/skeleton/Axis.h>
#include <pcs/skeleton/Density_field.h>
#include <pcs/skeleton/Facing_field.h>
#include <pcs/skeleton/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// One axis and where it came from.
struct Fitted_axis
{
  Axis axis;
  Index parent = none; ///< axis that the paths to the root lead to
  std::size_t number_of_points = 0;
  double direction = 1; ///< how sure its base is one: 0 if its pieces point to both sides alike [-]
};

struct Axis_set
{
  std::vector<Fitted_axis> axes;
  std::vector<Index> axis_of_point; ///< `none`: not explained by any axis
  std::vector<Index> segment_of_point;
  double noise = 0;   ///< standard deviation of points from the surface [L]
  double density = 0; ///< median of points per area of the surface; 0: not known yet [1/L^2]
  Density_field density_field;
  Facing_field facing_field;

  /// Points per area of a branch at a place, along a unit vector [1/L^2].
  double density_at(const Vec3& place, const Vec3& along) const
  {
    return density_field.is_known() ? density_field(place, along) : density;
  }
  /// The same at a node of an axis.
  double density_at(const Axis& axis, std::size_t k) const
  {
    const Vec3 d = axis[std::min(axis.size() - 1, k + 1)].point - axis[k > 0 ? k - 1 : 0].point;
    const double length = d.norm();
    return density_at(axis[k].point, length > 0 ? Vec3(d / length) : Vec3(Vec3::UnitZ()));
  }
  /// The mean outward normal of the points at a node; zero where nothing is known.
  Vec3 facing_at(const Axis& axis, std::size_t k) const
  {
    const Vec3 d = axis[std::min(axis.size() - 1, k + 1)].point - axis[k > 0 ? k - 1 : 0].point;
    const double length = d.norm();
    const bool is_known = facing_field.is_known() && length > 0;
    return is_known ? facing_field(axis[k].point, d / length) : Vec3(Vec3::Zero());
  }

  bool is_covered(Index i) const { return axis_of_point[i] != none; }

  /// How far `p` lies outside of the axis that explains point `i`; negative inside [L].
  double height_above(Index i, const Vec3& p) const
  {
    const Axis& axis = axes[axis_of_point[i]].axis;
    const Axis_place place = nearest_place(axis, segment_of_point[i], p);
    return place.distance - radius_at(axis, place);
  }
};

/// Deviations and densities, gathered from fits in a fixed order.
class Scan_statistics
{
public:
  void add_deviations(const std::vector<double>& values)
  {
    const std::size_t room = capacity - std::min(capacity, m_deviations.size());
    m_deviations.insert(m_deviations.end(),
                        values.begin(),
                        values.begin() +
                            static_cast<std::ptrdiff_t>(std::min(room, values.size())));
  }
  void add_densities(const std::vector<Density_sample>& samples)
  {
    m_densities.insert(m_densities.end(), samples.begin(), samples.end());
  }

  /// Updates noise and density where there is enough to go by.
  void learn(Axis_set& set)
  {
    if (m_deviations.size() >= enough_deviations && m_deviations.size() != m_learned_deviations) {
      m_learned_deviations = m_deviations.size();
      std::vector<double> copy = m_deviations;
      set.noise = 1.4826 * median(copy); // standard deviation from the median of |e|
    }
    if (m_densities.size() >= enough_densities &&
        (m_densities.size() != m_learned_densities || set.noise != m_learned_noise)) {
      m_learned_densities = m_densities.size();
      m_learned_noise = set.noise;
      std::vector<double> thick, all;
      for (const Density_sample& s : m_densities) {
        all.push_back(s.density);
        if (s.radius > thick_radius * set.noise)
          thick.push_back(s.density);
      }
      set.density = median(thick.size() >= enough_densities ? thick : all);
      if (double(m_densities.size()) >= field_growth * double(m_samples_of_field)) {
        m_samples_of_field = std::max(m_densities.size(), Density_field::fewest_samples);
        learn_fields(set);
      }
    }
  }

private:
  void learn_fields(Axis_set& set) const
  {
    std::vector<Density_sample> thick;
    for (const Density_sample& s : m_densities)
      if (s.radius > thick_radius * set.noise)
        thick.push_back(s);
    set.density_field.learn(thick.size() >= enough_thick ? thick : m_densities);
    set.facing_field.learn(thick.size() >= enough_facing ? thick : m_densities);
  }

  static constexpr std::size_t capacity = 40000, enough_deviations = 200, enough_densities = 8,
                               enough_thick = 600, enough_facing = 100;
  static constexpr double field_growth = 1.5; ///< of the samples, until the field is fitted again
  static constexpr double thick_radius =
      6; ///< in noise: here the radius, hence the density, has no bias
  std::vector<double> m_deviations;
  std::vector<Density_sample> m_densities;
  // what the last lesson was from
  std::size_t m_learned_deviations = 0, m_learned_densities = 0;
  double m_learned_noise = 0;
  std::size_t m_samples_of_field = 0;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXIS_SET_H
