// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Scans a tree by rays from chosen stations, with noise, occlusion, ghosts and exact labels.

#ifndef PCS_GENERATORS_SCAN_TREE_H
#define PCS_GENERATORS_SCAN_TREE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/generators/Virtual_scan.h>
#include <pcs/generators/Virtual_scanner.h>
#include <pcs/generators/internal/Scan_session.h>
#include <pcs/internal/progress.h>

#include <CGAL/tags.h>

#include <cstdint>
#include <functional>

namespace pcs {
namespace internal {

/// The named parameters of `scan_tree()`.
struct Scan_options
{
  std::uint64_t seed = 0;
  std::function<bool(double)> callback;
};

template <class NamedParameters>
Scan_options read_scan_options(const NamedParameters& np)
{
  check_names<CGAL::internal_np::random_seed_t, CGAL::internal_np::callback_t>(np);
  static_assert(is_integer_parameter_v<NamedParameters, CGAL::internal_np::random_seed_t>,
                "pcs::scan_tree(): named parameter `random_seed` must be an integer");
  Scan_options options;
  options.seed = read_random_seed(np);
  read_callback(np, options.callback);
  return options;
}

} // namespace internal

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief simulates a terrestrial laser scan of a tree.

  The branches become triangulated tubes, with elliptic sections of exact area and with bark. Every
  station emits beams in regular steps of azimuth and elevation. Only the first surface is hit,
  which causes occlusion. A beam consists of three rays:

  - Of the beams whose ranges differ by more than `ghost_gap`, the fraction `ghost_share` gives a
    ghost at a random range between them.
  - Of the beams of which only a lateral ray hits, the fraction `edge_share` gives a point in the
    direction of the central ray. Thin twigs therefore appear too thick, as in real scans.

  Ranges are noisy. Each station has a small shift, the registration error. Outliers are distributed
  over the bounding box.

  Options of `Virtual_scanner`: wind that moves twigs between stations, leaves, ground, posts,
  one-sided visibility, and thinning.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
          `CGAL::Parallel_if_available_tag`
  \tparam Kernel a class with `FT`, `Point_3` and `Vector_3`, such as a kernel of CGAL
  \tparam NamedParameters a sequence of named parameters
  \param tree a tree with branches; up is +z. Positions may be far from the origin.
  \param scan is replaced; unchanged when the work is cancelled or an exception is thrown
  \param scanner the scanner and the scanned surroundings
  \param np an optional sequence of named parameters, listed below
  \npbegin
    \np{random_seed} seed of noise, ghosts, bark, leaves and all other random values
      \nptype integer
      \npdefault `0`
    \np{callback} called with the progress between 0 and 1; returns `false` to cancel
      \nptype anything that converts to `std::function<bool(double)>`
      \npdefault none
  \npend
  \return a `Scan_report`: status, counts by label, seconds
  \throws pcs::Invalid_input when a value of `scanner` is invalid, the tree has no edge, a
          coordinate or radius is not finite, a station is inside the trunk or would send more than
          4e9 beams, or the tree would have more than 1e7 leaves
  \par Complexity
  \f$O(t \log t)\f$ for `t` triangles, and typically \f$O(\log t)\f$ per beam.
  \par Determinism
  The result is bitwise identical for every number of threads and for the sequential tag.
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class Kernel,
          class NamedParameters = parameters::Default_named_parameters>
Scan_report scan_tree(const Tree_skeleton<Kernel>& tree,
                      Virtual_scan<Kernel>& scan,
                      const Virtual_scanner& scanner = Virtual_scanner(),
                      const NamedParameters& np = parameters::default_values())
{
  const internal::Scan_options options = internal::read_scan_options(np);
  internal::Progress progress(options.callback);
  internal::check_scanner(scanner);
  generators::internal::Scan_session<Kernel> session(tree, scanner, options.seed);
  return session.template run<ConcurrencyTag>(scan, progress);
}

} // namespace pcs

#endif // PCS_GENERATORS_SCAN_TREE_H
