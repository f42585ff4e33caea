// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What a skeletonization found: counts, sizes of the tree, seconds per stage.

#ifndef PCS_CORE_SKELETON_REPORT_H
#define PCS_CORE_SKELETON_REPORT_H

#include <pcs/core/Status.h>
#include <pcs/internal/unit_of_height.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! sums over a part of a tree
struct Branch_totals
{
  std::size_t number_of_branches = 0; ///< [count]; 0 in classes of size, which cut branches
  double length = 0;                  ///< along the axes [L]
  double volume = 0;                  ///< of the frusta between the nodes [L^3]
};

//! \ingroup PkgPcsSkeletonRef
//! a station of the scanner, and how its points were moved so that all stations see the same
//! branches
struct Scan_station
{
  long long label = 0;              ///< by `station_map`; else the number of the station, from 0
  std::size_t number_of_points = 0; ///< of the station [count]
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(); ///< of the middle of its points [L]
  double turn = 0;                                 ///< about that [rad]
  //! where it stood; meaningful if its beams were found [L]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  //! between columns and between rows of its beams; 0: they were not looked for [rad]
  double azimuth_step = 0, elevation_step = 0;
};

//! \ingroup PkgPcsSkeletonRef
//! what `extract_tree_skeleton()` or `Tree_skeletonization` found
struct Skeleton_report
{
  //! `converged`; `nothing_to_do` if nothing in the cloud is a branch; `cancelled`
  Status status = Status::nothing_to_do;

  std::size_t number_of_points = 0; ///< of the input [count]
  //! points at the place of another one, or so near to it, beside all others, that they are copies
  //! [count]
  std::size_t number_of_duplicates = 0;
  std::size_t number_of_outliers =
      0; ///< points left out because they are far from all others [count]
  std::size_t number_of_leaf_points =
      0; ///< points left out by `wood_map` or `do_remove_leaves` [count]
  std::size_t number_of_ground_points = 0; ///< points left out as ground [count]
  std::size_t number_of_wall_points = 0;   ///< points left out as walls or other flat faces [count]
  std::size_t number_of_unexplained_points = 0; ///< other points that no branch explains [count]
  std::size_t number_of_unreached_points =
      0; ///< points of branches too far from the tree; these are not part of the result [count]
  std::size_t number_of_unreached_branches = 0; ///< [count]
  //! stems beside that of the root that stand at its height, out of reach or hanging by a branch:
  //! other trees [count]
  std::size_t number_of_other_stems = 0;
  //! the points lie in rows that are far from each other, and were all kept, as leaves look like
  //! wood there
  bool is_in_rows = false;
  //! stations whose points were moved; empty if none were told apart
  std::vector<Scan_station> stations;
  std::size_t number_of_nodes = 0;    ///< [count]
  std::size_t number_of_branches = 0; ///< [count]

  double spacing = 0; ///< median distance to the nearest neighbour [L]
  //! size of the voxels whose centers the points are, and which was taken out of the radii; 0: they
  //! are not [L]
  double voxel_size = 0;
  double noise = 0; ///< standard deviation of the points from the surface [L]
  //! median distance of the points from the surface of their branches; several times `noise`:
  //! something is wrong [L]
  double residual = 0;
  double density = 0; ///< points per area of the surface of branches; 0: not known [1/L^2]

  double height =
      0; ///< from the root to the highest node or leaf that was found, along the up direction [L]
  double reach = 0; ///< from the root to the farthest node [L]
  //! of the trunk, by a line through its radii from 1.1 to 1.5 m, say: bark and noise change single
  //! ones; where it ends below, of the thickest branch there; 0: nothing is that high [L]
  double diameter_at_breast_height = 0;
  double breast_height = 0; ///< of that diameter, above the root [L]
  Branch_totals total;
  std::vector<Branch_totals> by_order; ///< trunk first
  //! upper bounds of the radius in the classes of `by_size`, the last class has none
  std::vector<double> size_bounds;
  std::vector<Branch_totals> by_size; ///< thinnest class first

  //! wall-clock time of each stage [s]
  struct Seconds
  {
    double neighbors = 0, paths = 0, axes = 0, joints = 0, sections = 0;
  } seconds;
};

//! \ingroup PkgPcsSkeletonRef
//! what makes a result doubtful, a sentence each; empty for most trees
inline std::vector<std::string> warnings(const Skeleton_report& r)
{
  constexpr double much = 0.05; // of the points, out of reach [-]
  // Gaussian noise gives 0.67, scans of trees 0.5 to 0.9, spheres, cubes and dust more than 2 [-]
  constexpr double largest_residual = 1.5;
  constexpr double exact =
      0.1; // of the spacing: below, points are on the surface, whatever the noise [-]
  constexpr double oval =
      0.02; // of the diameter of the trunk: as much as ovals and bark alone leave [-]
  // diameter of the trunk per length: trees 0.01 to 0.1, spheres more than 0.2 [-]
  constexpr double thickest_trunk = 0.2;
  constexpr double thinnest_trunk = 0.002; // by the height [-]
  // volume by the cube of the reach: trees up to 0.003, a post of ten diameters 0.008, spheres that
  // are taken for many thin branches 0.03 and more [-]
  constexpr double most_wood = 0.015;
  // by the diameter of the trunk: beyond, volumes are up to several times too large; real scans up
  // to 0.2 [-]
  constexpr double widest_spacing = 1.0 / 3;
  constexpr double many = 0.5; // leaves, of the points that are neither ground nor walls [-]
  std::vector<std::string> sentences;
  if (r.number_of_other_stems > 0)
    sentences.push_back("more than one tree: " + std::to_string(r.number_of_other_stems) +
                        " other stem(s) at the height of the foot; the tree of one foot is kept, "
                        "which a root position chooses");
  if (double(r.number_of_unreached_points) > much * double(r.number_of_points))
    sentences.push_back(std::to_string(r.number_of_unreached_points) + " of " +
                        std::to_string(r.number_of_points) +
                        " points belong to branches that are too far from the tree");
  if (r.number_of_wall_points > 0)
    sentences.push_back(std::to_string(r.number_of_wall_points) +
                        " points lie on walls or other flat faces, or beside them, and are left "
                        "out; more of such things may be among the branches");
  if (const double tree = double(r.number_of_points) - double(r.number_of_ground_points) -
                          double(r.number_of_wall_points);
      double(r.number_of_leaf_points) > many * tree)
    sentences.push_back("most of the points are taken for leaves, which hide wood: radii and "
                        "volume may differ much between scans of the same tree");
  if (r.voxel_size > 0) {
    std::ostringstream size;
    size.precision(3);
    size << r.voxel_size;
    sentences.push_back("the points lie on a grid of step " + size.str() +
                        "; branches that are not several times as thick are rough guesses");
  }
  if (r.is_in_rows)
    sentences.push_back(
        "the points lie in rows that are far from each other; leaves cannot be told "
        "from wood there, and are kept (do_remove_leaves(true))");
  internal::warn_of_unit("the tree", r.height, r.breast_height, sentences);
  if (!r.by_order.empty() && r.by_order.front().length > 0) {
    const auto& trunk = r.by_order.front();
    const double diameter = 2 * std::sqrt(trunk.volume / (3.14159265358979323846 * trunk.length));
    if (r.status == Status::converged &&
        r.residual > std::max({largest_residual * r.noise, exact * r.spacing, oval * diameter}))
      sentences.push_back(
          "half of the points lie far from the surfaces found; this may be no tree");
    if (diameter < thinnest_trunk * r.height)
      sentences.push_back("the trunk is too thin for the height; the scan may show too little of "
                          "it, or wood was taken for leaves (do_remove_leaves(false))");
    if (diameter > thickest_trunk * trunk.length)
      sentences.push_back("the trunk is shorter than five of its diameters; this may be no tree");
    else if (r.total.volume > most_wood * std::pow(r.reach, 3))
      sentences.push_back("there is more wood than a tree of this size has; this may be no tree");
    if (r.spacing > widest_spacing * diameter)
      sentences.push_back("the points are farther apart than a third of the diameter of the trunk; "
                          "radii and volume are rough guesses");
  }
  return sentences;
}

inline std::ostream& operator<<(std::ostream& out, const Skeleton_report& r)
{
  out << "status " << r.status << ", " << r.number_of_points << " points ("
      << r.number_of_duplicates << " duplicates, " << r.number_of_outliers << " outliers, "
      << r.number_of_leaf_points << " leaves, " << r.number_of_ground_points << " on the ground, "
      << r.number_of_wall_points << " on walls, " << r.number_of_unexplained_points
      << " unexplained, " << r.number_of_unreached_points << " out of reach), "
      << r.number_of_other_stems << " other stems, " << r.number_of_branches << " branches, "
      << r.number_of_nodes << " nodes, spacing " << r.spacing << ", noise " << r.noise
      << ", residual " << r.residual << ", height " << r.height << ", diameter at breast height "
      << r.diameter_at_breast_height << ", length " << r.total.length << ", volume "
      << r.total.volume << "; seconds: neighbors " << r.seconds.neighbors << ", paths "
      << r.seconds.paths << ", axes " << r.seconds.axes << ", joints " << r.seconds.joints
      << ", sections " << r.seconds.sections;
  return out;
}

} // namespace pcs

#endif // PCS_CORE_SKELETON_REPORT_H
