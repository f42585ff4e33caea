// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Blend of the exact motion of a handle into the motion of the points around it.

#ifndef PCS_DEFORMATION_UPSAMPLING_BORDER_FADE_H
#define PCS_DEFORMATION_UPSAMPLING_BORDER_FADE_H

#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/handles/Border_finder.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/internal/lanes.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <boost/sort/spreadsort/integer_sort.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace deformation {

/// A site that is blended towards a handle with the weight `weight` in (0, 1]. Sites near several
/// handles are blended towards one after the other, in the order of the handles.
struct Border_fade
{
  std::uint32_t site;
  Node_constraint handle;
  double weight;
  double distance; ///< from the handle along the graph, in sample spacings; in (0, 1)
};

namespace internal {

/// A free site near a handle.
struct Band_site
{
  std::uint32_t site;
  Node_constraint handle;
  double distance; ///< along the graph, in sample spacings; in (0, 1)
};

/*!
  Finds shortest paths from handles. Each edge is measured in units of the local sample spacing at
  its ends, so that distances of neighbours differ by at most the length of the edge between them.
  This would not hold with the spacing at the nearest handle as the unit.
*/
template <class HandleOfSite, class SitePosition>
class Band_search
{
public:
  Band_search(const neighborhood::Proximity_graph& graph,
              const std::vector<std::uint32_t>& sample_of_site,
              const std::vector<double>& spacing_of_sample,
              const HandleOfSite& handle_of_site,
              const SitePosition& position)
    : m_graph(graph),
      m_sample_of_site(sample_of_site),
      m_spacing_of_sample(spacing_of_sample),
      m_handle_of_site(handle_of_site),
      m_position(position),
      m_index(graph.size(), no_sample)
  {
  }

  /// Appends the sites nearer than one spacing to the handle from which the edges in `[begin, end)`
  /// start.
  template <class EdgeIterator>
  void search(EdgeIterator begin, EdgeIterator end, std::vector<Band_site>& band)
  {
    const Node_constraint handle = m_handle_of_site(begin->inside);
    m_reached.clear();
    for (auto e = begin; e != end; ++e)
      relax(reach(e->inside, 0), e->outside);
    for (auto& bucket : m_buckets) {
      for (std::size_t b = 0; b < bucket.size(); ++b) { // the bucket grows in this loop
        const Entry entry = bucket[b];
        const Reached source = m_reached[entry.reached];
        if (entry.distance > source.distance)
          continue;
        for (auto j = m_graph.begin(source.site); j != m_graph.end(source.site); ++j)
          relax(source, *j);
      }
      bucket.clear();
    }
    for (const Reached& r : m_reached) {
      m_index[r.site] = no_sample;
      band.push_back({r.site, handle, r.distance});
    }
  }

private:
  struct Reached
  {
    Vec3 position;
    double distance;
    double per_length; ///< spacings in a unit of length
    std::uint32_t site;
  };
  /// An entry of a bucket of similar distances. A site may have several entries; an entry is
  /// skipped if the distance of its site has decreased since.
  struct Entry
  {
    double distance;
    std::uint32_t reached;
  };

  Reached reach(std::uint32_t site, double distance) const
  {
    const std::uint32_t sample = m_sample_of_site[site];
    const double spacing = sample == no_sample ? 0 : m_spacing_of_sample[sample];
    return {m_position(site), distance, spacing > 0 ? 1 / spacing : infinity, site};
  }

  static double distance(const Reached& source, const Reached& to)
  {
    return source.distance +
           (to.position - source.position).norm() * (0.5 * (source.per_length + to.per_length));
  }

  void relax(const Reached& source, std::uint32_t to)
  {
    std::uint32_t r = m_index[to];
    if (r == no_sample) {
      if (m_handle_of_site(to) >= 0)
        return;
      Reached reached = reach(to, 0);
      reached.distance = distance(source, reached);
      if (!(reached.distance < 1))
        return;
      r = m_index[to] = static_cast<std::uint32_t>(m_reached.size());
      m_reached.push_back(reached);
      pcs::internal::prefetch(m_graph.begin(to), m_graph.degree(to) * sizeof(std::uint32_t));
    } else {
      if (m_reached[r].distance <= source.distance)
        return;
      const double d = distance(source, m_reached[r]);
      if (!(d < m_reached[r].distance))
        return;
      m_reached[r].distance = d;
    }
    const double d = m_reached[r].distance;
    m_buckets[static_cast<std::size_t>(d * number_of_buckets)].push_back({d, r});
  }

  static constexpr std::size_t number_of_buckets = 256;
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  const neighborhood::Proximity_graph& m_graph;
  const std::vector<std::uint32_t>& m_sample_of_site;
  const std::vector<double>& m_spacing_of_sample;
  const HandleOfSite& m_handle_of_site;
  const SitePosition& m_position;
  std::vector<std::uint32_t> m_index; ///< index of a site in `m_reached`
  std::vector<Reached> m_reached;
  std::array<std::vector<Entry>, number_of_buckets> m_buckets;
};

/// Sorts by site. Sites of several handles, which are in the order of the handles, keep this order.
inline void sort_by_site(std::vector<Band_site>& band)
{
  std::vector<std::uint64_t> order(band.size()); // site, then index
  for (std::size_t k = 0; k < band.size(); ++k)
    order[k] = std::uint64_t(band[k].site) << 32 | k;
  boost::sort::spreadsort::integer_sort(order.begin(), order.end());
  std::vector<Band_site> sorted;
  sorted.reserve(band.size());
  for (const std::uint64_t key : order)
    sorted.push_back(band[static_cast<std::uint32_t>(key)]);
  band.swap(sorted);
}

/*!
  The weight of a handle at a distance of `d` spacings is `(1 - d)^2`. The difference between the
  motions of the handle and of the samples increases with the distance from the handle. The steep
  decrease of the weight at the handle, where both motions agree, keeps the blended field less steep
  than a smooth start would.

  Several handles have the total weight `1 - prod(1 - w)`. It is divided in proportion to
  `w / (1 - w)`, where `w` is the separate weight of a handle. At the border of a handle, its weight
  is 1.
  \param begin, end the handles that reach one site, increasing
*/
template <class Iterator>
void append_fades(Iterator begin, Iterator end, std::vector<Border_fade>& fades)
{
  const auto share = [](const Band_site& s) { return (1 - s.distance) * (1 - s.distance); };
  if (end - begin == 1) {
    fades.push_back({begin->site, begin->handle, share(*begin), begin->distance});
    return;
  }
  double rest = 1, sum = 0;
  for (Iterator s = begin; s != end; ++s) {
    rest *= 1 - share(*s);
    sum += share(*s) / (1 - share(*s));
  }
  // Handles are applied one after the other. Earlier weights are larger, since later handles reduce
  // their effect.
  const std::size_t first = fades.size();
  double left = 1;
  for (Iterator s = end; s-- != begin;) {
    const double part = (1 - rest) * (share(*s) / (1 - share(*s))) / sum;
    fades.push_back({s->site, s->handle, left > part ? part / left : 1, s->distance});
    left -= part;
  }
  std::reverse(fades.begin() + static_cast<std::ptrdiff_t>(first), fades.end());
}

} // namespace internal

/*!
  Returns the free sites whose distance from an exact handle along the graph is less than one sample
  spacing, with their weights. Without blending, the points of a handle, which move exactly, would
  separate from their neighbours, which are blended from samples. The result is sorted by site, then
  by handle. The time is proportional to the number of these sites.
  \param border edges from sites of exact handles to others
  \param handle_of_site the handle that prescribes a site, or negative
  \param spacing_of_sample mean distance of each sample to its neighbours [L]
*/
template <class HandleOfSite, class SitePosition>
std::vector<Border_fade> border_fades(const neighborhood::Proximity_graph& graph,
                                      std::vector<Border_edge> border,
                                      const std::vector<std::uint32_t>& sample_of_site,
                                      const std::vector<double>& spacing_of_sample,
                                      const HandleOfSite& handle_of_site,
                                      const SitePosition& position)
{
  std::stable_sort(border.begin(), border.end(), [&](const Border_edge& a, const Border_edge& b) {
    return handle_of_site(a.inside) < handle_of_site(b.inside);
  });
  internal::Band_search<HandleOfSite, SitePosition> search(graph,
                                                           sample_of_site,
                                                           spacing_of_sample,
                                                           handle_of_site,
                                                           position);
  std::vector<internal::Band_site> band;
  for (auto begin = border.begin(); begin != border.end();) {
    const auto end = std::find_if(begin, border.end(), [&](const Border_edge& e) {
      return handle_of_site(e.inside) != handle_of_site(begin->inside);
    });
    search.search(begin, end, band);
    begin = end;
  }
  internal::sort_by_site(band);
  std::vector<Border_fade> fades;
  fades.reserve(band.size());
  for (auto begin = band.begin(); begin != band.end();) {
    auto end = begin + 1;
    while (end != band.end() && end->site == begin->site)
      ++end;
    internal::append_fades(begin, end, fades);
    begin = end;
  }
  return fades;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_BORDER_FADE_H
