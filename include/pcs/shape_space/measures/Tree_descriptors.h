// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Shape descriptors of a tree: length, height, crown width, branch counts and angles by order.

#ifndef PCS_SHAPE_SPACE_MEASURES_TREE_DESCRIPTORS_H
#define PCS_SHAPE_SPACE_MEASURES_TREE_DESCRIPTORS_H

#include <pcs/internal/constants.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace shape_space {

struct Tree_descriptors
{
  double length = 0;      ///< of all branches [L]
  double height = 0;      ///< extent along the direction of growth [L]
  double crown_width = 0; ///< mean extent across this direction [L]
  double depth = 0;       ///< extent of the tree below the root [L]
  double lean =
      0; ///< distance of the centroid of branches from the root, across the direction of growth [L]
  std::vector<std::size_t> number_of_branches; ///< by order, the trunk first [count]
  std::vector<double>
      mean_angle; ///< between branches and their parents at the base, by order [rad]
  std::vector<double> angle_deviation; ///< standard deviation of this angle [rad]

  std::size_t total_number_of_branches() const
  {
    std::size_t sum = 0;
    for (const std::size_t n : number_of_branches)
      sum += n;
    return sum;
  }
};

/// Returns the vector from the root to the centroid of all branches, an estimate of the direction
/// of growth; not normalised. [L]
inline Vec3
growth_direction(const Orl_layout& layout, const Orl_coordinates& x, const Orl_geometry& geometry)
{
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j) {
      const double length = x.length[layout.branches[b].first_edge + j];
      const std::size_t v = layout.first_node(b) + j;
      sum += length * (0.5 * (geometry.node[v] + geometry.node[v + 1]) - x.root);
      total += length;
    }
  return total > 0 ? Vec3(sum / total) : Vec3(Vec3::UnitZ());
}

/// Computes the descriptors; `up` is of unit length. Branches without length and their subtrees are
/// ignored.
inline Tree_descriptors measure(const Orl_layout& layout,
                                const Orl_coordinates& x,
                                const Orl_geometry& geometry,
                                const Vec3& up)
{
  constexpr double pi = pcs::internal::pi;
  constexpr std::size_t number_of_sides = 18;
  Tree_descriptors result;
  std::vector<Vec3> sides;
  const Vec3 side = up.unitOrthogonal(), other = up.cross(side);
  for (std::size_t i = 0; i < number_of_sides; ++i) {
    const double angle = pi * static_cast<double>(i) / number_of_sides;
    sides.push_back(std::cos(angle) * side + std::sin(angle) * other);
  }
  sides.push_back(up);
  std::vector<double> low(sides.size(), std::numeric_limits<double>::infinity()),
      high(sides.size());
  std::fill(high.begin(), high.end(), -std::numeric_limits<double>::infinity());
  const std::vector<std::size_t> order = orders_of_branches(layout, x);
  std::vector<double> squares;
  Vec3 moment = Vec3::Zero();
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    if (order[b] == none)
      continue;
    if (order[b] >= result.number_of_branches.size()) {
      result.number_of_branches.resize(order[b] + 1, 0);
      result.mean_angle.resize(order[b] + 1, 0);
      squares.resize(order[b] + 1, 0);
    }
    ++result.number_of_branches[order[b]];
    for (std::size_t j = 0; j < branch.number_of_edges; ++j) {
      result.length += x.length[branch.first_edge + j];
      const std::size_t v = layout.first_node(b) + j;
      moment += 0.5 * x.length[branch.first_edge + j] *
                (geometry.node[v] + geometry.node[v + 1] - 2 * geometry.node[0]);
    }
    for (std::size_t j = 0; j <= branch.number_of_edges; ++j)
      for (std::size_t i = 0; i < sides.size(); ++i) {
        const double h = sides[i].dot(geometry.node[layout.first_node(b) + j]);
        low[i] = std::min(low[i], h);
        high[i] = std::max(high[i], h);
      }
    if (order[b] > 0) {
      const Vec3 parent = geometry.frame[branch.reference_edge] * Vec3::UnitZ();
      const Vec3 own = geometry.frame[branch.first_edge] * Vec3::UnitZ();
      const double angle = std::atan2(parent.cross(own).norm(), parent.dot(own));
      result.mean_angle[order[b]] += angle;
      squares[order[b]] += angle * angle;
    }
  }
  for (std::size_t k = 0; k < result.mean_angle.size(); ++k) {
    const auto n = static_cast<double>(result.number_of_branches[k]);
    result.mean_angle[k] /= n;
    result.angle_deviation.push_back(
        std::sqrt(std::max(0.0, squares[k] / n - result.mean_angle[k] * result.mean_angle[k])));
  }
  if (result.length > 0)
    result.lean = (moment - moment.dot(up) * up).norm() / result.length;
  result.height = high.back() - low.back();
  result.depth = up.dot(geometry.node[0]) - low.back();
  for (std::size_t i = 0; i < number_of_sides; ++i)
    result.crown_width += (high[i] - low[i]) / number_of_sides;
  return result;
}

/// Relative tolerance of descriptors, required if all trees have the same height. [-]
constexpr double figure_tolerance = 1e-4;
/// Tolerance of the lean, as a fraction of the crown width. [-]
constexpr double upright_tolerance = 0.05;

/// Returns the sum of the relative distances of the descriptors from their ranges among `others`
/// [-]. Descriptors by order are included if `has_orders`, for orders that all others have. The
/// lean and the depth below the root may be smaller than in all others.
inline double range_violation(const Tree_descriptors& x,
                              const std::vector<Tree_descriptors>& others,
                              bool has_orders = true)
{
  double sum = 0;
  const auto add = [&](const auto& get, bool may_be_less = false, double least = 1e-9) {
    double low = std::numeric_limits<double>::infinity(), high = 0;
    for (const Tree_descriptors& other : others) {
      low = std::min(low, get(other));
      high = std::max(high, get(other));
    }
    const double value = get(x);
    if (value < low * (1 - figure_tolerance) && !may_be_less)
      sum += (low - value) / low;
    else if (value > high * (1 + figure_tolerance) + least)
      sum += (value - high) / std::max(high, least);
  };
  const double rounding = 1e-9 * x.length;
  add([](const Tree_descriptors& f) { return f.length; }, false, rounding);
  add([](const Tree_descriptors& f) { return f.height; }, false, rounding);
  add([](const Tree_descriptors& f) { return f.crown_width; }, false, rounding);
  add([](const Tree_descriptors& f) { return f.depth; }, true, figure_tolerance * x.length);
  add([](const Tree_descriptors& f) { return f.lean; }, true, upright_tolerance * x.crown_width);
  add([](const Tree_descriptors& f) { return static_cast<double>(f.total_number_of_branches()); });
  std::size_t orders = std::numeric_limits<std::size_t>::max();
  for (const Tree_descriptors& other : others)
    orders = std::min(orders, other.mean_angle.size());
  for (std::size_t k = 1; has_orders && k < orders; ++k) {
    // a missing order has no branches and no angles
    add([&](const Tree_descriptors& f) {
      return k < f.number_of_branches.size() ? static_cast<double>(f.number_of_branches[k]) : 0.0;
    });
    if (k >= x.mean_angle.size())
      continue;
    add([&](const Tree_descriptors& f) { return f.mean_angle[k]; });
    add([&](const Tree_descriptors& f) { return f.angle_deviation[k]; });
  }
  return sum;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MEASURES_TREE_DESCRIPTORS_H
