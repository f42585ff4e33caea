// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Smooth growth paths through trees of a shape space at given times.

#ifndef PCS_FIT_GROWTH_PATH_H
#define PCS_FIT_GROWTH_PATH_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/shape_space/Orl_tree.h>
#include <pcs/shape_space/input/check_space.h>
#include <pcs/shape_space/input/read_options.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/path/Growth_spline.h>
#include <pcs/shape_space/statistics/make_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsShapeSpaceRef
//! a smooth path through trees at given times
using Growth_spline = shape_space::Growth_spline;

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief fits a smooth path through added trees, in the order given.

  \param space a space that was built
  \param trees handles, at least 2
  \param times finite and increasing, one per tree; differences are 1e-150 to 1e150
  \param np
  \npbegin
    \np{is_monotone} whether lengths and radii never decrease; values that decrease are replaced by
        the closest non-decreasing ones
      \nptype `bool`
      \npdefault `false`: they decrease only between trees where the given values decrease
  \npend
  \throws pcs::Invalid_input for a wrong handle, fewer than two trees, another number of times, or
          times that do not increase or have other differences
  \par Complexity
  \f$O(n e + n^2 b)\f$ for `n` trees of `e` edges and `b` branches.
*/
template <class Kernel,
          class ConcurrencyTag,
          class NamedParameters = parameters::Default_named_parameters>
Growth_spline
fit_growth_path(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                const std::vector<typename Orl_shape_space<Kernel, ConcurrencyTag>::Handle>& trees,
                const std::vector<double>& times,
                const NamedParameters& np = NamedParameters())
{
  const char* const caller = "pcs::fit_growth_path()";
  const bool is_monotone = shape_space::read_is_monotone(np);
  const shape_space::Tree_family& family = space.family();
  shape_space::check_built(family, caller);
  pcs::internal::check(trees.size() >= 2 && times.size() == trees.size(),
                       caller,
                       std::to_string(trees.size()) + " trees and " + std::to_string(times.size()) +
                           " times, expected at least 2 and as many");
  std::vector<shape_space::Orl_coordinates> x;
  std::vector<std::vector<char>> has;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    shape_space::check_handle(family, trees[i], caller);
    pcs::internal::check(std::isfinite(times[i]) && (i == 0 || times[i] > times[i - 1]),
                         caller,
                         "times must be finite and increase");
    // the spline divides by the differences and multiplies them
    pcs::internal::check(
        i == 0 || (times[i] - times[i - 1] >= 1e-150 && times[i] - times[i - 1] <= 1e150),
        caller,
        "times must differ by 1e-150 to 1e150; choose another unit");
    x.push_back(family.x[trees[i]]);
    has.push_back(family.has[trees[i]]);
  }
  return Growth_spline(family.layout, times, std::move(x), has, is_monotone, trees);
}

//! \ingroup PkgPcsShapeSpaceRef
//! returns the tree of a path at a time, which is clamped to the interval of the path
template <class Kernel, class ConcurrencyTag>
Orl_tree tree_at_time(const Orl_shape_space<Kernel, ConcurrencyTag>& space,
                      const Growth_spline& path,
                      double time)
{
  const char* const caller = "pcs::tree_at_time()";
  const shape_space::Tree_family& family = space.family();
  shape_space::check_built(family, caller);
  pcs::internal::check(!path.times().empty() && std::isfinite(time),
                       caller,
                       "the path is empty or `time` not finite");
  shape_space::Orl_coordinates x;
  path.at(time, x);
  shape_space::check_coordinates(family, x, caller, "the path is of another space");
  for (const std::size_t h : path.scans())
    pcs::internal::check(h < space.number_of_trees(), caller, "the path is of another space");
  // points come from the scans before and after the time
  std::vector<double> scan_weights(space.number_of_trees(), 0);
  const auto [k, f] = path.place(time);
  scan_weights[path.scans()[k]] += 1 - f;
  scan_weights[path.scans()[std::min(k + 1, path.scans().size() - 1)]] += f;
  return Orl_tree(shape_space::make_tree(family, std::move(x), -1, std::move(scan_weights)));
}

} // namespace pcs

#endif // PCS_FIT_GROWTH_PATH_H
