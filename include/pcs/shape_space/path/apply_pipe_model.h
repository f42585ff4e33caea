// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Pipe model at forks of trees of a space.

#ifndef PCS_SHAPE_SPACE_PATH_APPLY_PIPE_MODEL_H
#define PCS_SHAPE_SPACE_PATH_APPLY_PIPE_MODEL_H

#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// Limits radii at forks by the pipe model: the powers of the radii of parent and children above a
/// fork sum to at most the power of the radius below it.
inline void apply_pipe_model(const Orl_layout& layout, double exponent, Orl_coordinates& x)
{
  std::vector<std::vector<std::size_t>> children(layout.branches.size());
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    if (layout.branches[b].parent != none)
      children[layout.branches[b].parent].push_back(b);
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    std::vector<std::size_t> order = children[b];
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t c) {
      return x.attachment[a] != x.attachment[c] ? x.attachment[a] < x.attachment[c] : a < c;
    });
    // from the base to the tip: radii above each node are scaled so that their powers sum to at
    // most the power below the node
    std::size_t next = 0;
    for (std::size_t k = 0; k < branch.number_of_edges; ++k) {
      const double before = k == 0 ? x.base_radius[b] : x.radius[branch.first_edge + k - 1];
      double& after = x.radius[branch.first_edge + k];
      after = std::min(after, before);
      const std::size_t begin = next;
      double taken = std::pow(after, exponent);
      while (next < order.size() && (x.attachment[order[next]] <= static_cast<double>(k + 1) ||
                                     k + 1 == branch.number_of_edges))
        taken += std::pow(x.base_radius[order[next++]], exponent);
      const double available = std::pow(before, exponent);
      if (next == begin || !(taken > available))
        continue;
      const double f = std::pow(available / taken, 1 / exponent);
      after *= f;
      for (std::size_t i = begin; i < next; ++i) {
        x.base_radius[order[i]] *= f;
        for (std::size_t j = 0; j < layout.branches[order[i]].number_of_edges; ++j)
          x.radius[layout.branches[order[i]].first_edge + j] *= f;
      }
    }
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PATH_APPLY_PIPE_MODEL_H
