// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Scans a tree by rays from chosen stations, with noise, occlusion, ghosts and exact labels.

#ifndef PCS_GENERATORS_SCAN_TREE_H
#define PCS_GENERATORS_SCAN_TREE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/generators/Virtual_scan.h>
#include <pcs/generators/Virtual_scanner.h>
#include <pcs/generators/internal/Scan_session.h>
#include <pcs/internal/progress.h>

#include <CGAL/tags.h>

#include <cstdint>
#include <functional>
#include <type_traits>

namespace pcs {

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief scans a tree as a terrestrial laser scanner would see it.

  The branches become tubes of triangles, with elliptic sections of exact area and with bark. From
  every station beams go out in even steps of azimuth and elevation; the first surface is hit, so
  what is behind stays hidden. A beam consists of three rays. Where their ranges differ by more than
  `ghost_gap`, the share `ghost_share` gives a ghost at a random range between them; where only a
  ray beside the middle hits, the share `edge_share` gives a point, in the direction of the middle:
  so thin twigs look too thick, as in real scans. Ranges are noisy, each station has a small shift
  (the error of registration), and outliers lie anywhere in the bounding box.

  Optional: wind that moves twigs from station to station, leaves, ground, posts, stations on one
  side only, and a thinned copy; see `Virtual_scanner`.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
          `CGAL::Parallel_if_available_tag`
  \tparam Kernel a class with `FT`, `Point_3` and `Vector_3`, such as a kernel of CGAL
  \tparam NamedParameters a sequence of named parameters
  \param tree a tree with branches; up is +z. Positions may be far from the origin.
  \param scan is replaced; unchanged when the work is cancelled or an exception is thrown
  \param scanner the scanner and its surroundings
  \param np an optional sequence of named parameters, listed below
  \npbegin
    \np{random_seed} of noise, ghosts, bark, leaves and everything else that is random
      \nptype integer
      \npdefault `0`
    \np{callback} called with the progress between 0 and 1; returns `false` to cancel
      \nptype anything that converts to `std::function<bool(double)>`
      \npdefault none
  \npend
  \return a `Scan_report`: status, counts by label, seconds
  \throws pcs::Invalid_input when a value of `scanner` makes no sense, the tree has no edge, a
          coordinate or radius is not finite, or a station would send more than 4e9 beams
  \par Complexity
  \f$O(t \log t)\f$ for `t` triangles, and \f$O(\log t)\f$ per beam as a rule.
  \par Determinism
  Same bits for every number of threads and for the sequential tag.
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class Kernel,
          class NamedParameters = parameters::Default_named_parameters>
Scan_report scan_tree(const Tree_skeleton<Kernel>& tree,
                      Virtual_scan<Kernel>& scan,
                      const Virtual_scanner& scanner = Virtual_scanner(),
                      const NamedParameters& np = parameters::default_values())
{
  const auto seed = internal::choose(np, CGAL::internal_np::random_seed, 0);
  constexpr bool seed_ok = std::is_integral_v<std::decay_t<decltype(seed)>>;
  static_assert(seed_ok, "pcs::scan_tree(): named parameter `random_seed` must be an integer");
  internal::Progress progress(
      internal::choose(np, CGAL::internal_np::callback, std::function<bool(double)>()));
  internal::check_scanner(scanner);
  if constexpr (seed_ok) {
    generators::internal::Scan_session<Kernel> session(tree,
                                                       scanner,
                                                       static_cast<std::uint64_t>(seed));
    return session.template run<ConcurrencyTag>(scan, progress);
  }
  return {};
}

} // namespace pcs

#endif // PCS_GENERATORS_SCAN_TREE_H
