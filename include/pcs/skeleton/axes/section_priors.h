// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Priors of radii and positions of sections: point counts, widths, visibility and taper.
//
// The prior of the radius of a node with the fitted radius r [L] has the mean q [L] and the
// standard deviation d [L], the prior of its center the standard deviation g [L]. Axis_fit.h
// minimises the squared differences from them with the weights 1 / d^2 and 1 / g^2 [1/L^2]. Named
// factors are those of Chain_options; u is the spacing [L], s the noise [L], N the number of points
// near the surface from two nodes before to two nodes behind [count].
//
// - Counting, where the point density D [1/L^2] is known and the visible length V [L] of these
//   nodes exceeds `visible` times their length: the radius of a cylinder with N visible points,
//
//     q = F N / (2 pi D V),   d = prior_share r' + prior_offset u.
//
//   With M = prior_ratio q, r' is r up to M and max(q, M^2 / r) beyond. F is 1 unless
//   r < blurred s; then it is exp(n / (n + hidden_nodes) m), clamped to [1, most_hidden].
//   Here, m is the median of ln(r / q_1) over the n such nodes with points, and q_1 is q for F = 1.
// - Taper, where no density is known, at the distance z [L] from the base:
//
//     q = B (1 - (1 - taper_to) z / H),   d = taper_share B max(1, N / taper_count)
//
//   if z > taper_from H and r > q. B < thick u is the median radius near the base, and H [L] is the
//   length of the chain.
// - Width, for one-sided sections with r < width_radius u:
//
//     q = sqrt(3) W,   d = width_share q + width_noise s
//
//   with the standard deviation W [L] of the points perpendicular to the axis and to their mean
//   normal: positions across the beams of a scanner are uniform over a diameter. This prior is
//   combined with one of the above: 1 / d^2 = sum_j 1 / d_j^2 and q = d^2 sum_j q_j / d_j^2.
// - Center, for r < thick u: the mean of the points is expected at r f from the center, where
//   the visibility field predicts the mean normal f [-] with the deviation v [-], and
//
//     g = facing_share v r + facing_noise s.

#ifndef PCS_SKELETON_AXES_SECTION_PRIORS_H
#define PCS_SKELETON_AXES_SECTION_PRIORS_H

#include <pcs/internal/median.h>
#include <pcs/skeleton/axes/Axis_fit.h>
#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/axes/section_counts.h>
#include <pcs/skeleton/axes/section_visibility.h>
#include <pcs/skeleton/model/Axis_set.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Returns whether noise hides the curvature of a section, so that the fit does not determine its
/// radius.
inline bool is_blurred(const Chain_view& view, double radius)
{
  return radius < view.rules.blurred * view.set.noise;
}

/*!
  Returns the prior of a radius: the value `counted` from point counts [L], with a deviation that
  follows from the fitted radius `found` [L]. Errors of counts
  are multiplicative, so that the deviation scales with the fitted radius. If the count is far below
  its expected value, the axis probably lies between several twigs. The deviation is then smaller,
  so that the radius does not count as measured.
*/
inline Radius_prior counted_prior(const Chain_view& view, double counted, double found)
{
  const Chain_options& rules = view.rules;
  const double most = rules.prior_ratio * counted;
  const double size = found > most ? std::max(counted, most / found * most) : found;
  return {counted, rules.prior_share * size + rules.prior_offset * view.scan.spacing, 0};
}

/*!
  Estimates the factor by which occlusion reduces the counts along an axis; at least 1 [-]. It is
  the median ratio of fitted to counted radii over the sections with `is_blurred()`, shrunk towards
  1 for few sections. `counted`: radii by counting, negative where sections are hidden [L].
*/
inline double
hidden_factor(const Chain_view& view, const std::vector<double>& counted, const Axis& axis)
{
  std::vector<double> ratios;
  for (std::size_t k = 0; k < axis.size(); ++k)
    if (counted[k] > 0 && is_blurred(view, axis[k].radius))
      ratios.push_back(std::log(axis[k].radius / counted[k]));
  if (ratios.empty())
    return 1;
  const double size = double(ratios.size());
  const double level =
      pcs::internal::lower_median(ratios) * size / (size + view.rules.hidden_nodes);
  return std::min(view.rules.most_hidden, std::max(1.0, std::exp(level)));
}

/// Returns the priors of all radii from point counts. Nodes with hidden sections have no prior; if
/// the density is not known, no node has one. O(nodes + points).
inline std::vector<Radius_prior>
counted_priors(const Chain_view& view, const std::vector<double>& visible, const Axis_fit& fit)
{
  const Axis& axis = fit.axis();
  std::vector<Radius_prior> priors(axis.size());
  if (!(view.set.density > 0))
    return priors;
  const Section_counts counts = section_counts(view, fit, visible);
  std::vector<double> counted(axis.size(), -1); // negative: hidden
  for (std::size_t k = 0; k < axis.size(); ++k)
    if (counts.visible_length[k] > view.rules.visible * counts.length[k])
      counted[k] = counts.radius(k, view.set.density_at(axis, k));
  const double factor = hidden_factor(view, counted, axis);
  for (std::size_t k = 0; k < axis.size(); ++k)
    if (counted[k] >= 0) {
      const double radius = axis[k].radius;
      priors[k] = counted_prior(view, (is_blurred(view, radius) ? factor : 1) * counted[k], radius);
    }
  return priors;
}

/*!
  Returns priors by taper for scans without a known density. They apply where the radius exceeds a
  linear taper from the base to a fraction of the base radius at the tip. With few points, an axis
  around several twigs has a plausible curvature; with many points, the priors become weak. Thick
  axes have enough points and get no priors. `length`: length of the whole chain, of which the axis
  may be a portion [L]. O(nodes + points).
*/
inline std::vector<Radius_prior> taper_priors(const Chain_view& view,
                                              const std::vector<double>& visible,
                                              const Axis_fit& fit,
                                              double length)
{
  const Chain_options& rules = view.rules;
  const Axis& axis = fit.axis();
  std::vector<Radius_prior> priors(axis.size());
  std::vector<double> place(axis.size(), 0), radii; // distances from the base; radii near it
  for (std::size_t k = 1; k < axis.size(); ++k)
    place[k] = place[k - 1] + (axis[k].point - axis[k - 1].point).norm();
  for (std::size_t k = 0; k < axis.size() && place[k] <= rules.taper_from * place.back(); ++k)
    radii.push_back(axis[k].radius);
  const double base = pcs::internal::lower_median(radii);
  length = std::max(length, place.back());
  if (!(length > 0) || base >= rules.thick * view.scan.spacing)
    return priors;
  const Section_counts counts = section_counts(view, fit, visible);
  for (std::size_t k = 0; k < axis.size(); ++k) {
    const double radius = base * (1 - (1 - rules.taper_to) * place[k] / length);
    if (place[k] > rules.taper_from * length && axis[k].radius > radius)
      priors[k] = {radius,
                   rules.taper_share * base * std::max(1.0, counts.count[k] / rules.taper_count),
                   0};
  }
  return priors;
}

/*!
  Sets the priors of `fit` from its current sections, as stated at the head of this file. `visible`:
  visible fraction of each section [-]; `length`: as for `taper_priors()`, 0 for a piece that need
  not taper [L]. O(nodes + points).
*/
inline void expect_sections(const Chain_view& view,
                            const std::vector<double>& visible,
                            double length,
                            Axis_fit& fit)
{
  std::vector<Radius_prior> priors = counted_priors(view, visible, fit);
  if (!(view.set.density > 0) && length > 0)
    priors = taper_priors(view, visible, fit, length);
  const Section_visibility sides(view, fit);
  add_width_priors(view, fit.axis(), sides, priors);
  fit.set_priors(std::move(priors));
  fit.set_priors(center_priors(view, fit.axis(), sides));
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_SECTION_PRIORS_H
