// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// How a virtual tree grows, and the habits of five kinds of trees.

#ifndef PCS_GENERATORS_TREE_HABIT_H
#define PCS_GENERATORS_TREE_HABIT_H

#include <pcs/core/errors.h>
#include <pcs/internal/text.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsGeneratorsRef
//! crown shape: the reach of branches from the trunk, from the base of the crown to its top
enum class Crown_shape {
  dome, //!< widest in the lower half
  cone, //!< widest at the base
  vase  //!< widest near the top
};

//! \ingroup PkgPcsGeneratorsRef
//! the interval of a random value
struct Value_range
{
  double least = 0, largest = 0;
};

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief Growth parameters of a virtual tree; the defaults describe a broadleaf in metres.

  Arrays contain the values of the trunk, of branches on it, and of all others. Bends and tropisms
  are changes per `bend_length` of growth. Lengths are in one unit; `scaled()` changes it.
*/
struct Tree_habit
{
  double height = 12;          //!< length of the trunk [L]
  double trunk_radius = 0.18;  //!< at its base, without root flare [L]
  double flare = 0.35;         //!< relative increase of the radius at the ground [-]
  double flare_height = 0.35;  //!< height over which the flare decays by 1/e [L]
  double lean = 0.02;          //!< standard deviation of the initial direction of the trunk [rad]
  int number_of_orders = 4;    //!< the trunk, branches, twigs, ... [count]
  double largest_step = 0.1;   //!< largest distance of nodes; also the distance on the trunk [L]
  double smallest_step = 0.03; //!< smallest distance; between these limits, twice the radius [L]

  double bend_length = 0.1;                           //!< unit of the next three values [L]
  std::array<double, 3> bend = {0.012, 0.05, 0.05};   //!< standard deviation [rad]
  double bend_renewal = 0.06;                         //!< probability of a new bend per step [-]
  std::array<double, 3> tropism = {0.01, 0.06, 0.02}; //!< upwards; negative: downwards [-]
  double sag = 0; //!< decrease of the tropism from the base of a branch to its tip [-]

  std::array<double, 2> taper = {0.75, 0.6};     //!< exponent: trunk, branches [-]
  std::array<double, 2> tip_share = {0.03, 0.1}; //!< ratio of the radii at tip and base [-]
  double tip_radius = 0.002;                     //!< smallest radius [L]

  std::array<double, 3> spacing = {0.28, 0.22, 0.14}; //!< mean distance of branches [L]
  std::array<double, 3> bare = {0.18, 0.15, 0.15};    //!< branchless fraction of the length [-]
  std::size_t whorl = 1; //!< number of branches per whorl on the trunk [count]
  std::array<Value_range, 2> insertion = {
      {{0.7, 1.3}, {0.7, 1.3}}}; //!< insertion angle: trunk, branches [rad]
  std::array<Value_range, 2> child_radius = {{{0.25, 0.52}, {0.25, 0.52}}}; //!< ratio to parent [-]
  double largest_branch = 0.065;         //!< largest radius of branches on the trunk [L]
  double smallest_branch = 0.003;        //!< smallest radius at the base of a branch [L]
  Value_range slenderness = {55, 80};    //!< ratio of length and radius of a branch [-]
  Crown_shape crown = Crown_shape::dome; //!< bounds the length of branches on the trunk
  double crown_radius = 3.2;             //!< [L]

  std::size_t number_of_leaders = 1;    //!< number of stems above the fork [count]
  double fork = 0.3;                    //!< fraction of the trunk below the fork [-]
  Value_range fork_angle = {0.45, 0.7}; //!< between the stems [rad]
  std::size_t number_of_stubs = 0;      //!< dead stubs below the crown [count]

  double flattest_section = 0.88; //!< smallest ratio of half axes of a section, at most 1 [-]

  //! returns the same habit in another unit: multiplies all lengths by `factor`
  Tree_habit scaled(double factor) const
  {
    Tree_habit result = *this;
    for (double* length : {&result.height,
                           &result.trunk_radius,
                           &result.flare_height,
                           &result.largest_step,
                           &result.smallest_step,
                           &result.bend_length,
                           &result.tip_radius,
                           &result.largest_branch,
                           &result.smallest_branch,
                           &result.crown_radius,
                           &result.spacing[0],
                           &result.spacing[1],
                           &result.spacing[2]})
      *length *= factor;
    return result;
  }
};

//! \ingroup PkgPcsGeneratorsRef
//! a broadleaf of 12 m with a dense crown
inline Tree_habit broadleaf_habit()
{
  return Tree_habit();
}

//! \ingroup PkgPcsGeneratorsRef
//! a conifer of 14 m: one straight leader, whorls of slender branches, a narrow cone
inline Tree_habit conifer_habit()
{
  Tree_habit h;
  h.height = 14;
  h.trunk_radius = 0.14;
  h.lean = 0.01;
  h.number_of_orders = 3;
  h.bend = {0.004, 0.03, 0.04};
  h.tropism = {0.02, 0.015, 0.01};
  h.sag = 0.03;
  h.taper = {0.95, 0.7};
  h.spacing = {0.42, 0.16, 0.14};
  h.bare = {0.12, 0.2, 0.2};
  h.whorl = 5;
  h.insertion = {{{1.25, 1.6}, {0.7, 1.0}}};
  h.child_radius = {{{0.12, 0.2}, {0.25, 0.45}}};
  h.largest_branch = 0.022;
  h.slenderness = {90, 130};
  h.crown = Crown_shape::cone;
  h.crown_radius = 2.2;
  return h;
}

//! \ingroup PkgPcsGeneratorsRef
//! a fruit tree of 4 m with a short trunk and a wide, open crown
inline Tree_habit fruit_habit()
{
  Tree_habit h;
  h.height = 3.2;
  h.trunk_radius = 0.07;
  h.flare = 0.25;
  h.flare_height = 0.12;
  h.lean = 0.06;
  h.largest_step = 0.06;
  h.smallest_step = 0.02;
  h.bend = {0.03, 0.06, 0.06};
  h.tropism = {0.01, 0.025, 0.03};
  h.spacing = {0.12, 0.14, 0.11};
  h.bare = {0.24, 0.12, 0.12};
  h.insertion = {{{0.9, 1.3}, {0.6, 1.1}}};
  h.child_radius = {{{0.4, 0.65}, {0.25, 0.5}}};
  h.largest_branch = 0.035;
  h.smallest_branch = 0.0025;
  h.slenderness = {60, 85};
  h.crown = Crown_shape::vase;
  h.crown_radius = 2;
  return h;
}

//! \ingroup PkgPcsGeneratorsRef
//! a broadleaf of 11 m whose trunk forks into two stems, with dead stubs below its crown
inline Tree_habit forked_habit()
{
  Tree_habit h;
  h.height = 11;
  h.trunk_radius = 0.2;
  h.number_of_leaders = 2;
  h.fork = 0.2;
  h.number_of_stubs = 3;
  h.spacing = {0.34, 0.26, 0.18};
  h.bare = {0.3, 0.15, 0.15};
  h.crown_radius = 2.8;
  return h;
}

//! \ingroup PkgPcsGeneratorsRef
//! a weeping tree of 7 m: branches rise, arch over and droop
inline Tree_habit weeping_habit()
{
  Tree_habit h;
  h.height = 7;
  h.trunk_radius = 0.16;
  h.bend = {0.02, 0.03, 0.03};
  h.tropism = {0.01, 0.07, -0.1};
  h.sag = 0.2;
  h.spacing = {0.2, 0.22, 0.22};
  h.bare = {0.28, 0.2, 0.2};
  h.insertion = {{{0.5, 0.9}, {0.5, 0.9}}};
  h.slenderness = {90, 140};
  h.largest_branch = 0.05;
  h.crown_radius = 4.5;
  return h;
}

//! \ingroup PkgPcsGeneratorsRef
//! names and habits of all presets
inline std::vector<std::pair<std::string, Tree_habit>> tree_habits()
{
  return {{"broadleaf", broadleaf_habit()},
          {"conifer", conifer_habit()},
          {"fruit", fruit_habit()},
          {"forked", forked_habit()},
          {"weeping", weeping_habit()}};
}

namespace internal {

/// Checks single values of a habit; throws `Invalid_input`.
struct Habit_checks
{
  static void check(bool is_fine, const char* name, double value, const char* rule)
  {
    if (!is_fine || !std::isfinite(value))
      throw Invalid_input(std::string("pcs::Tree_habit: `") + name + "` must be " + rule +
                          ", found " + to_text(value));
  }

  static void positive(double value, const char* name)
  {
    check(value > 0, name, value, "positive");
  }

  static void not_negative(double value, const char* name)
  {
    check(value >= 0, name, value, "0 or more");
  }

  static void share(double value, const char* name)
  {
    check(value >= 0 && value < 1, name, value, "in [0, 1)");
  }

  static void range(const Value_range& r, const char* name)
  {
    check(r.least > 0, name, r.least, "positive");
    check(r.largest >= r.least, name, r.largest, "a range from the least to the largest value");
  }

  static void axes(const Tree_habit& h);
  static void branching(const Tree_habit& h);
};

/// Checks trunk, steps and bends.
inline void Habit_checks::axes(const Tree_habit& h)
{
  positive(h.height, "height");
  positive(h.trunk_radius, "trunk_radius");
  not_negative(h.flare, "flare");
  positive(h.flare_height, "flare_height");
  not_negative(h.lean, "lean");
  check(h.number_of_orders >= 1 && h.number_of_orders <= 8,
        "number_of_orders",
        h.number_of_orders,
        "from 1 to 8");
  positive(h.smallest_step, "smallest_step");
  check(h.largest_step >= h.smallest_step,
        "largest_step",
        h.largest_step,
        "at least smallest_step");
  positive(h.bend_length, "bend_length");
  share(h.bend_renewal, "bend_renewal");
  for (std::size_t i = 0; i < 3; ++i) {
    not_negative(h.bend[i], "bend");
    check(std::isfinite(h.tropism[i]), "tropism", h.tropism[i], "finite");
    positive(h.spacing[i], "spacing");
    share(h.bare[i], "bare");
  }
  check(std::isfinite(h.sag), "sag", h.sag, "finite");
}

/// Checks branches on branches, forks, stubs and sections.
inline void Habit_checks::branching(const Tree_habit& h)
{
  for (std::size_t i = 0; i < 2; ++i) {
    positive(h.taper[i], "taper");
    share(h.tip_share[i], "tip_share");
    range(h.insertion[i], "insertion");
    range(h.child_radius[i], "child_radius");
    check(h.child_radius[i].largest <= 1, "child_radius", h.child_radius[i].largest, "at most 1");
  }
  positive(h.tip_radius, "tip_radius");
  check(h.whorl >= 1 && h.whorl <= 64, "whorl", static_cast<double>(h.whorl), "from 1 to 64");
  positive(h.largest_branch, "largest_branch");
  positive(h.smallest_branch, "smallest_branch");
  range(h.slenderness, "slenderness");
  positive(h.crown_radius, "crown_radius");
  check(h.number_of_leaders >= 1 && h.number_of_leaders <= 8,
        "number_of_leaders",
        static_cast<double>(h.number_of_leaders),
        "from 1 to 8");
  share(h.fork, "fork");
  range(h.fork_angle, "fork_angle");
  check(h.number_of_stubs <= 1000,
        "number_of_stubs",
        static_cast<double>(h.number_of_stubs),
        "at most 1000");
  check(h.flattest_section > 0 && h.flattest_section <= 1,
        "flattest_section",
        h.flattest_section,
        "in (0, 1]");
}

/// Throws `Invalid_input` unless every value is in its range.
inline void check_habit(const Tree_habit& h)
{
  Habit_checks::axes(h);
  Habit_checks::branching(h);
}

} // namespace internal
} // namespace pcs

#endif // PCS_GENERATORS_TREE_HABIT_H
