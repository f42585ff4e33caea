// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of `Orl_shape_space`: all types that a caller passes as named
// parameters.

#ifndef PCS_CORE_ORL_OPTIONS_H
#define PCS_CORE_ORL_OPTIONS_H

#include <cstddef>

namespace pcs {

//! \ingroup PkgPcsShapeSpaceRef
//! how branches of a tree become longer
enum class Branch_growth {
  any,            ///< `along_branches`, unless growth at tips explains the trees clearly
                  ///< better
  along_branches, ///< everywhere: a branch is stretched, and its children move
                  ///< along
  //! at their tips, while old wood does not move: both trees have the same unit, and
  //! the shorter of two branches is the beginning of the longer one
  at_tips
};

//! At a fork, a child may continue the branch if its continuation has at least this fraction of the
//! longest one [-].
constexpr double default_fork_ratio = 0.8;

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief weights of the energy of a matching of branches.

  All terms are lengths in units of the longest path of each tree, so that size
  does not matter.
*/
struct Matching_weights
{
  Branch_growth growth = Branch_growth::any; ///< for two trees; larger families stretch branches
  double curve = 1;                          ///< of the elastic energy of two branches [-]
  double position = 1.6;                     ///< of the distance of attachments, in units of the
                                             ///< branches' lengths [-]
  double half_cost_distance = 1; ///< distance of attachments, as a fraction of the parent's
                                 ///< length, whose cost is halved by saturation [-]
  double unmatched = 0.2;        ///< of the length of an unmatched subtree [-]
  double length = 1;             ///< of a difference of lengths, in units of `unmatched` [-]
  //! of the rotation of a branch relative to its parent [-]. If it exceeds half of `unmatched`,
  //! a straight branch without children stays unmatched when it is rotated by more than
  //! `acos(1 - unmatched / rotation)`, by default 90 degrees
  double rotation = 0.2;
  double children = 0;             ///< of child directions in the estimate of this rotation [-]
  double inherited_rotation = 0.1; ///< of the parent's rotation in the same estimate [-]
  bool is_rotation_inherited =
      true; ///< whether rotations of parents are passed on to their children
  //! whether the members of a pair or whorl, such as opposite branches, have partners in one whorl,
  //! if both parents are arranged in whorls: at least four have the same size. Trees on a path then
  //! keep this arrangement
  bool do_keep_whorls = true;
  //! the published energy: no rotations, no whorls, `unmatched` and `position` are 1, positions in
  //! units of the parent's length
  bool is_published = false;
  //! see `default_fork_ratio`. Where trees are similar, limbs are searched again with 5/8 of it and
  //! twice as many paths, unless it is 1 [-]
  double fork_ratio = default_fork_ratio;
  double trunk_fork_ratio = default_fork_ratio; ///< for the trunk, if smaller [-]
  //! candidates for the main path of a branch; 1: the longest path only [count]
  std::size_t number_of_paths = 6;
  //! pairs of candidates that are matched with all their children [count]
  std::size_t number_of_trials = 3;
};

//! \ingroup PkgPcsShapeSpaceRef
//! whether the second of two trees may be rotated as a whole
enum class Orl_alignment {
  as_given,       ///< both trees have the same coordinate axes
  rotate_about_up ///< the second may be rotated by any yaw about the up direction,
                  ///< for potted plants
};

//! \ingroup PkgPcsShapeSpaceRef
//! direction of a branch in the tree that does not have it
enum class Virtual_direction {
  of_partner,  ///< as in the other tree, so that the branch grows in its own direction
  along_parent ///< along the parent, so that the branch first grows upwards and
               ///< then bends, as published (figure 4.11)
};

//! \ingroup PkgPcsShapeSpaceRef
//! how the orientation of an edge is measured
enum class Orl_orientation {
  //! relative to the first edge of the branch, which is measured relative to an
  //! edge of the parent;
  //! the twist of frames is chosen so that trees differ as little as possible
  gauge_fixed,
  transported, ///< relative to the previous edge, in frames transported from
               ///< the root without twist
  world_axes   ///< in the axes of the input, as published: children do not
               ///< rotate with their parent
};

//! \ingroup PkgPcsShapeSpaceRef
//! how the differences of all coordinates are combined to a distance
enum class Orl_metric {
  sum,    ///< weighted sum of the absolute differences of all coordinates
  square, ///< root of the weighted sum of squared differences: geodesics are unique
  cone,   ///< edges are compared as vectors: the cost of a rotation is proportional to their length
  //! (4.7): the sum over all edges of the angle between their orientations [rad], and of the
  //! differences of their lengths and radii [L], without weights. Positions, attachments and
  //! radii at the bases of branches are not part of it.
  published
};

//! \ingroup PkgPcsShapeSpaceRef
//! which branch a point belongs to where several branches are near
enum class Point_assignment {
  //! the branch with the least sum of the squared distance from its surface, in units of the noise,
  //! and the squared angle between its normal and that of the point
  by_distance_and_normal,
  //! as published: branches are candidates if the point is at most `1 + noise` radii away from
  //! their axis. Of several candidates, it is the branch with the least angle between its normal
  //! and that of the point, projected to the plane of both branches. Without a candidate, it is the
  //! branch with the nearest surface, in units of the radius.
  by_normal
};

//! \ingroup PkgPcsShapeSpaceRef
//! how the points of a scan are assigned to the edges of its tree
struct Point_assignment_options
{
  Point_assignment rule = Point_assignment::by_distance_and_normal;
  //! deviation of points from the surface, as a fraction of the radius; 0.1
  //! corresponds to the published factor 1.1 [-]
  double noise = 0.1;
  //! deviation of normals that counts as much as the noise, for `by_distance_and_normal` [rad]
  double normal_angle = 0.5;
  std::size_t number_of_neighbors = 12; ///< for normals, if none are given [count]
};

//! \ingroup PkgPcsShapeSpaceRef
//! options of `Point_transport::sinkhorn`
struct Sinkhorn_options
{
  double regularization = 0.02;  ///< final epsilon, as a fraction of the largest cost [-]
  std::size_t iterations = 1000; ///< maximal iterations at the final epsilon [count]
  double tolerance = 1e-6;       ///< violation of the marginals at which iterations stop [-]
};

//! \ingroup PkgPcsShapeSpaceRef
//! method of optimal transport
enum class Point_transport {
  exact,   ///< network simplex
  sinkhorn ///< entropic regularisation, as published
};

//! \ingroup PkgPcsShapeSpaceRef
//! mass of a point
enum class Point_weights {
  area, ///< the area of surface that the point represents
  equal ///< the same for all points, as published
};

//! \ingroup PkgPcsShapeSpaceRef
//! how points of one tree are matched to points of another
struct Transport_options
{
  Point_transport method = Point_transport::exact;
  Point_weights weights = Point_weights::area;
  //! whether the cost is the squared distance (2-Wasserstein); as published it
  //! is the distance
  bool is_squared = true;
  //! largest transport distance, in units of the median distance between nearest
  //! points of the two trees. Points whose mass cannot be transported within it,
  //! such as those opposite to a gap in the other scan, are matched to their
  //! nearest neighbour. Infinite: all mass is transported, as published [-]
  double reach = 2;
  std::size_t number_of_neighbors = 16; ///< candidates of each point in the other tree [count]
  //! intended number of points of a tree in one transport problem; the limit is
  //! twice this number [count]
  std::size_t largest_window = 1000;
  //! edges are merged until both trees have at least this many points [count]
  std::size_t least_window = 24;
  Sinkhorn_options sinkhorn;
};

//! \ingroup PkgPcsShapeSpaceRef
//! how corresponding points are interpolated
enum class Point_path {
  cylindrical,  ///< in cylindrical coordinates of the edge: cross-sections keep
                ///< their size
  virtual_edges ///< as virtual edges from the start of the edge, by slerp, as
                ///< published: cross-sections shrink
};

//! \ingroup PkgPcsShapeSpaceRef
//! normals of the points of a tree of a space
enum class Point_normals {
  of_scans, ///< those of the scans, interpolated; all scans must have normals
  //! orthogonal to the direction of the edge, as published: away from its axis, or across the blade
  //! where the points of the edge are flat
  across_branches
};

//! \ingroup PkgPcsShapeSpaceRef
//! how branches emerge that only one end of a geodesic has
enum class Branch_emergence {
  simultaneous, ///< all at once, as small copies: all coordinates are linear
  //! branches grow at their tips, and old wood does not move; each branch
  //! emerges when the tip of its parent passes its base
  sequential
};

//! \ingroup PkgPcsShapeSpaceRef
//! how lengths and radii continue beyond the ends of a geodesic
enum class Orl_extrapolation {
  //! they decay towards half of their value at the end if they decrease; branches do not extend
  //! below the base of the tree; and rotations are limited in space, too
  bounded,
  //! linearly, as published, but not below 0; `max_extrapolation_angle` limits only the rotation
  //! relative to the parent edge
  linear
};

//! \ingroup PkgPcsShapeSpaceRef
//! kind of mean
enum class Tree_mean {
  median, ///< least sum of distances, (4.16): unusual trees have little influence
  frechet ///< least sum of squared distances, by coordinate
};

//! \ingroup PkgPcsShapeSpaceRef
//! inner product in which modes of variation are computed
enum class Mode_inner_product {
  branches, ///< each branch is compared among the trees that have it; all
            ///< branches have the same weight
  metric    ///< the distance `Orl_metric::square`: a missing branch has length 0
};

//! \ingroup PkgPcsShapeSpaceRef
//! how random trees are drawn
struct Tree_sampling_options
{
  double truncation = 2.5; ///< largest score, in standard deviations [-]
  double spread = 1;       ///< factor of all standard deviations; 0: median trees only [-]
  //! fraction of the variance, in [0, 1], that is drawn for each branch
  //! independently instead of for all branches together; negative: as estimated
  //! from the inputs [-]
  double shrinkage = -1;
  //! whether branches are present at random; otherwise trees have the branches
  //! of most inputs
  bool do_draw_presence = true;
  //! whether the descriptors of trees stay in the range of the inputs.
  //! Attachments, and the numbers and angles of branches by order, are changed
  //! as little as necessary; trees with other descriptors out of range are
  //! drawn again.
  bool do_keep_in_range = true;
  //! largest number of draws for `do_keep_in_range`; the later half approaches
  //! the median tree [count]
  std::size_t number_of_trials = 100;
  bool do_limit_radii = false; ///< whether no branch is thicker than its parent at the attachment
  //! exponent of the pipe model: the sum of the children's radii to this power
  //! is at most that of the parent; 2 to 2.5 in nature, 0: no limit [-]
  double pipe_exponent = 0;
};

//! \ingroup PkgPcsShapeSpaceRef
//! differences that count as changes between two dates
struct Change_limits
{
  double length = 0.05; ///< as a fraction of the longer branch [-]
  double radius = 0.05; ///< as a fraction of the thicker branch [-]
  double angle = 0.1;   ///< [rad]
};

} // namespace pcs

#endif // PCS_CORE_ORL_OPTIONS_H
