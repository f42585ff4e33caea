// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The habit of measured trees: growth parameters with intervals, allometry, and distributions.

#ifndef PCS_GENERATORS_TREE_HABIT_FIT_H
#define PCS_GENERATORS_TREE_HABIT_FIT_H

#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/text.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsGeneratorsRef
//! one growth parameter of a `Tree_habit_fit`
struct Habit_value
{
  std::string name;          //!< the member of `Tree_habit`, as `taper[1]` or `insertion[0].least`
  std::string unit;          //!< `L`, `rad` or `-`
  double value = 0;          //!< as in `Tree_habit_fit::habit`
  double standard_error = 0; //!< in the unit of the value
  double least = 0, largest = 0;     //!< interval of 95 % confidence
  std::size_t number_of_samples = 0; //!< branches, stems or steps that contributed [count]
  //! `false`: the trees do not determine the value; it is a default, or a mere bound
  bool is_identified = false;
};

//! \ingroup PkgPcsGeneratorsRef
//! the shares of the values that `Habit_distribution` lists: 5, 25, 50, 75 and 95 %
using Habit_quantiles = std::array<double, 5>;

//! \ingroup PkgPcsGeneratorsRef
//! distributions of the measured branches of one order, without any model
struct Habit_distribution
{
  int order = 0;                      //!< 0 for trunks, 1 for branches on them, ... [count]
  std::size_t number_of_branches = 0; //!< [count]
  Habit_quantiles length{};           //!< [L]
  Habit_quantiles base_radius{};      //!< [L]
  Habit_quantiles slenderness{};      //!< ratio of length and base radius [-]
  Habit_quantiles insertion{};        //!< angle to the parent [rad]
  Habit_quantiles radius_ratio{};     //!< ratio of the base radius to the radius of the parent [-]
  Habit_quantiles place{};            //!< fraction of the length of the parent [-]
  Habit_quantiles number_of_children{};  //!< per branch of this order [count]
  Habit_quantiles children_per_length{}; //!< [1/L]
};

//! \ingroup PkgPcsGeneratorsRef
//! power laws by which the sizes of trees depend on their heights
struct Habit_allometry
{
  double height = 1;                  //!< geometric mean of the lengths of the trunks [L]
  double height_spread = 0;           //!< standard deviation of their natural logarithms [-]
  double trunk_radius_exponent = 1.5; //!< of radii of the trunk; 3/2 is elastic similarity [-]
  double crown_radius_exponent = 1;   //!< [-]
  double trunk_radius_error = 0;      //!< standard error of the exponent [-]
  double crown_radius_error = 0;      //!< standard error of the exponent [-]
  bool is_identified = false;         //!< `false`: exponents are defaults
};

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief The result of `fit_tree_habit()`.

  `habit` describes a tree whose trunk has the length `allometry.height`. `values` lists all
  continuous growth parameters in a fixed order.
*/
struct Tree_habit_fit
{
  Tree_habit habit;
  std::vector<Habit_value> values;
  std::vector<Habit_distribution> distributions; //!< by order
  Habit_allometry allometry;
  std::size_t number_of_trees = 0;    //!< [count]
  std::size_t number_of_branches = 0; //!< in all trees, with the trunks [count]
  double smallest_radius = 0;         //!< thinner parts were left out [L]
  //! the logarithm of the likelihood of `habit.crown`, minus that of the next shape; below 2, the
  //! trees do not distinguish the two [-]
  double crown_margin = 0;
  std::vector<double> trunk_tilts; //!< of each tree: the angle of its trunk to z, base to tip [rad]
};

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief returns the habit of a tree of another height, by the allometry of a fit.

  Radii of the trunk and of the largest branches, and the radius of the crown, follow their power
  laws; the flare is proportional to the height. Spacing, angles and proportions of branches do not
  depend on the height.

  \param fit a result of `fit_tree_habit()`
  \param height length of the trunk [L]
  \throws pcs::Invalid_input when `height` is not finite or not positive
*/
inline Tree_habit habit_at_height(const Tree_habit_fit& fit, double height)
{
  if (!(height > 0 && std::isfinite(height)))
    throw Invalid_input("pcs::habit_at_height(): `height` must be finite and positive, found " +
                        internal::to_text(height));
  Tree_habit habit = fit.habit;
  const double size = height / habit.height;
  const double radii = std::pow(size, fit.allometry.trunk_radius_exponent);
  habit.height = height;
  habit.trunk_radius *= radii;
  habit.largest_branch *= radii;
  habit.flare_height *= size;
  habit.crown_radius *= std::pow(size, fit.allometry.crown_radius_exponent);
  return habit;
}

namespace internal {

/// Returns a sentence about a tree whose trunk is far from the vertical; empty for others.
inline std::string tilt_warning(const std::string& tree, double tilt)
{
  constexpr double largest = 45, degree = pi / 180;
  if (!(tilt > largest * degree))
    return {};
  return tree + ": the trunk is tilted by " + std::to_string(std::lround(tilt / degree)) +
         " degrees from the vertical, which must be z";
}

/// Throws `Invalid_input` unless the tree is in the unit of length of the habit, as far as the
/// length of its trunk shows.
inline void check_unit(double height, const Tree_habit_fit& fit, const std::string& caller)
{
  constexpr double largest_ratio = 100;
  const double known = fit.allometry.height;
  check(known <= 0 || (height < largest_ratio * known && known < largest_ratio * height),
        caller,
        "the trunk has the length " + to_text(height) + ", and those of the habit have " +
            to_text(known) + "; use one unit of length for the tree and the habit");
}

} // namespace internal

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief returns sentences about a fit that is probably wrong or ambiguous; none if all is well.

  \param fit a result of `fit_tree_habit()`
  \param names of the trees; otherwise they are `tree 0`, `tree 1`, ...
*/
inline std::vector<std::string> warnings(const Tree_habit_fit& fit,
                                         const std::vector<std::string>& names = {})
{
  std::vector<std::string> result;
  for (std::size_t i = 0; i < fit.trunk_tilts.size(); ++i) {
    const std::string name = i < names.size() ? names[i] : "tree " + std::to_string(i);
    const std::string sentence = internal::tilt_warning(name, fit.trunk_tilts[i]);
    if (!sentence.empty())
      result.push_back(sentence);
  }
  if (fit.number_of_trees > 0 && fit.crown_margin < 2)
    result.push_back("the lengths of branches fit several shapes of crowns; more trees may tell "
                     "them apart");
  return result;
}

} // namespace pcs

#endif // PCS_GENERATORS_TREE_HABIT_FIT_H
