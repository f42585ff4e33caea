// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Anchoring of components without constrained nodes to the handles in their regions.

#ifndef PCS_DEFORMATION_HANDLES_ANCHOR_FREE_COMPONENTS_H
#define PCS_DEFORMATION_HANDLES_ANCHOR_FREE_COMPONENTS_H

#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/model/Harmonic_system.h>

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Assigns nodes of components without constrained nodes to the handles that lie in the regions of
  these nodes. Otherwise the matrices would be singular. O(nodes), and O(finer nodes) if there are
  such components.

  \param component_of `component_of(node)`
  \param node_of_finer the node in whose region each finer node lies, or `no_sample`
  \param handle_of_finer `handle_of_finer(i)`: the handle that holds finer node `i`, negative if
      there is none
*/
template <class ComponentOf, class HandleOfFiner>
void anchor_free_components(const ComponentOf& component_of,
                            const std::vector<std::uint32_t>& node_of_finer,
                            const HandleOfFiner& handle_of_finer,
                            Node_constraints& constraints)
{
  auto& of_node = constraints.handle_of_node;
  std::set<std::uint32_t> held;
  for (std::size_t node = 0; node < of_node.size(); ++node)
    if (of_node[node] >= 0)
      held.insert(component_of(node));
  bool has_free_components = false;
  for (std::size_t node = 0; node < of_node.size() && !has_free_components; ++node)
    has_free_components = of_node[node] == free_node && held.count(component_of(node)) == 0;
  if (!has_free_components)
    return;
  for (std::size_t i = 0; i < node_of_finer.size(); ++i) {
    const std::uint32_t node = node_of_finer[i];
    if (node != no_sample && of_node[node] == free_node && handle_of_finer(i) >= 0 &&
        held.count(component_of(node)) == 0)
      of_node[node] = handle_of_finer(i);
  }
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_ANCHOR_FREE_COMPONENTS_H
