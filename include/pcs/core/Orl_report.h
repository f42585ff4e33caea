// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Statistics of the construction of a shape space: counts, distances, seconds per stage.

#ifndef PCS_CORE_ORL_REPORT_H
#define PCS_CORE_ORL_REPORT_H

#include <pcs/core/Status.h>

#include <array>
#include <cstddef>
#include <ostream>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsShapeSpaceRef
//! statistics of `orl_geodesic()` or `Orl_shape_space::build()`
struct Orl_report
{
  //! `iteration_limit`: some transports of points did not converge, see `number_of_failed_windows`
  Status status = Status::nothing_to_do;

  std::size_t number_of_trees = 2; ///< [count]; values of single trees refer to the first two
  std::size_t number_of_common_branches = 0; ///< of the topology [count]
  //! more than two trees: fraction of branches whose correspondence changed in the last round [-]
  double fraction_of_changed_matches = 0;

  std::array<std::size_t, 2> number_of_nodes = {0, 0};    ///< of the trees [count]
  std::array<std::size_t, 2> number_of_branches = {0, 0}; ///< of the trees, as matched [count]
  std::size_t number_of_matched_branches = 0;             ///< pairs of branches [count]
  //! of each tree: opposite pairs and whorls of branches, below parents with at least four whorls
  //! of the same size. Those of other parents are neither kept nor counted [count]
  std::vector<std::size_t> number_of_whorls = {0, 0};
  //! of these, whorls whose members separate on the path to another tree, because their partners
  //! are not in one whorl there [count]
  std::vector<std::size_t> number_of_broken_whorls = {0, 0};
  std::size_t number_of_edges = 0; ///< of the common topology [count]
  double matching_energy = 0;      ///< of the branches, in units of the longest paths [-]
  //! two trees: 0 if the whole smaller tree has a counterpart in the other, 1 if no part has [-]
  double unexplained_fraction = 0;
  //! two trees: whether branches were matched as growing at their tips instead of stretching
  bool is_grown_at_tips = false;
  //! two trees: rotation about the vertical that aligns the second with the first [rad]
  double yaw = 0;
  double distance = 0; ///< between the trees, (4.7) [L]

  std::array<std::size_t, 2> number_of_points = {0, 0}; ///< of the scans [count]
  std::size_t number_of_point_pairs = 0;                ///< points of a tree of the space [count]
  std::size_t number_of_unmatched_points = 0; ///< of these: points of one scan only [count]
  std::size_t number_of_windows = 0;          ///< optimal transports that were solved [count]
  std::size_t number_of_failed_windows = 0;   ///< transports that did not converge [count]
  double worst_marginal_violation = 0;        ///< largest fraction of misplaced mass, by window [-]
  double mean_marginal_violation = 0;         ///< the same, mean over windows [-]
  //! fraction of the mass of a window without counterpart within reach, mean over windows [-]
  double untransported_mass_share = 0;

  //! wall-clock time of each stage [s]
  struct Seconds
  {
    double matching = 0, topology = 0, assignment = 0, transport = 0, instances = 0;
    double total() const { return matching + topology + assignment + transport + instances; }
  } seconds;
};

/// Writes one line; values of pairs are written for two trees only.
inline std::ostream& operator<<(std::ostream& out, const Orl_report& r)
{
  out << "status " << r.status << ", ";
  if (r.number_of_trees == 2)
    out << r.number_of_branches[0] << " and " << r.number_of_branches[1] << " branches, "
        << r.number_of_matched_branches << " matched, " << r.number_of_edges << " edges, distance "
        << r.distance << "; " << r.number_of_points[0] << " and " << r.number_of_points[1]
        << " points, " << r.number_of_point_pairs << " pairs (" << r.number_of_unmatched_points
        << " unmatched), ";
  else
    out << r.number_of_trees << " trees, " << r.number_of_common_branches << " common branches, "
        << r.number_of_edges << " edges; " << r.number_of_point_pairs << " points, ";
  out << r.number_of_windows << " windows (" << r.number_of_failed_windows
      << " failed), marginal violation " << r.worst_marginal_violation << ", without counterpart "
      << r.untransported_mass_share << "; seconds: matching " << r.seconds.matching << ", topology "
      << r.seconds.topology << ", assignment " << r.seconds.assignment << ", transport "
      << r.seconds.transport << ", instances " << r.seconds.instances;
  return out;
}

} // namespace pcs

#endif // PCS_CORE_ORL_REPORT_H
