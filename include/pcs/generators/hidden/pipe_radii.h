// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The least radii of axes by the pipe model: no axis is thinner than what it carries.

#ifndef PCS_GENERATORS_HIDDEN_PIPE_RADII_H
#define PCS_GENERATORS_HIDDEN_PIPE_RADII_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/generators/habit/Tree_sample.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pcs {
namespace generators {
namespace hidden {

/// The middle one of several values.
inline double median(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

inline double radius_at(const habit::Axis& axis, double at)
{
  const auto next = std::lower_bound(axis.at.begin(), axis.at.end(), at);
  const auto i = std::min(static_cast<std::size_t>(next - axis.at.begin()), axis.at.size() - 1);
  return axis.radius[i];
}

/// The median radius of an axis between two lengths from its base; 0 beyond its end.
inline double median_radius(const habit::Axis& axis, double from, double to)
{
  constexpr int number_of_samples = 16;
  std::vector<double> values;
  for (int k = 0; k <= number_of_samples; ++k) {
    const double at = from + (to - from) * k / number_of_samples;
    values.push_back(at > axis.length() ? 0 : radius_at(axis, at));
  }
  return median(values);
}

/*
  Returns the tree with radii that are not smaller than those of the wood that an axis carries: of a
  limb that is hidden at its base, the fit has found a thin axis there. The radius of carried wood
  is a median over several diameters, because fits may bulge at single places.
*/
inline habit::Tree_sample with_pipe_radii(const habit::Tree_sample& tree)
{
  constexpr double reach = 3; // of the medians, in radii to both sides
  habit::Tree_sample result = tree;
  std::vector<std::vector<std::size_t>> children(tree.axes.size());
  for (std::size_t a = 0; a < tree.axes.size(); ++a)
    if (tree.axes[a].parent != npos)
      children[tree.axes[a].parent].push_back(a);
  std::vector<double> carried_by(tree.axes.size(), 0); // thickest wood on and beyond the axis
  for (std::size_t a = tree.axes.size(); a-- > 0;) {   // branches precede their parents
    const habit::Axis& axis = tree.axes[a];
    double& carried = carried_by[a];
    for (std::size_t i = axis.at.size(); i-- > 0;) {
      for (const std::size_t c : children[a])
        if (tree.axes[c].place == i)
          carried = std::max(carried, carried_by[c]);
      const double r = axis.radius[i], around = reach * r;
      result.axes[a].radius[i] = std::max(r, carried);
      const double smooth =
          median_radius(axis, std::max(0.0, axis.at[i] - around), axis.at[i] + around);
      carried = std::max(carried, std::min(r, smooth));
    }
  }
  return result;
}

} // namespace hidden
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HIDDEN_PIPE_RADII_H
