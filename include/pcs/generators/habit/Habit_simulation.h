// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Corrects the bias of an estimated habit, and finds intervals, by trees that grow by it.

#ifndef PCS_GENERATORS_HABIT_HABIT_SIMULATION_H
#define PCS_GENERATORS_HABIT_HABIT_SIMULATION_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/habit/Habit_parameters.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/estimate_habit.h>
#include <pcs/generators/habit/fit_range.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

/// What distinguishes a measured tree from a grown one: errors of radii, and the resolution.
struct Measurement
{
  double smallest_radius = 0;
  std::array<double, 3> error{}; ///< relative standard error of the radii, by order [-]
};

/// The errors that the skeletons state: medians over the branches of each order.
inline Measurement measurement_of(const Samples& trees, double smallest_radius)
{
  std::array<std::vector<double>, 3> errors;
  for (const Tree_sample* tree : trees)
    for (const Axis& a : tree->axes)
      errors[static_cast<std::size_t>(std::min(a.order, 2))].push_back(a.error);
  Measurement m;
  m.smallest_radius = smallest_radius;
  for (std::size_t i = 0; i < 3; ++i)
    m.error[i] = errors[i].empty() ? 0 : quantile(errors[i], 0.5);
  return m;
}

/// The names of random streams.
enum class Stream : std::uint64_t { growth = 11, error = 12, choice = 13, height = 14, place = 15 };

template <class... Keys>
std::uint64_t stream_seed(std::uint64_t seed, Stream stream, Keys... keys)
{
  return pcs::internal::Random_stream(seed, static_cast<std::uint64_t>(stream), keys...).bits();
}

/// Gives the radii of each branch a common relative error.
template <class Kernel>
void add_radius_errors(Tree_skeleton<Kernel>& tree,
                       const std::array<double, 3>& errors,
                       std::uint64_t seed)
{
  const auto& branches = tree[boost::graph_bundle].branches;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    auto& node = tree[v];
    const int order = std::min(branches[node.branch].order, 2);
    const double error = errors[static_cast<std::size_t>(order)];
    pcs::internal::Random_stream random(seed, node.branch);
    node.radius *= std::exp(error * random.normal());
    node.radius_error = error * node.radius;
  }
}

/// The kernel of trees that are grown here.
struct Double_kernel
{
  using FT = double;
  struct Vector_3
  {
    Vector_3(double x, double y, double z) : m_x(x), m_y(y), m_z(z) {}
    double x() const { return m_x; }
    double y() const { return m_y; }
    double z() const { return m_z; }

  private:
    double m_x, m_y, m_z;
  };
  using Point_3 = Vector_3;
};

/// Grows a tree and reads it as it would have been measured.
inline Tree_sample grown_sample(const Tree_habit& habit, const Measurement& m, std::uint64_t seed)
{
  Tree_skeleton<Double_kernel> tree;
  pcs::grow_tree(tree, habit, parameters::random_seed(stream_seed(seed, Stream::growth)));
  add_radius_errors(tree, m.error, stream_seed(seed, Stream::error));
  return read_sample<Double_kernel>(tree, m.smallest_radius);
}

/*
  Indirect inference (Gourieroux, Monfort, Renault 1993): the direct estimate A of grown trees is
  compared with their known habit. A parameter is changed until the median estimate of trees grown
  by it equals the estimate of the measured trees. The spread of the estimates gives its interval.
*/
template <class ConcurrencyTag>
class Habit_simulation
{
public:
  Habit_simulation(const Samples& trees,
                   const Measurement& measurement,
                   const Habit_allometry& allometry,
                   std::uint64_t seed,
                   std::size_t number_of_simulations)
    : m_measurement(measurement), m_seed(seed), m_number(number_of_simulations)
  {
    m_fit.allometry = allometry;
    for (const Tree_sample* tree : trees)
      m_heights.push_back(tree->axes.front().length());
  }

  /// Returns the corrected habit.
  Tree_habit corrected(const Habit_estimate& measured)
  {
    constexpr int number_of_rounds = 4;
    const Parameter_values wanted = transformed(measured.habit);
    Parameter_values now = wanted;
    Tree_habit habit = measured.habit;
    for (int round = 0; round < number_of_rounds; ++round) {
      const auto found = estimates(habit, number_of_corrections(), round + 1);
      for (std::size_t i = 0; i < number_of_parameters; ++i)
        if (is_corrected(i, measured)) {
          const double bias = quantile(column(found, i), 0.5) - wanted[i];
          if (round == 0)
            m_first_bias[i] = bias;
          const double most = largest_correction(i, measured);
          now[i] = std::clamp(now[i] - bias, wanted[i] - most, wanted[i] + most);
        }
      habit = restored(now, measured.habit);
      now = transformed(habit);
    }
    return habit;
  }

  /// Returns the values with standard errors and intervals.
  std::vector<Habit_value> values(const Tree_habit& habit, const Habit_estimate& measured)
  {
    const auto found = estimates(habit, m_number, 0);
    std::vector<Habit_value> result;
    for (std::size_t i = 0; i < number_of_parameters; ++i) {
      const Habit_parameter& p = habit_parameters()[i];
      Habit_value value;
      value.name = p.name;
      value.unit = p.unit;
      value.value = value.least = value.largest = p.read(habit);
      value.number_of_samples = measured.number[i];
      if (measured.number[i] > 0) {
        const std::vector<double> c = column(found, i);
        const double here = p.transformed(value.value),
                     wanted = p.transformed(p.read(measured.habit));
        const double spread = (quantile(c, 0.84) - quantile(c, 0.16)) / 2;
        value.standard_error =
            p.scale == Scale::linear ? spread : value.value * std::expm1(std::min(spread, 5.0));
        const double step = step_error(value.name, habit);
        const double widening = correction_error() * stretch(i, wanted - here, spread);
        value.least = p.restored(here - widening * (quantile(c, 0.975) - wanted)) - step;
        value.largest = p.restored(here - widening * (quantile(c, 0.025) - wanted)) + step;
        const std::size_t row = tropism_row(i);
        const double margin = row < 3 ? 1.96 * measured.tropism_error[row] : 0;
        value.least = p.bounded(std::min(value.least, value.value - margin));
        value.largest = p.bounded(std::max(value.largest, value.value + margin));
      }
      result.push_back(value);
    }
    return result;
  }

private:
  /// Branches begin at nodes, which bounds the accuracy of their places.
  static double step_error(const std::string& name, const Tree_habit& habit)
  {
    const double step = habit.largest_step / habit.height;
    return name == "fork" ? step : name == "bare[0]" ? step / 2 : 0;
  }

  std::size_t number_of_corrections() const { return m_number / 4 + 1; }

  /// The factor of intervals by which the median of few simulations adds to the error; the variance
  /// of a median is pi / 2 times that of a mean.
  double correction_error() const
  {
    return std::sqrt(1 + pcs::internal::pi / 2 / static_cast<double>(number_of_corrections()));
  }

  /// The change of a parameter that changes its estimate by 1, from the first bias and the whole
  /// `correction`; 1 where the bias is small against the `spread` of the estimates.
  double stretch(std::size_t i, double correction, double spread) const
  {
    constexpr double most = 2.5;
    const double bias = std::abs(m_first_bias[i]);
    return bias > spread / 2 ? std::clamp(std::abs(correction) / bias, 1.0, most) : 1;
  }

  /// Row of a tropism parameter, or 3.
  static std::size_t tropism_row(std::size_t i)
  {
    for (std::size_t row = 0; row < 3; ++row)
      if (habit_parameters()[i].name == "tropism[" + std::to_string(row) + "]")
        return row;
    return 3;
  }

  /// Bounds the correction where few data determine a value: the estimate of the tropism of a
  /// nearly vertical trunk hardly depends on the true value.
  static double largest_correction(std::size_t i, const Habit_estimate& measured)
  {
    constexpr double errors = 4, factor = 1;
    const std::size_t row = tropism_row(i);
    return row < 3 ? errors * measured.tropism_error[row] : factor;
  }

  /// The height is exact. Bends and tropism of the trunk compensate each other, so that only the
  /// bends are corrected; the tropism follows from the tilt of the trunks.
  static bool is_corrected(std::size_t i, const Habit_estimate& measured)
  {
    return measured.number[i] > 0 && i > 0 && tropism_row(i) != 0;
  }

  static std::vector<double> column(const std::vector<Parameter_values>& rows, std::size_t i)
  {
    std::vector<double> result;
    for (const Parameter_values& row : rows)
      result.push_back(row[i]);
    return result;
  }

  /// Estimates of `number` sets of trees that grow by `habit`. Every set has the heights of the
  /// measured trees; sets of several trees are drawn from the same grown ones.
  std::vector<Parameter_values> estimates(const Tree_habit& habit, std::size_t number, int round)
  {
    constexpr std::size_t fewest_per_height = 8;
    const std::size_t n = m_heights.size();
    const std::size_t per_height =
        n == 1 ? number : std::max(fewest_per_height, (number + n - 1) / n);
    m_fit.habit = habit;
    std::vector<Tree_sample> grown(n * per_height);
    pcs::internal::for_each_index<ConcurrencyTag>(
        grown.size(),
        [&](std::size_t i) {
          const double height = n == 1 ? habit.height : m_heights[i % n];
          // the same seeds in all rounds: their differences are due to the parameters
          const std::uint64_t seed = pcs::internal::Random_stream(m_seed, i, round > 0).bits();
          grown[i] = grown_sample(habit_at_height(m_fit, height), m_measurement, seed);
          grown[i].size = height / habit.height;
        },
        1);
    std::vector<Parameter_values> result(number);
    pcs::internal::for_each_index<ConcurrencyTag>(
        number,
        [&](std::size_t r) {
          pcs::internal::Random_stream random(m_seed, static_cast<int>(Stream::choice), r);
          Samples set;
          for (std::size_t j = 0; j < n; ++j) {
            const std::size_t k = n == 1 ? r : random.bits() % per_height;
            set.push_back(&grown[k * n + j]);
          }
          result[r] = transformed(estimate_habit(set, habit, m_fit.allometry, false).habit);
        },
        1);
    return result;
  }

  Measurement m_measurement;
  Tree_habit_fit m_fit; // for its allometry
  std::uint64_t m_seed;
  std::size_t m_number;
  std::vector<double> m_heights;
  Parameter_values m_first_bias{};
};

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_HABIT_SIMULATION_H
