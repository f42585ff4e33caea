// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The part of an axis that leads to its thick base.

#ifndef PCS_SKELETON_CONTINUATION_THICK_LINE_H
#define PCS_SKELETON_CONTINUATION_THICK_LINE_H

#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/continuation/Thick_continuation.h>
#include <pcs/skeleton/model/Axis.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace pcs {
namespace skeleton {

/// Line of nodes to the thick base of an axis.
struct Thick_line
{
  Axis nodes;                         ///< from a tip to the base; empty without a thick base
  Axis rest;                          ///< other branch of a fork, from its tip to the base
  Index rest_begin = 0, rest_end = 0; ///< segments of the axis that belong to the rest

  /// Returns the direction beyond the end of a line. `tail`: length that defines it [L].
  static Vec3 direction_of(const Axis& line, double tail)
  {
    std::size_t first = line.size() - 1;
    while (first > 0 && (line[first].point - line.back().point).norm() < tail)
      --first;
    return (line.back().point - line[first].point).normalized();
  }
};

namespace internal {

inline double length_beyond(const Axis& line, std::size_t k)
{
  double sum = 0;
  for (++k; k < line.size(); ++k)
    sum += (line[k].point - line[k - 1].point).norm();
  return sum;
}

/// Returns the largest radius that is maintained along a stretch of `steady` radii [L].
inline double steady_radius(const Axis& line, double steady)
{
  double thickest = 0;
  for (std::size_t k = line.size(); k-- > 0;) {
    const double wanted = steady * line[k].radius;
    double length = 0, narrowest = line[k].radius;
    for (std::size_t e = k; e > 0 && length < wanted && narrowest > thickest; --e) {
      length += (line[e].point - line[e - 1].point).norm();
      narrowest = std::min(narrowest, line[e - 1].radius);
    }
    if (length >= wanted)
      thickest = std::max(thickest, narrowest);
  }
  return thickest;
}

/// Cuts the line at its node `crest`, the lowest place of two branches of a fork. The longer branch
/// becomes the line. The fit rounds off the corner between both, so that its nodes are left out.
inline void cut_fork(std::size_t crest, double corner, Thick_line& result)
{
  Axis& line = result.nodes;
  result.rest.assign(line.rbegin(), line.rend() - static_cast<std::ptrdiff_t>(crest));
  result.rest_end = static_cast<Index>(line.size() - 1 - crest);
  line.resize(crest + 1);
  if (length_of(result.rest) > length_of(line)) {
    std::swap(result.rest, line);
    result.rest_begin = std::exchange(result.rest_end, none);
  }
  const Vec3 lowest = line.back().point;
  while (line.size() > 1 && (line.back().point - lowest).norm() < corner)
    line.pop_back();
}

} // namespace internal

/*!
  Returns the line to the thick base of an axis. Wood widens towards the root. A base that is
  thinner than the wood beyond it is thus no base:

  - If the axis narrows towards it by at most `taper` per length, it is the tip of another branch;
    the axis consists of two branches of a fork, or its direction is wrong. The line ends at the
    thickest place.
  - Otherwise, it is a strand of points on the surface, and is left out.

  There is no line if the base has less than the radius `thinnest` [L]. O(nodes).
*/
inline Thick_line line_to_base(const Axis& axis,
                               double thinnest,
                               const Chain_options& chains,
                               const Thick_end_options& rules)
{
  Thick_line result;
  Axis& line = result.nodes;
  line.assign(axis.rbegin(), axis.rend());
  const double thickest = internal::steady_radius(line, chains.steady), base = line.back().radius;
  std::size_t firm = line.size() - 1; // last node that is as thick as the line
  bool is_thin = false;
  for (; firm > 0 && line[firm].radius < rules.firm_base * thickest; --firm)
    is_thin = is_thin || line[firm].radius < chains.thin_base * thickest;
  std::size_t crest = firm;
  while (crest > 0 && line[crest].radius < rules.crest * thickest)
    --crest;
  const bool is_narrowed = base < rules.narrowed * line[crest].radius;
  if (is_narrowed && line[crest].radius - base < rules.taper * internal::length_beyond(line, crest))
    internal::cut_fork(crest, rules.corner * thickest, result);
  else if (is_narrowed && internal::length_beyond(line, firm) > rules.least * thickest)
    line.resize(crest + 1);
  else if (is_thin)
    line.resize(firm + 1);
  constexpr std::size_t fewest = 4; // nodes that define a direction
  if (line.size() < fewest || line.back().radius < thinnest)
    line.clear();
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_THICK_LINE_H
