// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Constraints on samples and points that follow from the handles.

#ifndef PCS_DEFORMATION_HANDLES_SITE_CONSTRAINTS_H
#define PCS_DEFORMATION_HANDLES_SITE_CONSTRAINTS_H

#include <pcs/core/Deformation_report.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Handle_set.h>
#include <pcs/deformation/model/Node_constraints.h>
#include <pcs/deformation/model/Point_blocks.h>
#include <pcs/internal/lanes.h>
#include <pcs/internal/parallel.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// A site that follows its host as one rigid body.
constexpr Node_constraint outlier_site = -4;
/// A site of a component that lost its last handle: it returns to its position at rest.
constexpr Node_constraint returning_site = -5;

/// Classification of the sites: moved by a handle, blended from samples, or not written.
class Site_constraints
{
public:
  /// Whether `find()` has not been called yet.
  bool empty() const { return m_of_site.empty(); }
  /// Returns the class of a site: a handle, `free_node`, `unreached_node`, `outlier_site` or
  /// `returning_site`.
  Node_constraint operator[](std::size_t site) const { return m_of_site[site]; }
  /// Returns one bit per upsampling index, `lanes` bits per byte: whether the point is blended.
  const std::vector<std::uint8_t>& is_blended() const { return m_is_blended; }
  /// Returns for each block of points the handle that holds all of them, `still_block` if none of
  /// them moves, otherwise `mixed_block`.
  const std::vector<std::int32_t>& holder() const { return m_holder; }

  /// Classifies and counts all sites. Returns the handle that holds each sample.
  template <class ConcurrencyTag>
  Node_constraints find(const Sampled_body<ConcurrencyTag>& body,
                        const Handle_set& handles,
                        Deformation_report& report)
  {
    const std::vector<char> is_reached = handles.reached_components(body.number_of_components());
    count_unreached(body, is_reached, report);
    classify_sites(body, handles, is_reached);
    mark_places(body);
    return of_samples(body, handles, is_reached);
  }

  /// Returns the handles that fragments without a sample have begun to follow since the last call.
  /// Their points may be displaced.
  std::vector<Node_constraint> take_followed_handles() { return std::exchange(m_followed, {}); }

  /// Makes the current shape the rest shape, so that no site has to return.
  void accept() { m_was_reached.clear(); }

private:
  template <class ConcurrencyTag>
  static void count_unreached(const Sampled_body<ConcurrencyTag>& body,
                              const std::vector<char>& is_reached,
                              Deformation_report& report)
  {
    report.number_of_unreached_components = report.number_of_unreached_points = 0;
    for (std::size_t c = 0; c < body.number_of_components(); ++c)
      if (!is_reached[c]) {
        ++report.number_of_unreached_components;
        report.number_of_unreached_points += body.component_size[c];
      }
  }

  template <class ConcurrencyTag>
  static Node_constraints of_samples(const Sampled_body<ConcurrencyTag>& body,
                                     const Handle_set& handles,
                                     const std::vector<char>& is_reached)
  {
    Node_constraints constraints;
    constraints.softness_weight = handles.softness_weights();
    auto& of_sample = constraints.handle_of_node;
    of_sample.assign(body.number_of_samples(), free_node);
    std::set<std::pair<Node_constraint, std::uint32_t>> has_sample; // handle and component
    for (std::size_t s = 0; s < of_sample.size(); ++s) {
      const std::size_t site = body.site_of_sample[s];
      const Node_constraint h = handles.of_site(site);
      if (!is_reached[body.component_of_site[site]])
        of_sample[s] = unreached_node;
      else if (h == outside_region)
        of_sample[s] = handles.outside_handle();
      else if (h >= 0) {
        of_sample[s] = h;
        has_sample.emplace(h, body.component_of_site[site]);
      }
    }
    // A soft handle without samples holds the samples in whose regions its points lie. Exact
    // handles have nodes on their borders instead.
    const bool has_soft_handles = handles.has_soft_handles();
    for (std::size_t site = 0; has_soft_handles && site < body.number_of_sites(); ++site) {
      const Node_constraint h = handles.of_site(site);
      if (!handles.is_soft(h) || body.sample_of_site[site] == no_sample ||
          has_sample.count({h, body.component_of_site[site]}) > 0)
        continue;
      Node_constraint& sample = of_sample[body.sample_of_site[site]];
      if (sample == free_node)
        sample = h;
    }
    return constraints;
  }

  template <class ConcurrencyTag>
  void classify_sites(const Sampled_body<ConcurrencyTag>& body,
                      const Handle_set& handles,
                      const std::vector<char>& is_reached)
  {
    // Fragments too small for a sample of their own follow the handle that touches them.
    std::vector<Node_constraint> follows(body.number_of_components(), unreached_node);
    for (std::size_t site = 0; body.has_fragments && site < body.number_of_sites(); ++site) {
      Node_constraint& f = follows[body.component_of_site[site]];
      if (handles.of_site(site) >= 0 && f == unreached_node &&
          body.sample_of_site[site] == no_sample)
        m_followed.push_back(f = handles.of_site(site));
    }
    // A component that lost its last handle returns to rest.
    m_was_reached.resize(body.number_of_components(), 0);
    m_of_site.resize(body.number_of_sites());
    pcs::internal::for_each_index<ConcurrencyTag>(body.number_of_sites(), [&](std::size_t site) {
      const std::size_t component = body.component_of_site[site];
      Node_constraint h = handles.of_site(site);
      if (h == outside_region)
        h = unreached_node;
      else if (!is_reached[component])
        h = m_was_reached[component] ? returning_site : unreached_node;
      else if (body.sample_of_site[site] == no_sample)
        h = h == free_node ? follows[component] : h;
      else if (handles.is_soft(h))
        h = free_node;
      m_of_site[site] = h;
    });
    if (body.is_sampled)
      for (const neighborhood::Outlier& o : body.outliers)
        if (m_of_site[o.point] == free_node)
          m_of_site[o.point] = outlier_site;
    for (std::size_t c = 0; c < is_reached.size(); ++c)
      m_was_reached[c] = m_was_reached[c] || is_reached[c] ? 1 : 0;
  }

  /// Finds the blended points and the holder of every block of eight points.
  template <class ConcurrencyTag>
  void mark_places(const Sampled_body<ConcurrencyTag>& body)
  {
    m_is_blended.resize(body.rest_points.number_of_blocks());
    m_holder.resize(m_is_blended.size());
    if (body.place_of_site.empty())
      mark_blocks<ConcurrencyTag>(body.number_of_points(),
                                  [&](std::size_t place) { return m_of_site[place]; });
    else
      mark_blocks<ConcurrencyTag>(body.number_of_points(), [&](std::size_t place) {
        return m_of_site[body.site_of_place[place]];
      });
  }

  /// \param of_place the class of the site of a point
  template <class ConcurrencyTag, class OfPlace>
  void mark_blocks(std::size_t number_of_points, const OfPlace& of_place)
  {
    pcs::internal::for_each_index<ConcurrencyTag>(m_is_blended.size(), [&](std::size_t block) {
      const std::size_t begin = block * lanes, count = std::min(lanes, number_of_points - begin);
      const Node_constraint first = of_place(begin);
      unsigned bits = 0;
      bool is_alike = true;
      const auto mark = [&](std::size_t l) {
        const Node_constraint h = of_place(begin + l);
        bits |= (h == free_node ? 1u : 0u) << l;
        is_alike &= h == first;
      };
      if (count == lanes)
        pcs::internal::unroll<lanes>([&](auto l) { mark(l); });
      else
        for (std::size_t l = 0; l < count; ++l)
          mark(l);
      const bool is_held = is_alike && first >= 0, is_still = is_alike && first == unreached_node;
      m_holder[block] = is_held ? first : is_still ? still_block : mixed_block;
      m_is_blended[block] = static_cast<std::uint8_t>(bits);
    });
  }

  std::vector<Node_constraint> m_of_site;
  std::vector<std::uint8_t> m_is_blended;
  std::vector<std::int32_t> m_holder;
  std::vector<char> m_was_reached;         ///< of each component
  std::vector<Node_constraint> m_followed; ///< see `take_followed_handles()`
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_SITE_CONSTRAINTS_H
