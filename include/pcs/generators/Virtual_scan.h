// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Output of a virtual scanner: labelled points, and a report.

#ifndef PCS_GENERATORS_VIRTUAL_SCAN_H
#define PCS_GENERATORS_VIRTUAL_SCAN_H

#include <pcs/core/Status.h>

#include <cstddef>
#include <ostream>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsGeneratorsRef
//! labels of points of a virtual scan that belong to no node of the tree
enum Scan_label : int {
  scan_label_ghost = -1,  //!< on no surface: between two surfaces, or an outlier
  scan_label_ground = -2, //!< on the ground
  scan_label_leaf = -3,   //!< on a leaf
  scan_label_post = -4    //!< on a post
};

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief The points of a virtual scan with their ground truth.

  `points`, `node` and `station` have one element for each point.

  \tparam Kernel a class with `Point_3`, such as a kernel of CGAL
*/
template <class Kernel>
struct Virtual_scan
{
  std::vector<typename Kernel::Point_3> points; //!< in the coordinates of the tree
  std::vector<int> node;         //!< nearest node of the branch that was hit, or a `Scan_label`
  std::vector<int> station;      //!< index in `stations`
  std::vector<std::size_t> hits; //!< number of points of each node of the tree [count]
  std::vector<typename Kernel::Point_3> stations; //!< positions of the scanner
};

//! \ingroup PkgPcsGeneratorsRef
//! statistics of `scan_tree()`
struct Scan_report
{
  //! `converged`: complete; `nothing_to_do`: no beam hit a surface
  Status status = Status::nothing_to_do;

  std::size_t number_of_triangles = 0; //!< triangles of the surface [count]
  std::size_t number_of_beams = 0;     //!< beams of three rays each [count]
  std::size_t number_of_points = 0;    //!< [count]
  std::size_t number_of_wood_points = 0, number_of_ghosts = 0, number_of_outliers = 0;
  std::size_t number_of_ground_points = 0, number_of_leaf_points = 0, number_of_post_points = 0;
  std::size_t number_of_thinned_points = 0; //!< points removed by `voxel_size` [count]
  std::size_t number_of_hidden_nodes = 0;   //!< nodes without points [count]

  //! wall-clock time of each stage [s]
  struct Seconds
  {
    double surface = 0, tree = 0, beams = 0, output = 0;
  } seconds;
};

inline std::ostream& operator<<(std::ostream& out, const Scan_report& r)
{
  return out << "status " << r.status << ", " << r.number_of_points << " points ("
             << r.number_of_wood_points << " wood, " << r.number_of_ground_points << " ground, "
             << r.number_of_leaf_points << " leaves, " << r.number_of_post_points << " posts, "
             << r.number_of_ghosts << " ghosts, " << r.number_of_outliers << " outliers; "
             << r.number_of_thinned_points << " thinned away) of " << r.number_of_beams
             << " beams on " << r.number_of_triangles << " triangles, " << r.number_of_hidden_nodes
             << " hidden nodes; seconds: surface " << r.seconds.surface << ", tree "
             << r.seconds.tree << ", beams " << r.seconds.beams << ", output " << r.seconds.output;
}

} // namespace pcs

#endif // PCS_GENERATORS_VIRTUAL_SCAN_H
