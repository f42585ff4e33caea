// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Constraints of the nodes of a network by the handles.

#ifndef PCS_DEFORMATION_MODEL_NODE_CONSTRAINTS_H
#define PCS_DEFORMATION_MODEL_NODE_CONSTRAINTS_H

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

/// Constraint of a node: the number of its handle, or one of the two values below.
using Node_constraint = std::int32_t;
constexpr Node_constraint free_node = -1;
/// The node belongs to a component without handle and keeps its position.
constexpr Node_constraint unreached_node = -2;

/// The constraint of each node, and the softness of each handle.
struct Node_constraints
{
  std::vector<Node_constraint> handle_of_node;
  /// Per handle: 0 prescribes its nodes exactly; a positive value is the weight of the springs of
  /// its nodes, relative to the sum of the edge weights of a node. [-]
  std::vector<double> softness_weight;

  bool is_prescribed(std::size_t node) const
  {
    const Node_constraint h = handle_of_node[node];
    return h >= 0 && !(softness_weight[static_cast<std::size_t>(h)] > 0);
  }
  bool is_soft(std::size_t node) const
  {
    const Node_constraint h = handle_of_node[node];
    return h >= 0 && softness_weight[static_cast<std::size_t>(h)] > 0;
  }
  /// Returns the weight of the spring of a soft node; `degree` is the sum of its edge weights. A
  /// node without edges has only its spring.
  double soft_weight(std::size_t node, double degree) const
  {
    return softness_weight[static_cast<std::size_t>(handle_of_node[node])] *
           (degree > 0 ? degree : 1);
  }
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_NODE_CONSTRAINTS_H
