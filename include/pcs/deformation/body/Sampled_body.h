// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The part of a deformation that depends on the points only: order, neighbours, samples, links.

#ifndef PCS_DEFORMATION_BODY_SAMPLED_BODY_H
#define PCS_DEFORMATION_BODY_SAMPLED_BODY_H

#include <pcs/core/Deformation_report.h>
#include <pcs/deformation/body/Sample_links.h>
#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Local_frame.h>
#include <pcs/deformation/model/Point_blocks.h>
#include <pcs/deformation/model/Sampling_options.h>
#include <pcs/internal/progress.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/detach_outliers.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {

namespace deformation {

/*!
  The points, their neighbourhood graph and their samples. Points are numbered in three orders. An
  *input* index is an index in the caller's order. A *site* represents all points with the same
  coordinates. Sites are in spatial order; they are the vertices of all graphs and components. An
  *upsampling index* (`place`) is an index in the order in which points are upsampled: the spatial
  order of all points, or the caller's order if it is coherent enough.
*/
template <class ConcurrencyTag>
struct Sampled_body
{
  Sampling_options options;
  Local_frame frame;
  std::vector<std::uint32_t> input_of_place;
  bool is_in_callers_order = false; ///< whether `input_of_place[i]` is `i`
  std::vector<std::uint32_t> site_of_place;
  /// The first upsampling index of each site; empty if both numberings are equal.
  std::vector<std::uint32_t> place_of_site;
  std::vector<std::uint32_t> site_of_input;
  std::vector<std::uint32_t> component_of_site;
  std::vector<std::uint32_t> component_size; ///< in points
  std::vector<std::uint32_t> site_of_sample;
  /// The nearest sample along the surface; `no_sample` if a component has none.
  std::vector<std::uint32_t> sample_of_site;
  /// The graph of the sites, kept for the borders of handles; empty if all sites are samples.
  neighborhood::Proximity_graph site_graph;
  /// Its first nodes are the samples; without sampling, more may follow (`straighten_borders()`).
  Elastic_network network;
  double weight_unit = 1; ///< see `sample_graph()`
  /// The points at rest, by upsampling index. Without sampling, it has positions only if points at
  /// the same position were moved apart before `accept()`; see `rest_of_place()`.
  Point_blocks rest_points;
  Sample_links links_of_site;                  ///< kept until the upsampling is built from them
  std::size_t number_of_short_cuts = 0;        ///< links removed between sheets
  bool has_fragments = false;                  ///< whether there are sites without a sample
  std::vector<neighborhood::Outlier> outliers; ///< sites attached to one other site
  bool is_sampled = true;                      ///< whether there are fewer samples than sites
  Sample_choice sample_choice = Sample_choice::requested; ///< why there are that many samples

  std::size_t number_of_points() const { return input_of_place.size(); }
  std::size_t number_of_sites() const { return component_of_site.size(); }
  std::size_t number_of_samples() const { return site_of_sample.size(); }
  std::size_t number_of_components() const { return component_size.size(); }
  std::size_t first_place(std::size_t site) const
  {
    return place_of_site.empty() ? site : place_of_site[site];
  }
  /// Returns the upsampling index of a point of the caller. O(number of points at its position).
  std::size_t place_of_input(std::size_t i) const
  {
    if (is_in_callers_order)
      return i;
    std::size_t place = first_place(site_of_input[i]); // points of a site are consecutive
    while (input_of_place[place] != i)
      ++place;
    return place;
  }
  /// Returns a position at rest by upsampling index, in local coordinates.
  Vec3 rest_of_place(std::size_t place) const
  {
    return rest_points.has_positions() ? rest_points.position(place)
                                       : network.rest[site_of_place[place]];
  }
  Vec3 rest_of_site(std::size_t site) const
  {
    return rest_points.has_positions() ? rest_points.position(first_place(site))
                                       : network.rest[site];
  }

  std::vector<std::uint32_t> component_of_sample() const;

  /// Builds everything from finite points in the caller's coordinates. Returns `false` if
  /// cancelled.
  bool build(std::vector<Vec3> points,
             const Sampling_options& sampling,
             Deformation_report::Seconds& seconds,
             pcs::internal::Progress& progress);

private:
  using Graph = neighborhood::Proximity_graph;

  // ---- neighbours
  bool find_neighbors(std::vector<Vec3> points,
                      std::vector<Vec3>& sites,
                      Graph& graph,
                      pcs::internal::Progress& progress);
  /// Returns the median of each coordinate: a point near the cloud, robust against outliers.
  static Vec3 median_point(const std::vector<Vec3>& points);
  /// Returns the diameter of the bounding box [L]. Throws `Invalid_input` if all points coincide or
  /// if squares of the diameter are not representable.
  static double checked_extent(const std::vector<Vec3>& points);
  void to_local(std::vector<Vec3>& points);
  /// Numbers the sites and the upsampling order.
  void order_points(const std::vector<Vec3>& points, std::vector<Vec3>& sites);
  void number_places(const std::vector<Vec3>& points, std::size_t number_of_sites);
  void find_components(const Graph& graph);

  // ---- samples
  /// Determines the number of samples if none is requested.
  void choose_number_of_samples(std::size_t number_of_sites);
  bool sample(const std::vector<Vec3>& sites, Graph graph, pcs::internal::Progress& progress);
  /// Chooses samples among the sites that are not outliers. A sample at an outlier would move only
  /// the outlier.
  void choose_samples(const std::vector<Vec3>& sites);
  std::vector<std::uint32_t> sites_without_outliers() const;
  void choose_samples_without_outliers(const std::vector<Vec3>& sites);
  Sample_links link_sites(const std::vector<Vec3>& sites,
                          const Graph& graph,
                          const Sample_regions& regions) const;
  /// Replaces the graph of the samples, weighted by the borders of their regions, by the graph of
  /// their Voronoi cells, with which bends are accurate however irregular the samples are. The sum
  /// of the weights, to which `weight_unit` refers, is unchanged.
  void weigh_by_cells(const std::vector<Vec3>& sites, const pcs::internal::Go_on& go_on);
  /// Builds the graph of the samples, and the links of the sites to them.
  bool link_samples(const std::vector<Vec3>& sites, Graph graph, pcs::internal::Progress& progress);
  /// Makes every site a sample. Returns `false` if cancelled.
  bool
  take_all_sites(const std::vector<Vec3>& sites, Graph graph, pcs::internal::Progress& progress);
  void link_interior(const std::vector<std::uint32_t>& component);
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_SAMPLED_BODY_H
