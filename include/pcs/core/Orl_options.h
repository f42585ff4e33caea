// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of `Orl_shape_space`: all types that a caller passes as named parameters.

#ifndef PCS_CORE_ORL_OPTIONS_H
#define PCS_CORE_ORL_OPTIONS_H

#include <cstddef>

namespace pcs {

/// How branches of a tree become longer.
enum class Branch_growth {
  any,            ///< along branches, unless growth at tips explains clearly more
  along_branches, ///< everywhere: a branch is stretched, and what hangs on it moves along
  /// what is there stays; the two trees are measured in the same unit, and the shorter of two
  /// branches is the
  at_tips
  ///< beginning of the longer one
};

/// At a fork, a child whose continuation has at least this share of the longest one may continue
/// the branch.
constexpr double default_fork_ratio = 0.8;

/// Weights of the energy of a matching. All terms are lengths in units of the longest path of each
/// tree, so that size does not matter.
struct Matching_weights
{
  Branch_growth growth = Branch_growth::any; ///< for two trees; spaces of more stretch branches
  double curve = 1;                          ///< of the elastic energy of two branches [-]
  double position = 1;  ///< of the distance of attachments, in units of the branches' lengths [-]
  double far = 1;       ///< attachments so far apart, of the parent's length, cost half of that [-]
  double single = 0.5;  ///< of the length of a subtree without partner [-]
  double length = 1;    ///< of a difference of lengths, in units of `single` [-]
  double turn = 0.2;    ///< of the turn of a branch against its parents [-]
  double children = 1;  ///< of the children's shares in the turn that is carried on [-]
  double carried = 0.1; ///< of the parents' turn in that of their children [-]
  bool is_carried = true; ///< whether turns of parents are carried to their children
  bool is_published =
      /// the text's energy: no turns, `single` is 1, positions in units of the parent's length
      false;
  double fork_ratio = default_fork_ratio;       ///< see `Branch_paths`
  double trunk_fork_ratio = default_fork_ratio; ///< the same for the trunk, if it is less
  std::size_t number_of_paths = 6; ///< candidates for the main path of a branch; 1: the longest
  std::size_t number_of_trials =
      3; ///< pairs of candidates that are matched with all their children
};

/// Whether the second of two trees may stand turned as a whole.
enum class Orl_alignment {
  as_given,       ///< both stand in the same axes
  rotate_about_up ///< about the vertical, by any angle: pots are put down anew
};

/// Where a branch without partner points in the tree that does not have it.
enum class Virtual_direction {
  of_partner,  ///< as in the other tree: it grows in its direction
  along_parent ///< along its parent: it grows upwards, then bends, as in the text
};

/// How the orientation of an edge is measured.
enum class Orl_orientation {
  /// in the frame of the first edge of the branch, and that in the frame of an edge of the parent;
  /// twists are
  gauge_fixed,
  ///< chosen so that trees differ as little as possible
  transported, ///< in the frame of the edge before, transported from the root without twist
  /// in the axes of the input, as in the text: turning a parent does not carry its children
  world_axes
};

/// Ways to join the differences of all coordinates.
enum class Orl_metric {
  sum,    ///< of absolute differences: (4.7)
  square, ///< root of the sum of squares: the geodesic is unique
  cone ///< an edge is a vector: turning it costs in proportion to its length, nothing at length 0
};

struct Point_assignment_options
{
  double noise =
      0.1; ///< points lie off the surface by this share of the radius; the text's factor 1.1 [-]
  double normal_angle = 0.5; ///< deviation of normals that counts as much as the noise [rad]
  std::size_t number_of_neighbors = 12; ///< for normals, where none are given
};

struct Sinkhorn_options
{
  double regularization = 0.02;  ///< final epsilon, as a share of the largest cost
  std::size_t iterations = 1000; ///< at the final epsilon
  double tolerance = 1e-6;       ///< stops at this violation of the marginals
};

enum class Point_transport {
  exact,   ///< network simplex
  sinkhorn ///< regularised, as in the text
};

enum class Point_weights {
  area, ///< a point stands for the surface around it
  equal ///< all points alike, as in the text
};

struct Transport_options
{
  Point_transport method = Point_transport::exact;
  Point_weights weights = Point_weights::area;
  bool is_squared =
      true; ///< cost is the squared distance, as a 2-Wasserstein distance wants; the text's is not
  /// Mass goes at most that many times the median distance between nearest points of the two trees.
  /// What finds no room within it, as opposite of a gap of the other scan, shifts nothing: its
  /// partner is the nearest point. Infinite: all is carried, as in the text.
  double reach = 2;
  std::size_t number_of_neighbors = 16; ///< candidates of each point in the other tree
  std::size_t largest_window =
      1000; ///< points of a tree that are transported together, at most twice as many
  std::size_t least_window = 24; ///< edges are joined until both trees have as many points
  Sinkhorn_options sinkhorn;
};

/// How the points of a pair are joined.
enum class Point_path {
  cylindrical, ///< along, around and away from the edge: sections keep their size
  /// as edges from the beginning of the edge, by slerp, as in the text: sections shrink
  virtual_edges
};

/// How branches that only one end of a path has come into being.
enum class Branch_emergence {
  simultaneous, ///< all at once, as small copies of what they become: all coordinates are linear
  /// tips move on and what is behind them stays, as wood does; each branch when the tip of its
  /// parent passes its base
  sequential
};

/// What a mean makes least.
enum class Tree_mean {
  median, ///< of distances, (4.16): medians; trees unlike all others have no say
  frechet ///< of squared distances, each coordinate apart
};

/// What modes of variation explain.
enum class Mode_inner_product {
  branches, ///< how branches differ where trees have them; each branch has one vote
  metric    ///< the distance `Orl_metric::square`: a branch that is not there has the length 0
};

/// How new trees are drawn.
struct Tree_sampling_options
{
  double truncation = 2.5; ///< no score is further from 0, in standard deviations [-]
  double spread = 1;       ///< factor of all standard deviations; 0 gives middle trees only [-]
  /// share of the variance that is drawn for each branch by itself, and not for all branches
  /// together as they vary in the inputs, in [0, 1]; negative: as estimated from the inputs
  double shrinkage = -1;
  bool do_draw_presence = true; ///< else all trees have the branches that most of the inputs have
  /// whether trees keep to the range of the inputs: branches sit on those parts of others where
  /// they do in the inputs, numbers and angles of branches of an order are brought into their range
  /// by the least change, and trees that are beyond them in other figures are drawn again
  bool do_keep_in_range = true;
  std::size_t number_of_trials =
      100; ///< for that; from the middle on, nearer and nearer to the middle tree
  bool do_limit_radii = false; ///< no branch thicker than where it grows from
  double pipe_exponent =
      /// > 0: radii to this power do not add up to more than that of the parent; 2 to 2.5 in nature
      0;
};

/// When a difference counts as a change.
struct Change_limits
{
  double length = 0.05; ///< of the longer of both [-]
  double radius = 0.05; ///< of the thicker of both [-]
  double angle = 0.1;   ///< [rad]
};

} // namespace pcs

#endif // PCS_CORE_ORL_OPTIONS_H
