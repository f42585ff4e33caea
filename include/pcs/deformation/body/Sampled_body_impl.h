// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of Sampled_body.h.

#ifndef PCS_DEFORMATION_BODY_SAMPLED_BODY_IMPL_H
#define PCS_DEFORMATION_BODY_SAMPLED_BODY_IMPL_H

#include <pcs/core/Deformation_options.h>
#include <pcs/core/Deformation_report.h>
#include <pcs/core/errors.h>
#include <pcs/deformation/body/Sample_links.h>
#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/body/coherent_order.h>
#include <pcs/deformation/body/interior_links.h>
#include <pcs/deformation/body/octree_samples.h>
#include <pcs/deformation/body/voronoi_graph.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/median.h>
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
namespace deformation {

namespace internal {

/// Fractions of the construction after which its steps end.
constexpr double end_of_order = 0.2, end_of_neighbor_graph = 0.45, end_of_short_cuts = 0.55,
                 end_of_neighbors = 0.6, end_of_regions = 0.7, end_of_sample_graph = 0.8,
                 end_of_network = 0.9;
/// Smallest number of samples that are spaced evenly, and weighted by Voronoi cells in their
/// tangent planes. Fewer samples do not resolve the sides of a body: at its edges and corners,
/// rounding would choose the planes. [count]
constexpr std::size_t least_resolving_samples = 1000;

inline bool is_resolving(const Sampling_options& options)
{
  return options.number_of_samples >= least_resolving_samples;
}

} // namespace internal

template <class ConcurrencyTag>
bool Sampled_body<ConcurrencyTag>::build(std::vector<Vec3> points,
                                         const Sampling_options& sampling,
                                         Deformation_report::Seconds& seconds,
                                         pcs::internal::Progress& progress)
{
  options = sampling;
  std::vector<Vec3> sites;
  Graph graph;
  {
    const pcs::internal::Stage_timer timer(seconds.neighbors);
    if (!find_neighbors(std::move(points), sites, graph, progress))
      return false;
  }
  const pcs::internal::Stage_timer timer(seconds.sampling);
  return sample(sites, std::move(graph), progress);
}

template <class ConcurrencyTag>
bool Sampled_body<ConcurrencyTag>::find_neighbors(std::vector<Vec3> points,
                                                  std::vector<Vec3>& sites,
                                                  Graph& graph,
                                                  pcs::internal::Progress& progress)
{
  to_local(points);
  order_points(points, sites);
  points = std::vector<Vec3>();
  if (!progress(internal::end_of_order))
    return false;
  graph = neighborhood::nearest_neighbor_graph<ConcurrencyTag>(sites, options.number_of_neighbors);
  if (!progress(internal::end_of_neighbor_graph))
    return false;
  number_of_short_cuts = neighborhood::drop_short_cuts<ConcurrencyTag>(sites, graph);
  if (!progress(internal::end_of_short_cuts))
    return false;
  outliers = neighborhood::detach_outliers<ConcurrencyTag>(sites, graph);
  find_components(graph);
  return progress(internal::end_of_neighbors);
}

template <class ConcurrencyTag>
Vec3 Sampled_body<ConcurrencyTag>::median_point(const std::vector<Vec3>& points)
{
  Vec3 median;
  const auto find = [&](int c) {
    std::vector<double> values(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      values[i] = points[i][c];
    median[c] = pcs::internal::upper_median(values);
  };
  pcs::internal::invoke_both<ConcurrencyTag>([&] { find(0); }, [&] { find(1); });
  find(2);
  return median;
}

template <class ConcurrencyTag>
double Sampled_body<ConcurrencyTag>::checked_extent(const std::vector<Vec3>& points)
{
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3 half = 0.5 * high - 0.5 * low;
  const double extent = half.norm() * 2;
  if (low == high)
    throw Invalid_input("pcs deformation: all " + std::to_string(points.size()) +
                        " points coincide; at least two must differ");
  // Squares and their products must stay representable.
  if (!(extent > 1e-100 && extent < 1e100))
    throw Invalid_input("pcs deformation: the points extend over " +
                        pcs::internal::to_text(half.stableNorm() * 2) +
                        "; extents must lie between 1e-100 and 1e100");
  return extent;
}

template <class ConcurrencyTag>
void Sampled_body<ConcurrencyTag>::to_local(std::vector<Vec3>& points)
{
  const double extent = checked_extent(points);
  frame.origin = median_point(points);
  frame.unit = std::exp2(std::floor(std::log2(extent)));
  pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
    points[i] = frame.to_local(points[i]);
  });
}

template <class ConcurrencyTag>
void Sampled_body<ConcurrencyTag>::order_points(const std::vector<Vec3>& points,
                                                std::vector<Vec3>& sites)
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
  number_places(points, sites.size());
}

template <class ConcurrencyTag>
void Sampled_body<ConcurrencyTag>::number_places(const std::vector<Vec3>& points,
                                                 std::size_t number_of_sites)
{
  const std::size_t n = points.size();
  is_in_callers_order = is_coherent_order<ConcurrencyTag>(points, input_of_place);
  if (is_in_callers_order)
    std::iota(input_of_place.begin(), input_of_place.end(), 0u);
  site_of_place.resize(n);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t place) {
    site_of_place[place] = site_of_input[input_of_place[place]];
  });
  if (number_of_sites == n && !is_in_callers_order)
    return;
  place_of_site.resize(number_of_sites);
  for (std::size_t place = n; place-- > 0;)
    place_of_site[site_of_place[place]] = static_cast<std::uint32_t>(place);
}

template <class ConcurrencyTag>
void Sampled_body<ConcurrencyTag>::find_components(const neighborhood::Proximity_graph& graph)
{
  std::size_t count = 0;
  component_of_site = neighborhood::connected_components<ConcurrencyTag>(graph, count);
  component_size.assign(count, 0);
  for (const auto site : site_of_place)
    ++component_size[component_of_site[site]];
}

template <class ConcurrencyTag>
void Sampled_body<ConcurrencyTag>::choose_number_of_samples(std::size_t number_of_sites)
{
  if (options.number_of_samples != automatic_number_of_samples)
    return;
  const bool is_published = options.sample_search == Sample_search::breadth_first_hops ||
                            options.sample_weights == Sample_weights::inverse_square;
  options.number_of_samples = is_published ? std::min(number_of_sites, default_number_of_samples)
                                           : number_of_samples_by_default(number_of_sites);
  sample_choice = options.number_of_samples == number_of_sites ? Sample_choice::all_points
                                                               : Sample_choice::default_number;
}

template <class ConcurrencyTag>
void Sampled_body<ConcurrencyTag>::choose_samples(const std::vector<Vec3>& sites)
{
  if (outliers.empty() || options.number_of_samples >= sites.size())
    site_of_sample = octree_samples<ConcurrencyTag>(sites,
                                                    options.number_of_samples,
                                                    internal::is_resolving(options));
  else
    choose_samples_without_outliers(sites);
}

template <class ConcurrencyTag>
std::vector<std::uint32_t> Sampled_body<ConcurrencyTag>::sites_without_outliers() const
{
  std::vector<std::uint32_t> result;
  auto next = outliers.begin();
  for (std::uint32_t site = 0; site < number_of_sites(); ++site)
    if (next != outliers.end() && next->point == site)
      ++next;
    else
      result.push_back(site);
  return result;
}

template <class ConcurrencyTag>
void Sampled_body<ConcurrencyTag>::choose_samples_without_outliers(const std::vector<Vec3>& sites)
{
  const std::vector<std::uint32_t> kept = sites_without_outliers();
  std::vector<Vec3> others;
  for (const auto site : kept)
    others.push_back(sites[site]);
  // the octree requires its points in spatial order
  const auto order = neighborhood::spatial_order<ConcurrencyTag>(others);
  std::vector<Vec3> ordered(others.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    ordered[i] = others[order[i]];
  site_of_sample = octree_samples<ConcurrencyTag>(ordered,
                                                  options.number_of_samples,
                                                  internal::is_resolving(options));
  for (auto& s : site_of_sample)
    s = kept[order[s]];
  std::sort(site_of_sample.begin(), site_of_sample.end());
}

template <class ConcurrencyTag>
Sample_links Sampled_body<ConcurrencyTag>::link_sites(const std::vector<Vec3>& sites,
                                                      const Graph& graph,
                                                      const Sample_regions& regions) const
{
  const std::size_t k = options.number_of_sample_neighbors;
  const Sample_weights weights = options.sample_weights;
  if (options.sample_search == Sample_search::breadth_first_hops)
    return link_by_hops<ConcurrencyTag>(sites, graph, site_of_sample, k, weights);
  return link_by_regions<ConcurrencyTag>(sites,
                                         site_of_sample,
                                         regions,
                                         network.surface,
                                         k,
                                         weights);
}

template <class ConcurrencyTag>
void Sampled_body<ConcurrencyTag>::weigh_by_cells(const std::vector<Vec3>& sites,
                                                  const pcs::internal::Go_on& go_on)
{
  std::vector<Vec3> samples;
  for (const auto site : site_of_sample)
    samples.push_back(sites[site]);
  const auto sum = [](const Weighted_graph& graph) {
    return std::accumulate(graph.weight.begin(), graph.weight.end(), 0.0);
  };
  Weighted_graph graph = voronoi_graph<ConcurrencyTag>(samples, network.surface, go_on);
  const double before = sum(network.surface), after = sum(graph);
  if (!(after > 0))
    return;
  for (double& weight : graph.weight)
    weight *= before / after;
  network.surface = std::move(graph);
}

template <class ConcurrencyTag>
bool Sampled_body<ConcurrencyTag>::link_samples(const std::vector<Vec3>& sites,
                                                Graph graph,
                                                pcs::internal::Progress& progress)
{
  Sample_regions regions = grow_regions<ConcurrencyTag>(sites, graph, site_of_sample);
  if (!progress(internal::end_of_regions))
    return false;
  network.surface =
      sample_graph<ConcurrencyTag>(sites, graph, site_of_sample, regions, weight_unit);
  const pcs::internal::Go_on go_on = [&](double f) { return progress(f); };
  if (internal::is_resolving(options))
    weigh_by_cells(
        sites,
        pcs::internal::part_of(go_on, internal::end_of_regions, internal::end_of_sample_graph));
  if (!progress(internal::end_of_sample_graph))
    return false;
  links_of_site = link_sites(sites, graph, regions);
  sample_of_site = std::move(regions.sample_of_point);
  has_fragments =
      std::find(sample_of_site.begin(), sample_of_site.end(), no_sample) != sample_of_site.end();
  site_graph = std::move(graph);
  return true;
}

template <class ConcurrencyTag>
bool Sampled_body<ConcurrencyTag>::take_all_sites(const std::vector<Vec3>& sites,
                                                  Graph graph,
                                                  pcs::internal::Progress& progress)
{
  static_cast<Graph&>(network.surface) = std::move(graph);
  sample_of_site = site_of_sample;
  set_edge_weights<ConcurrencyTag>(sites, network.surface);
  const pcs::internal::Go_on go_on = [&](double f) { return progress(f); };
  const auto part =
      pcs::internal::part_of(go_on, internal::end_of_neighbors, internal::end_of_sample_graph);
  network.surface = voronoi_graph<ConcurrencyTag>(sites, network.surface, part);
  return progress(internal::end_of_sample_graph);
}

template <class ConcurrencyTag>
std::vector<std::uint32_t> Sampled_body<ConcurrencyTag>::component_of_sample() const
{
  std::vector<std::uint32_t> component;
  component.reserve(site_of_sample.size());
  for (const auto site : site_of_sample)
    component.push_back(component_of_site[site]);
  return component;
}

template <class ConcurrencyTag>
void Sampled_body<ConcurrencyTag>::link_interior(const std::vector<std::uint32_t>& component)
{
  if (options.do_preserve_volume && network.size() <= largest_linked_network)
    network.links = interior_links<ConcurrencyTag>(network, component);
  if (is_sampled)
    rank_nodes(network);
}

template <class ConcurrencyTag>
bool Sampled_body<ConcurrencyTag>::sample(const std::vector<Vec3>& sites,
                                          Graph graph,
                                          pcs::internal::Progress& progress)
{
  choose_number_of_samples(sites.size());
  choose_samples(sites);
  is_sampled = site_of_sample.size() < sites.size();
  if (!(is_sampled ? link_samples(sites, std::move(graph), progress)
                   : take_all_sites(sites, std::move(graph), progress)))
    return false;
  network.rest.reserve(site_of_sample.size());
  for (const auto site : site_of_sample)
    network.rest.push_back(sites[site]);
  set_areas<ConcurrencyTag>(component_of_sample(), network);
  if (!progress(internal::end_of_network))
    return false;
  link_interior(component_of_sample());
  const auto rest = [&](std::size_t place) { return sites[site_of_place[place]]; };
  rest_points = is_sampled ? Point_blocks::of<ConcurrencyTag>(number_of_points(), rest)
                           : Point_blocks(number_of_points());
  return progress(1);
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_SAMPLED_BODY_IMPL_H
