// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The part of a deformation that depends on the points only: order, neighbours, samples, links to the samples.

#ifndef PCS_DEFORMATION_SAMPLED_BODY_H
#define PCS_DEFORMATION_SAMPLED_BODY_H

#include <pcs/core/Deformation_report.h>
#include <pcs/core/errors.h>
#include <pcs/deformation/Border_finder.h>
#include <pcs/deformation/Elastic_network.h>
#include <pcs/deformation/Harmonic_system.h>
#include <pcs/deformation/Sample_links.h>
#include <pcs/deformation/Sample_regions.h>
#include <pcs/deformation/Upsampling.h>
#include <pcs/deformation/coherent_order.h>
#include <pcs/deformation/interior_links.h>
#include <pcs/deformation/octree_samples.h>
#include <pcs/deformation/voronoi_graph.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/internal/text.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/detach_outliers.h>
#include <pcs/neighborhood/drop_short_cuts.h>
#include <pcs/neighborhood/spatial_order.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
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

/// From the caller's coordinates to ours and back: the middle of the points, and a power of two, which loses no bits.
struct Local_frame
{
  Vec3 origin = Vec3::Zero();
  double unit = 1; ///< length of one of our units [L]

  Vec3 to_local(const Vec3& p) const { return (p - origin) / unit; }
  Vec3 to_world(const Vec3& p) const { return p * unit + origin; }
};

/*!
  Points are numbered three ways. An *input* index is the caller's. A *site* stands for all points at the same
  coordinates, in spatial order; graphs and components are over sites. A *place* is the position in the order in which
  points are upsampled: the spatial order, all points included, or the caller's where that is as coherent.
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

  /// Builds everything from finite points in the caller's coordinates. Returns `false` if cancelled.
  bool build(std::vector<Vec3> points,
             const Sampling_options& sampling,
             Deformation_report::Seconds& seconds,
             pcs::internal::Progress& progress)
  {
    options = sampling;
    pcs::internal::Stopwatch watch;
    to_local(points);
    std::vector<Vec3> sites;
    order_points(points, sites);
    points = std::vector<Vec3>();
    if (!progress(0.2))
      return false;
    neighborhood::Proximity_graph graph =
        neighborhood::nearest_neighbor_graph<ConcurrencyTag>(sites, options.number_of_neighbors);
    number_of_short_cuts = neighborhood::drop_short_cuts<ConcurrencyTag>(sites, graph);
    outliers = neighborhood::detach_outliers<ConcurrencyTag>(sites, graph);
    find_components(graph);
    seconds.neighbors = watch.lap();
    if (!progress(0.6))
      return false;
    sample(std::move(sites), std::move(graph), progress);
    seconds.sampling = watch.lap();
    return progress(1.0);
  }

private:
  /// Coordinate by coordinate: near the cloud, wherever a few outliers are.
  static Vec3 median_point(const std::vector<Vec3>& points)
  {
    Vec3 median;
    std::vector<double> values(points.size());
    for (int c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < points.size(); ++i)
        values[i] = points[i][c];
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      median[c] = *middle;
    }
    return median;
  }

  void to_local(std::vector<Vec3>& points)
  {
    Vec3 low = points.front(), high = low;
    for (const Vec3& p : points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const double extent = (0.5 * high - 0.5 * low).norm() * 2;
    if (!(extent > 0))
      throw Invalid_input("pcs deformation: all " + std::to_string(points.size()) +
                          " points lie at one place; there is nothing to deform");
    // Squares and their products must stay representable.
    if (!(extent > 1e-100 && extent < 1e100))
      throw Invalid_input("pcs deformation: the points extend over " +
                          pcs::internal::to_text(extent) +
                          "; extents must lie between 1e-100 and 1e100");
    frame.origin = median_point(points);
    frame.unit = std::exp2(std::floor(std::log2(extent)));
    pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
      points[i] = frame.to_local(points[i]);
    });
  }

  /// Numbers sites and places.
  void order_points(const std::vector<Vec3>& points, std::vector<Vec3>& sites)
  {
    const std::size_t n = points.size();
    input_of_place = neighborhood::spatial_order<ConcurrencyTag>(points);
    site_of_input.resize(n);
    sites.reserve(n);
    for (const std::uint32_t i : input_of_place) {
      if (sites.empty() || sites.back() != points[i])
        sites.push_back(points[i]);
      site_of_input[i] = static_cast<std::uint32_t>(sites.size() - 1);
    }
    is_in_callers_order = is_coherent_order(points, input_of_place);
    if (is_in_callers_order)
      std::iota(input_of_place.begin(), input_of_place.end(), 0u);
    site_of_place.resize(n);
    for (std::size_t place = 0; place < n; ++place)
      site_of_place[place] = site_of_input[input_of_place[place]];
    if (sites.size() == n && !is_in_callers_order)
      return;
    place_of_site.resize(sites.size());
    for (std::size_t place = n; place-- > 0;)
      place_of_site[site_of_place[place]] = static_cast<std::uint32_t>(place);
  }

  void find_components(const neighborhood::Proximity_graph& graph)
  {
    std::size_t count = 0;
    component_of_site = neighborhood::connected_components(graph, count);
    component_size.assign(count, 0);
    for (const auto site : site_of_place)
      ++component_size[component_of_site[site]];
  }

  /// Outliers are no samples: nothing but themselves would follow them.
  void choose_samples(const std::vector<Vec3>& sites)
  {
    if (outliers.empty() || options.number_of_samples >= sites.size()) {
      site_of_sample = octree_samples(sites, options.number_of_samples);
      return;
    }
    std::vector<Vec3> others;
    std::vector<std::uint32_t> site_of_other;
    auto next = outliers.begin();
    for (std::size_t site = 0; site < sites.size(); ++site)
      if (next != outliers.end() && next->point == site)
        ++next;
      else {
        others.push_back(sites[site]);
        site_of_other.push_back(static_cast<std::uint32_t>(site));
      }
    // Without the outliers, the octree is another one.
    const auto order = neighborhood::spatial_order<ConcurrencyTag>(others);
    std::vector<Vec3> ordered(others.size());
    for (std::size_t i = 0; i < order.size(); ++i)
      ordered[i] = others[order[i]];
    site_of_sample = octree_samples(ordered, options.number_of_samples);
    for (auto& s : site_of_sample)
      s = site_of_other[order[s]];
    std::sort(site_of_sample.begin(), site_of_sample.end());
  }

  void sample(std::vector<Vec3> sites,
              neighborhood::Proximity_graph graph,
              pcs::internal::Progress& progress)
  {
    choose_samples(sites);
    is_sampled = site_of_sample.size() < sites.size();
    Sample_links links;
    if (is_sampled) {
      Sample_regions regions = grow_regions(sites, graph, site_of_sample);
      network.surface = sample_graph(sites, graph, site_of_sample, regions, weight_unit);
      progress(0.8);
      const bool is_text = options.sample_search == Sample_search::breadth_first_hops;
      links = is_text ? link_by_hops<ConcurrencyTag>(sites,
                                                     graph,
                                                     site_of_sample,
                                                     options.number_of_sample_neighbors,
                                                     options.sample_weights)
                      : link_by_regions<ConcurrencyTag>(sites,
                                                        site_of_sample,
                                                        regions,
                                                        network.surface,
                                                        options.number_of_sample_neighbors,
                                                        options.sample_weights);
      sample_of_site = std::move(regions.sample_of_point);
      has_fragments = std::find(sample_of_site.begin(), sample_of_site.end(), no_sample) !=
                      sample_of_site.end();
      site_graph = std::move(graph);
      border_finder = Border_finder(site_graph);
    } else {
      static_cast<neighborhood::Proximity_graph&>(network.surface) = std::move(graph);
      sample_of_site = site_of_sample;
      set_edge_weights<ConcurrencyTag>(sites, network.surface);
      network.surface = voronoi_graph<ConcurrencyTag>(sites, network.surface);
    }
    network.rest.resize(site_of_sample.size());
    for (std::size_t s = 0; s < site_of_sample.size(); ++s)
      network.rest[s] = sites[site_of_sample[s]];
    std::vector<std::uint32_t> component(network.size());
    for (std::size_t s = 0; s < network.size(); ++s)
      component[s] = component_of_site[site_of_sample[s]];
    set_areas<ConcurrencyTag>(component, network);
    if (options.do_preserve_volume && network.size() <= largest_linked_network)
      network.links = interior_links<ConcurrencyTag>(network, component);
    if (is_sampled)
      rank_nodes(network);
    upsampling = Upsampling(
        number_of_points(),
        [&](std::size_t place) { return sites[site_of_place[place]]; },
        [&](std::size_t place) { return site_of_place[place]; },
        network.rest,
        links);
  }
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SAMPLED_BODY_H
