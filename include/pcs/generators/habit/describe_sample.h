// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Descriptors of a tree by which it is compared with grown trees.

#ifndef PCS_GENERATORS_HABIT_DESCRIBE_SAMPLE_H
#define PCS_GENERATORS_HABIT_DESCRIBE_SAMPLE_H

#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/fit_range.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

using Descriptors = std::vector<std::pair<std::string, double>>;

/// Means and sums over the axes of one order.
struct Order_sums
{
  double number = 0, length = 0, volume = 0, insertion = 0, ratio = 0, slenderness = 0,
         straightness = 0, rise = 0;

  void add(const Axis& a)
  {
    const Vector3 chord = a.points.back() - a.points.front();
    number += 1;
    length += a.length();
    for (std::size_t i = 1; i < a.at.size(); ++i)
      volume += a.radius[i] * a.radius[i - 1] * (a.at[i] - a.at[i - 1]);
    straightness += chord.norm() / a.length();
    rise += chord.z() / a.length();
    slenderness += std::log(a.length() / a.base_radius());
    if (a.parent == npos)
      return;
    insertion += a.insertion;
    ratio += std::log(a.base_radius() / a.place_radius);
  }
};

/// Ratios to the height, logarithms of numbers and sums, and means. The set of descriptors is the
/// same for all trees; orders from the fourth on are taken together.
inline Descriptors describe_sample(const Tree_sample& tree)
{
  constexpr std::size_t number_of_orders = 4;
  std::array<Order_sums, number_of_orders> orders;
  std::vector<double> reach, heights;
  const Axis& trunk = tree.axes.front();
  const double height = trunk.length();
  for (const Axis& a : tree.axes) {
    orders[std::min<std::size_t>(static_cast<std::size_t>(a.order), number_of_orders - 1)].add(a);
    const Vector3 tip = (a.points.back() - trunk.points.front()) / height;
    reach.push_back(std::hypot(tip.x(), tip.y()));
    heights.push_back(tip.z());
  }
  Descriptors d = {{"trunk: radius at the base", std::log(trunk.base_radius() / height)},
                   {"trunk: volume", std::log(orders[0].volume / std::pow(height, 3))},
                   {"trunk: straightness", orders[0].straightness},
                   {"crown: reach", quantile(reach, 0.9)},
                   {"crown: median height of tips", quantile(heights, 0.5)},
                   {"crown: lowest tips", quantile(heights, 0.05)}};
  for (std::size_t i = 1; i < number_of_orders; ++i) {
    const Order_sums& o = orders[i];
    const double n = std::max(1.0, o.number);
    const std::string name = "order " + std::to_string(i) + ": ";
    d.emplace_back(name + "number", std::log1p(o.number));
    d.emplace_back(name + "length", std::log1p(o.length / height));
    d.emplace_back(name + "volume", std::log1p(1e6 * o.volume / std::pow(height, 3)));
    d.emplace_back(name + "insertion", o.insertion / n);
    d.emplace_back(name + "ratio of radii", o.ratio / n);
    d.emplace_back(name + "slenderness", o.slenderness / n);
    d.emplace_back(name + "straightness", o.straightness / n);
    d.emplace_back(name + "rise", o.rise / n);
  }
  return d;
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_DESCRIBE_SAMPLE_H
