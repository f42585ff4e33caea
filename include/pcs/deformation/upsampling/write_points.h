// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writing of all points that a deformation may move.

#ifndef PCS_DEFORMATION_UPSAMPLING_WRITE_POINTS_H
#define PCS_DEFORMATION_UPSAMPLING_WRITE_POINTS_H

#include <pcs/deformation/model/Node_constraints.h>
#include <pcs/deformation/upsampling/Moved_point_writer.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/parallel.h>

#include <cstddef>

namespace pcs {
namespace deformation {

/*!
  Writes points to `output`, an `Output` of `Moved_point_writer`, concurrently. Points of a sampled
  body are blended from the maps of the samples; otherwise each point is a sample, with its own map.
  In the rest shape, all points get the bits of their positions at rest.
*/
template <bool HasGradients, class ConcurrencyTag, class Output>
void write_points(const Moved_points<ConcurrencyTag>& moved, Output& output)
{
  const pcs::internal::Stage_timer timer(moved.seconds);
  const Sampled_body<ConcurrencyTag>& body = moved.body;
  const Moved_point_writer<ConcurrencyTag, Output> writer(moved, output);
  if (moved.is_at_rest) {
    pcs::internal::for_each_index<ConcurrencyTag>(
        body.number_of_points(),
        [&](std::size_t place) { writer.write_unmoved(place); },
        256);
    return;
  }
  if (body.is_sampled) {
    moved.upsampling.template apply<ConcurrencyTag, HasGradients>(
        {body.rest_points, body.network.rest, moved.maps},
        body.frame,
        moved.motions,
        writer);
    return;
  }
  pcs::internal::for_each_index<ConcurrencyTag>(body.number_of_points(), [&](std::size_t place) {
    const std::size_t site = body.site_of_place[place];
    if (moved.sites[site] == free_node)
      writer.write_mapped(place, moved.maps[site]);
    else
      writer.write_other(place);
  });
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_WRITE_POINTS_H
