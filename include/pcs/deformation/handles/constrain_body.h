// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Constraints of a sampled body: which nodes the handles hold, and new nodes on their borders.

#ifndef PCS_DEFORMATION_HANDLES_CONSTRAIN_BODY_H
#define PCS_DEFORMATION_HANDLES_CONSTRAIN_BODY_H

#include <pcs/core/Deformation_report.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Border_finder.h>
#include <pcs/deformation/handles/Handle_set.h>
#include <pcs/deformation/handles/Site_constraints.h>
#include <pcs/deformation/handles/add_boundary_nodes.h>
#include <pcs/deformation/handles/anchor_free_components.h>
#include <pcs/deformation/handles/straighten_borders.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

/// The constraints of handles on a body.
struct Body_constraints
{
  Node_constraints of_samples; ///< at least one sample is held in each component with a handle
  Node_constraints of_nodes;   ///< of `network` if the body is sampled, otherwise of the samples
  Elastic_network network;     ///< the samples, with nodes on the borders of exact handles
  std::vector<Border_edge> border; ///< edges out of exact handles, if the body is sampled
};

/// Returns a function that gives the exact handle of a site, or a negative number.
inline auto exact_handles(const Handle_set& handles)
{
  return [&handles](std::size_t site) { return handles.exact_handle(site); };
}

namespace internal {

/// Holds the components in which all handles lack samples. In the network of the finest level,
/// nodes on borders hold these components.
template <class ConcurrencyTag, class HandleOfSite>
void anchor_samples(const Sampled_body<ConcurrencyTag>& body,
                    const HandleOfSite& handle_of_site,
                    Node_constraints& constraints)
{
  const auto component = [&](std::size_t s) {
    return body.component_of_site[body.site_of_sample[s]];
  };
  anchor_free_components(component, body.sample_of_site, handle_of_site, constraints);
}

/// Finds the borders of exact handles, and adds nodes there.
template <class ConcurrencyTag, class HandleOfSite>
void add_border_nodes(const Sampled_body<ConcurrencyTag>& body,
                      const Border_finder& finder,
                      const Handle_set& handles,
                      const HandleOfSite& handle_of_site,
                      Body_constraints& result)
{
  const auto position = [&](std::size_t site) { return body.rest_of_site(site); };
  if (handles.has_soft_handles())
    result.border = finder.find<ConcurrencyTag>(body.site_graph, [&](std::size_t site) {
      return handle_of_site(site) >= 0;
    });
  else // the same, without a look at each handle
    result.border = finder.find<ConcurrencyTag>(body.site_graph, [&](std::size_t site) {
      return handles.of_site(site) != free_node;
    });
  result.network =
      add_boundary_nodes(Boundary_input<HandleOfSite, decltype(position)>{body.network,
                                                                          body.weight_unit,
                                                                          result.border,
                                                                          body.sample_of_site,
                                                                          handle_of_site,
                                                                          position},
                         result.of_nodes);
}

} // namespace internal

/// Classifies the sites and finds the held nodes: samples of handles, nodes in components that
/// would otherwise be free and, if the body is sampled, nodes on the borders of exact handles.
template <class ConcurrencyTag>
Body_constraints constrain_body(const Sampled_body<ConcurrencyTag>& body,
                                const Border_finder& border_finder,
                                const Handle_set& handles,
                                Site_constraints& sites,
                                Deformation_report& report)
{
  const auto handle_of_site = exact_handles(handles);
  Body_constraints result;
  result.of_samples = result.of_nodes = sites.find(body, handles, report);
  internal::anchor_samples(body, handle_of_site, result.of_samples);
  if (body.is_sampled)
    internal::add_border_nodes(body, border_finder, handles, handle_of_site, result);
  return result;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_CONSTRAIN_BODY_H
