// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The part of a deformation that depends on the points only: order, neighbours, samples, links.

#ifndef PCS_DEFORMATION_BODY_SAMPLED_BODY_H
#define PCS_DEFORMATION_BODY_SAMPLED_BODY_H

#include <pcs/core/Deformation_options.h>
#include <pcs/core/Deformation_report.h>
#include <pcs/deformation/body/Sample_links.h>
#include <pcs/deformation/handles/Border_finder.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/upsampling/Upsampling.h>
#include <pcs/internal/progress.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/detach_outliers.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsDeformationRef
//! samples on which the non-linear problem is solved, unless the caller says otherwise [count]
constexpr std::size_t default_number_of_samples = 2000;
//! \ingroup PkgPcsDeformationRef
//! nearest neighbours that a point is linked to; the dissertation's 5 to 6 [count]
constexpr std::size_t default_number_of_neighbors = 6;
//! \ingroup PkgPcsDeformationRef
//! nearest samples that move a point [count]
constexpr std::size_t default_number_of_sample_neighbors = 6;

namespace deformation {

struct Sampling_options
{
  std::size_t number_of_samples = default_number_of_samples;
  std::size_t number_of_neighbors = default_number_of_neighbors;
  std::size_t number_of_sample_neighbors = default_number_of_sample_neighbors;
  Sample_search sample_search = Sample_search::regions;
  Sample_weights sample_weights = Sample_weights::compact;
  bool do_preserve_volume = true;
};

/// From the caller's coordinates to ours and back: the middle of the points, and a power of two,
/// which loses no bits.
struct Local_frame
{
  Vec3 origin = Vec3::Zero();
  double unit = 1; ///< length of one of our units [L]

  Vec3 to_local(const Vec3& p) const { return (p - origin) / unit; }
  Vec3 to_world(const Vec3& p) const { return p * unit + origin; }
};

/*!
  Points are numbered three ways. An *input* index is the caller's. A *site* stands for all points
  at the same coordinates, in spatial order; graphs and components are over sites. A *place* is the
  position in the order in which points are upsampled: the spatial order, all points included, or
  the caller's where that is as coherent.
*/
template <class ConcurrencyTag>
struct Sampled_body
{
  Sampling_options options;
  Local_frame frame;
  std::vector<std::uint32_t> input_of_place;
  bool is_in_callers_order = false; ///< whether `input_of_place[i]` is `i`
  std::vector<std::uint32_t> site_of_place;
  std::vector<std::uint32_t>
      place_of_site; ///< the first one; empty if every site's place has its number
  std::vector<std::uint32_t> site_of_input;
  std::vector<std::uint32_t> component_of_site;
  std::vector<std::uint32_t> component_size; ///< in points
  std::vector<std::uint32_t> site_of_sample;
  std::vector<std::uint32_t>
      sample_of_site; ///< nearest along the surface; `no_sample` where there is none
  neighborhood::Proximity_graph
      site_graph;                       ///< kept for the borders of handles; empty if not sampled
  Border_finder border_finder;          ///< of `site_graph`
  Elastic_network network;              ///< over the samples
  double weight_unit = 1;               ///< see `sample_graph()`
  Upsampling upsampling;                ///< over the places
  std::size_t number_of_short_cuts = 0; ///< links dropped between sheets
  bool has_fragments = false;           ///< whether there are sites without a sample
  std::vector<neighborhood::Outlier> outliers; ///< sites that hang on one other
  bool is_sampled = true;                      ///< whether there are fewer samples than sites

  std::size_t number_of_points() const { return input_of_place.size(); }
  std::size_t number_of_sites() const { return component_of_site.size(); }
  std::size_t number_of_components() const { return component_size.size(); }
  std::size_t first_place(std::size_t site) const
  {
    return place_of_site.empty() ? site : place_of_site[site];
  }
  Vec3 rest_of_site(std::size_t site) const { return upsampling.rest(first_place(site)); }

  /// Builds everything from finite points in the caller's coordinates. Returns `false` if
  /// cancelled.
  bool build(std::vector<Vec3> points,
             const Sampling_options& sampling,
             Deformation_report::Seconds& seconds,
             pcs::internal::Progress& progress);

private:
  /// Coordinate by coordinate: near the cloud, wherever a few outliers are.
  static Vec3 median_point(const std::vector<Vec3>& points);
  void to_local(std::vector<Vec3>& points);
  /// Numbers sites and places.
  void order_points(const std::vector<Vec3>& points, std::vector<Vec3>& sites);
  void find_components(const neighborhood::Proximity_graph& graph);
  /// Outliers are no samples: nothing but themselves would follow them.
  void choose_samples(const std::vector<Vec3>& sites);
  void sample(std::vector<Vec3> sites,
              neighborhood::Proximity_graph graph,
              pcs::internal::Progress& progress);
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_SAMPLED_BODY_H
