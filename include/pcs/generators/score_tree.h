// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// How far a tree is from the trees that grow by a habit.

#ifndef PCS_GENERATORS_SCORE_TREE_H
#define PCS_GENERATORS_SCORE_TREE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/habit/Habit_simulation.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/check_tree.h>
#include <pcs/generators/habit/describe_sample.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/parallel.h>

#include <CGAL/tags.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsGeneratorsRef
//! one property of a tree, compared with grown trees
struct Tree_deviation
{
  std::string name;     //!< as `order 1: length`
  double deviation = 0; //!< from the mean of the grown trees, in their standard deviations [-]
};

//! \ingroup PkgPcsGeneratorsRef
//! the result of `score_tree()`
struct Tree_score
{
  double distance = 0; //!< root mean square of all deviations; about 1 for a grown tree [-]
  double share = 0;    //!< of grown trees that are at least as far; small for an outlier [-]
  std::vector<Tree_deviation> deviations; //!< the largest first
};

namespace internal {

/// Deviations of descriptors from the mean of others, in their standard deviations.
class Descriptor_spread
{
public:
  using Descriptors = generators::habit::Descriptors;

  explicit Descriptor_spread(const std::vector<Descriptors>& grown) : m_grown(grown) {}

  /// Deviations of `d` from all grown trees but number `left_out`; `npos`: from all.
  std::vector<double> deviations(const Descriptors& d, std::size_t left_out = npos) const
  {
    constexpr double least_spread = 0.01; // relative; some properties hardly vary
    std::vector<double> result;
    for (std::size_t k = 0; k < d.size(); ++k) {
      double n = 0, sum = 0, squares = 0;
      for (std::size_t i = 0; i < m_grown.size(); ++i)
        if (i != left_out) {
          n += 1;
          sum += m_grown[i][k].second;
        }
      const double mean = sum / n;
      for (std::size_t i = 0; i < m_grown.size(); ++i)
        if (i != left_out)
          squares += std::pow(m_grown[i][k].second - mean, 2);
      const double spread = std::sqrt(squares / (n - 1)) + least_spread * std::abs(mean) + 1e-9;
      result.push_back((d[k].second - mean) / spread);
    }
    return result;
  }

  static double distance(const std::vector<double>& deviations)
  {
    double sum = 0;
    for (const double z : deviations)
      sum += z * z;
    return std::sqrt(sum / static_cast<double>(deviations.size()));
  }

private:
  const std::vector<Descriptors>& m_grown;
};

/// Scores a tree that was read.
template <class ConcurrencyTag>
Tree_score score_sample(const generators::habit::Tree_sample& sample,
                        const Tree_habit_fit& fit,
                        std::size_t number,
                        std::uint64_t seed)
{
  namespace habit = generators::habit;
  const habit::Measurement measurement = habit::measurement_of({&sample}, fit.smallest_radius);
  const Tree_habit of_height = habit_at_height(fit, sample.axes.front().length());
  check_habit(of_height);
  std::vector<habit::Descriptors> grown(number);
  for_each_index<ConcurrencyTag>(
      number,
      [&](std::size_t i) {
        grown[i] = habit::describe_sample(
            habit::grown_sample(of_height, measurement, Random_stream(seed, i).bits()));
      },
      1);
  const Descriptor_spread spread(grown);
  const habit::Descriptors own = habit::describe_sample(sample);
  const std::vector<double> deviations = spread.deviations(own);
  Tree_score score;
  score.distance = Descriptor_spread::distance(deviations);
  std::size_t farther = 1;
  for (std::size_t i = 0; i < number; ++i)
    if (Descriptor_spread::distance(spread.deviations(grown[i], i)) >= score.distance)
      ++farther;
  score.share = static_cast<double>(farther) / static_cast<double>(number + 1);
  for (std::size_t k = 0; k < own.size(); ++k)
    score.deviations.push_back({own[k].first, deviations[k]});
  std::stable_sort(score.deviations.begin(),
                   score.deviations.end(),
                   [](const Tree_deviation& a, const Tree_deviation& b) {
                     return std::abs(a.deviation) > std::abs(b.deviation);
                   });
  return score;
}

} // namespace internal

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief compares a tree with trees of its height that grow by a fitted habit.

  The trees are described by numbers, lengths, volumes, angles, proportions and straightness of
  branches by order, and by the crown. The grown trees have the errors of radii that the skeleton
  states, and the resolution of the fit. A tree that grew by the habit has a `Tree_score::share`
  that is uniform in (0, 1]; one of another species, a damaged or a badly measured tree has a small
  one.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
          `CGAL::Parallel_if_available_tag`
  \tparam Kernel a kernel of CGAL
  \tparam NamedParameters a sequence of named parameters
  \param tree a skeleton with branches, in the unit of the fit [L]
  \param fit a result of `fit_tree_habit()`
  \param np an optional sequence of named parameters, listed below
  \npbegin
    \np{number_of_simulations} grown trees; `share` is at least its inverse [count]
      \nptype integer, `20` or more
      \npdefault `100`
    \np{random_seed} seed of the grown trees
      \nptype integer
      \npdefault `0`
  \npend
  \throws pcs::Invalid_input as `fit_tree_habit()`, when the habit is invalid, or when the trunk is
          a hundred times as long as those of the habit, or as short
  \par Complexity
  Linear in the number of grown trees.
  \par Determinism
  Same bits for every number of threads and for the sequential tag.
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class Tree,
          class NamedParameters = parameters::Default_named_parameters>
Tree_score score_tree(const Tree& tree,
                      const Tree_habit_fit& fit,
                      const NamedParameters& np = parameters::default_values())
{
  namespace habit = generators::habit;
  namespace tags = internal_np;
  constexpr bool is_skeleton = internal::Is_tree_skeleton<Tree>::value;
  static_assert(is_skeleton, "pcs::score_tree(): `tree` must be a pcs::Tree_skeleton<Kernel>");
  internal::check_names<CGAL::internal_np::random_seed_t, tags::number_of_simulations_t>(np);
  constexpr bool is_number =
      internal::is_integer_parameter_v<NamedParameters, tags::number_of_simulations_t>;
  static_assert(is_number,
                "pcs::score_tree(): named parameter `number_of_simulations` must be an integer");
  Tree_score score;
  if constexpr (is_skeleton && is_number) {
    const std::size_t number =
        internal::check_count("pcs::score_tree()",
                              "number_of_simulations",
                              internal::choose(np, tags::number_of_simulations, 100),
                              20,
                              100'000);
    const std::uint64_t seed = internal::read_random_seed(np);
    const habit::Tree_sample sample =
        habit::checked_sample(tree, fit.smallest_radius, "pcs::score_tree(): the tree");
    internal::check_unit(sample.axes.front().length(), fit, "pcs::score_tree()");
    score = internal::score_sample<ConcurrencyTag>(sample, fit, number, seed);
  }
  return score;
}

} // namespace pcs

#endif // PCS_GENERATORS_SCORE_TREE_H
