// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Canonical order of trees, independent of the order of input.

#ifndef PCS_SHAPE_SPACE_FAMILY_CANONICAL_ORDER_H
#define PCS_SHAPE_SPACE_FAMILY_CANONICAL_ORDER_H

#include <pcs/shape_space/model/Rooted_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace pcs {
namespace shape_space {
namespace internal {

/// Returns the nodes in an order that does not depend on their numbers in the input.
inline std::vector<std::size_t> canonical_nodes(const Rooted_tree& tree)
{
  std::vector<std::size_t> order, stack{0};
  while (!stack.empty()) {
    order.push_back(stack.back());
    stack.pop_back();
    for (std::size_t c = tree.first_child[order.back()]; c < tree.first_child[order.back() + 1];
         ++c)
      stack.push_back(tree.children[c]);
  }
  return order;
}

/// Compares trees in a total order that does not depend on the order of input, except for equal
/// trees.
inline bool is_tree_before(const Rooted_tree& a, const Rooted_tree& b)
{
  if (a.weights[0] != b.weights[0])
    return a.weights[0] > b.weights[0];
  if (a.heights[0] != b.heights[0])
    return a.heights[0] > b.heights[0];
  if (a.size() != b.size())
    return a.size() > b.size();
  const std::vector<std::size_t> v = canonical_nodes(a), w = canonical_nodes(b);
  for (std::size_t k = 0; k < v.size(); ++k) {
    for (int i = 0; i < 3; ++i)
      if (a.points[v[k]][i] != b.points[w[k]][i])
        return a.points[v[k]][i] < b.points[w[k]][i];
    if (a.radii[v[k]] != b.radii[w[k]])
      return a.radii[v[k]] < b.radii[w[k]];
  }
  return false;
}

/// Returns the trees in a canonical order: first the tree most similar to all others in length,
/// size and number of nodes, then the others.
inline std::vector<std::size_t> canonical_order(const std::vector<const Rooted_tree*>& trees)
{
  std::vector<std::size_t> order(trees.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return is_tree_before(*trees[a], *trees[b]);
  });
  const auto descriptors = [&](std::size_t t) {
    return Vec3(std::log(trees[t]->weights[0] / trees[t]->heights[0]),
                std::log(trees[t]->heights[0]),
                std::log(static_cast<double>(trees[t]->size())));
  };
  std::size_t first = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < order.size(); ++i) {
    double sum = 0;
    for (const std::size_t u : order)
      sum += (descriptors(order[i]) - descriptors(u)).lpNorm<1>();
    if (sum < least * (1 - 1e-12)) {
      least = sum;
      first = i;
    }
  }
  if (order.empty())
    return order;
  std::rotate(order.begin(),
              order.begin() + static_cast<std::ptrdiff_t>(first),
              order.begin() + static_cast<std::ptrdiff_t>(first + 1));
  return order;
}

} // namespace internal

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_CANONICAL_ORDER_H
