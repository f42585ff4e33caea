// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The stages of a skeletonization, one after the other, with all that they leave behind.

#ifndef PCS_SKELETON_SESSION_STAGES_H
#define PCS_SKELETON_SESSION_STAGES_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/branching/group_branches.h>
#include <pcs/skeleton/branching/regroup_axes.h>
#include <pcs/skeleton/branching/root_axis.h>
#include <pcs/skeleton/branching/split_unreachable_axes.h>
#include <pcs/skeleton/clutter/Wall_removal.h>
#include <pcs/skeleton/layers/cut_layers.h>
#include <pcs/skeleton/leaves/wood_score_of_axes.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/registration/register_stations.h>
#include <pcs/skeleton/result/report_sizes.h>
#include <pcs/skeleton/result/residual_of_point.h>
#include <pcs/skeleton/scan/Point_labels.h>
#include <pcs/skeleton/scan/prepare_scan.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Runs the stages in order; each runs those before it that have not run yet, and stops when cancelled.
template <class ConcurrencyTag>
class Session_stages
{
public:
  using Concurrency_tag = ConcurrencyTag;

  /// `input` is finite, with at least two different points; `is_wood` is empty or has one entry per point.
  Session_stages(std::vector<Vec3> input,
                 std::vector<std::uint8_t> is_wood,
                 Session_options options)
    : m_input(std::move(input)), m_is_wood(std::move(is_wood)), m_options(std::move(options))
  {
    m_report.number_of_points = m_input.size();
  }

  bool find_neighbors(pcs::internal::Progress& progress)
  {
    if (m_stage >= 1)
      return true;
    pcs::internal::Stopwatch watch;
    if (!progress(0))
      return false;
    if (m_scan.points.empty())
      take_points<ConcurrencyTag>(std::move(m_input), m_options.up, m_scan);
    if (!register_stations<Session_stages>(m_is_wood, m_options, m_scan, m_report, progress))
      return false;
    measure_points<ConcurrencyTag>(m_scan);
    const double unit = m_scan.frame.unit;
    m_options.up = Vec3::UnitZ(); // from here on, all is in coordinates of the scan
    m_options.breast_height /= unit;
    m_used.start(m_is_wood);
    if (m_options.given) { // it stands where the tree stands, and tells where there may be one
      m_may_be_used = m_used.flags();
      m_options.method = Skeleton_method::chains;
      if (!m_options.root)
        m_options.root = m_options.given->points.front();
    }
    for (Vec3& s : m_options.scanners)
      s = m_scan.frame.to_local(s);
    m_report.seconds.neighbors = watch.lap();
    m_stage = 1;
    return progress(0.35);
  }

  bool find_paths(pcs::internal::Progress& progress)
  {
    if (!find_neighbors(progress))
      return false;
    if (m_stage >= 2)
      return true;
    pcs::internal::Stopwatch watch;
    if (m_options.do_mark_ground && !m_are_walls_out) { // when stopped below, they are
      if (is_single_sheet(m_scan, m_used.flags(), m_options.ground.sheet)) {
        m_used.leave_out_all();
        m_stage = 2;
        return progress(0.6);
      }
      m_wall_removal.leave_out_walls_and_roofs(m_options.up);
    }
    m_are_walls_out = true;
    Links links = links_of_used();
    Linked_parts linked;
    const auto link = [&] {
      if (m_options.do_trace_paths)
        link_parts(links, false, linked);
    };
    // most scans have no ground, and what is found meanwhile stays
    std::vector<std::uint8_t> is_above = m_used.flags();
    std::size_t ground = 0;
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] {
          if (m_options.do_mark_ground)
            ground = mark_ground(m_scan, links, m_options.up, m_options.ground, is_above);
        },
        link);
    if (!progress(0.42))
      return false; // the ground is not left out yet
    m_report.number_of_ground_points = ground;
    if (ground > 0) {
      m_used.leave_out_others(std::move(is_above));
      links = links_of_used();
    }
    const bool may_have_faces = m_wall_removal.has_faces() || ground > 0; // else known already
    const auto find_links = [&] { return links_of_used(); };
    if ((may_have_faces && m_wall_removal.leave_out_rest(find_links, links)) || ground > 0)
      link();
    if (m_options.do_trace_paths)
      trace_paths(links, linked);
    m_report.seconds.paths = watch.lap();
    m_stage = 2;
    return progress(0.6);
  }

  bool fit_axes(pcs::internal::Progress& progress)
  {
    if (!find_paths(progress))
      return false;
    if (m_stage >= 3)
      return true;
    pcs::internal::Stopwatch watch;
    if (m_root.empty()) { // nothing is a tree
      m_stage = 3;
      return progress(0.9);
    }
    if (m_options.method == Skeleton_method::sections) {
      const std::vector<Surface_frame> frames = principal_curvatures<ConcurrencyTag>(m_scan);
      if (!progress(0.7))
        return false;
      m_sections = detect_sections(m_scan, m_used.flags(), frames, m_options.slices, [&](double f) {
        return progress(0.7 + 0.2 * f);
      });
      if (progress.is_cancelled())
        return false;
      m_report.seconds.axes = watch.lap();
      m_stage = 3;
      return progress(0.9);
    }
    const int rounds = m_options.leaf_removal == Leaf_removal::never ? 0 : m_options.leaves.rounds;
    for (bool is_running = true;;) {
      const double from = m_leaf_rounds == 0 ? 0.6 : 0.75 + 0.15 * (m_leaf_rounds - 1) / rounds;
      const double width = m_leaf_rounds == 0 ? 0.15 : 0.15 / rounds;
      m_axes = skeleton::fit_axes<ConcurrencyTag>(m_scan, m_layers, m_options.axes, [&](double f) {
        return is_running = progress(from + width * f);
      });
      if (!is_running)
        return false;
      if (m_leaf_rounds >= rounds || !remove_leaves())
        break;
      ++m_leaf_rounds; // stopped from here on, the work goes on with the wood
    }
    if (m_leaf_rounds > 0)
      m_used.reassign_leaves(m_options.axes.chains, m_axes);
    if (!m_has_leaves)
      m_used.undo_leaf_removal();
    fuse_axes<ConcurrencyTag>(m_scan.spacing, m_options.fusion, m_axes);
    m_report.noise = m_scan.frame.unit * m_axes.noise;
    m_report.density = m_axes.density / (m_scan.frame.unit * m_scan.frame.unit);
    m_report.seconds.axes = watch.lap();
    m_stage = 3;
    return progress(0.9);
  }

  bool join(pcs::internal::Progress& progress)
  {
    if (!fit_axes(progress))
      return false;
    if (m_stage >= 4)
      return true;
    pcs::internal::Stopwatch watch;
    if (m_options.method == Skeleton_method::sections && !m_root.empty()) {
      m_tree = section_skeleton(m_scan, m_used.flags(), m_sections, m_root, m_options.section_tree);
      correct_widening();
      count();
      m_report.seconds.joints = watch.lap();
      m_stage = 4;
      return progress(0.97);
    }
    if (!m_axes.axes.empty()) {
      Index root = join_axes();
      while (m_regroupings + 1 < m_options.joints.rounds) {
        if (!progress(0.9 + 0.05 * (m_regroupings + 1) / m_options.joints.rounds))
          return false;
        regroup_axes(m_tree, m_axes);
        fuse_axes<ConcurrencyTag>(m_scan.spacing, m_options.fusion, m_axes);
        ++m_regroupings; // stopped from here on, the work goes on with these axes
        root = join_axes();
      }
      const double reach = m_options.joints.reach * m_scan.spacing;
      if (split_unreachable_axes(m_scan, reach, m_joints, root, m_axes) > 0)
        root = join_axes();
      if (!progress(0.95))
        return false;
      prune_stubs(m_scan.spacing, m_options.stubs, m_tree);
      const Section_support support =
          support_of_sections<ConcurrencyTag>(m_scan, m_tree, m_axes.noise, m_options.support);
      if (m_has_leaves && m_leaf_rounds > 0) // what is left of leaves makes twigs thick
        m_options.support.pipes.slack = m_options.leaves.pipe_slack;
      std::vector<double> fitted;
      for (const Branch_node& node : m_tree.nodes)
        fitted.push_back(node.radius);
      bound_radii(m_scan, support, m_axes.density, m_options.support, m_tree);
      rebuild_trunk_base(m_scan,
                         m_used.flags(),
                         support,
                         m_axes.density,
                         m_options.support,
                         m_options.foot,
                         m_tree);
      recenter_bounded_nodes(m_scan, fitted, m_axes.noise, m_options.following, m_tree);
      if (!m_options.given) // which is one tree
        m_report.number_of_other_stems =
            count_other_stems(m_axes, m_joints, root, m_tree, m_options.stems);
    }
    if (m_options.given)
      m_tree = measure_given(m_scan,
                             m_used.is_empty() ? m_may_be_used : m_used.flags(),
                             *m_options.given,
                             m_tree,
                             m_options.given_rules);
    m_report.seconds.joints = watch.lap();
    if (!progress(0.97))
      return false;
    correct_widening();
    fit_section_ellipses<ConcurrencyTag>(m_scan, m_axes.noise, m_options.sections, m_tree);
    count();
    m_report.seconds.sections = watch.lap();
    m_stage = 4;
    return true;
  }

  const Scan& scan() const { return m_scan; }
  /// 1 for the points of the scan that may be the tree, else 0.
  const std::vector<std::uint8_t>& used_points() const { return m_used.flags(); }
  const Layer_tree& layers() const { return m_layers; }
  const Axis_set& axes() const { return m_axes; }
  const std::vector<Joint>& joints() const { return m_joints; }
  const Branch_tree& tree() const { return m_tree; }
  const Skeleton_report& report() const { return m_report; }

  /// The node that explains an input point, or `none`.
  Index node_of_input(std::size_t i) const
  {
    return m_tree.node_of_point[m_scan.point_of_input[i]];
  }

  /// The unit vector across its branch from the axis to an input point; null on the axis. It has a node.
  Vec3 normal_of_input(std::size_t i) const
  {
    const Vec3 across = offset_of_point(m_scan, m_tree, m_successors, m_scan.point_of_input[i]);
    const double length = across.norm();
    return length > 0 ? m_scan.frame.direction_to_input(across / length) : Vec3(Vec3::Zero());
  }

  /// Distance of an input point from the surface of its branch; negative inside. It has a node.
  double residual_of_input(std::size_t i) const
  {
    return m_scan.frame.unit *
           residual_of_point(m_scan, m_tree, m_successors, m_scan.point_of_input[i]);
  }

  /// Whether an input point is left out as a leaf, by the caller or because it was found to be one.
  bool is_leaf_of_input(std::size_t i) const { return m_used.is_leaf(m_scan.point_of_input[i]); }

protected: // benchmark/training looks at what leaves are told by
  Links links_of_used() const
  {
    return neighbor_links<ConcurrencyTag>(m_scan, m_used.flags(), m_options.axes.links);
  }

  /// The points that the tree stands on.
  std::vector<Index> points_of_root(const Links& links, const Point_parts& parts) const
  {
    const Session_options& o = m_options;
    if (!o.root)
      return find_root<ConcurrencyTag>(m_scan, m_used.flags(), links, parts, o.up, o.roots);
    return {m_scan.search
                ->nearest_if(m_scan.frame.to_local(*o.root),
                             std::numeric_limits<double>::max(),
                             [&](Index i) { return m_used.flags()[i] != 0; })
                .index};
  }

  /// Finds the root, unless it is known, and the graph of `links` with those that close gaps.
  void link_parts(const Links& links, bool is_root_known, Linked_parts& linked)
  {
    linked.graph.reset(); // large
    const Point_parts parts = connected_parts<ConcurrencyTag>(m_used.flags(), links);
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] {
          if (!is_root_known)
            m_root = points_of_root(links, parts);
        },
        [&] {
          linked.gaps = links_across_gaps(m_scan, m_used.flags(), m_options.axes.links, parts);
          // made where it stays: such graphs are copied, not moved
          linked.graph.reset(new Neighbor_graph(graph_of(m_scan.size(), links, linked.gaps)));
        });
  }

  /// Paths from the root, and their layers. Appends those that close gaps to `links`.
  void trace_paths(Links& links, Linked_parts& linked)
  {
    m_paths = shortest_paths(m_scan, *linked.graph, m_root);
    linked.graph.reset();
    links.insert(links.end(), linked.gaps.begin(), linked.gaps.end());
    m_layers = layer_tree<ConcurrencyTag>(m_scan, links, m_paths);
    merge_ring_arcs<ConcurrencyTag>(m_scan, m_options.rings, m_layers);
  }

  /// The wood among all points, before any of them are left out; empty if nothing is known of it.
  std::vector<std::uint8_t> wood_of_all()
  {
    const bool is_sure = m_options.leaf_removal == Leaf_removal::always;
    Found_wood found = classify_wood_points<ConcurrencyTag>(m_scan,
                                                            m_axes,
                                                            m_used.flags(),
                                                            m_paths,
                                                            is_sure,
                                                            m_options.leaves);
    m_report.is_in_rows = found.is_in_rows;
    m_wood_score = std::move(found.wood_score);
    m_has_leaves = !found.is_wood.empty();
    if (m_has_leaves || m_wood_score.empty())
      return std::move(found.is_wood);
    std::vector<std::uint8_t> result = wood_of_axes();
    for (const Index i : m_root)
      result[i] = 1; // the tree stands where it stood
    const Index trunk = root_axis(m_scan, m_axes, m_root, m_options.root.has_value());
    keep_around<ConcurrencyTag>(m_scan,
                                m_axes.axes[trunk].axis,
                                m_options.leaves.bare_reach,
                                m_used.flags(),
                                result);
    return result;
  }

  /// The points of axes of wood; without leaves, all but what strays from the wood.
  std::vector<std::uint8_t> wood_of_axes() const
  {
    const Leaf_options& rules = m_options.leaves;
    return wood_of_scored_axes<ConcurrencyTag>(
        m_scan,
        m_axes,
        m_used.flags(),
        m_paths,
        m_wood_score,
        m_options.breast_height,
        m_has_leaves ? rules.axis_likeness : rules.bare_axis_likeness,
        m_has_leaves ? std::numeric_limits<double>::infinity() : rules.bare_point_likeness);
  }

  /// Takes the leaves out, or what strays from the wood if there are none, and looks for paths over the rest. `false` if there is
  /// nothing to do.
  bool remove_leaves()
  {
    if (m_axes.axes.empty() || (m_leaf_rounds > 0 && !m_has_leaves))
      return false;
    const std::vector<std::uint8_t> is_wood = m_leaf_rounds > 0 ? wood_of_axes() : wood_of_all();
    const bool has_wood = std::find(is_wood.begin(), is_wood.end(), 1) != is_wood.end();
    if (!has_wood || is_wood == m_used.flags())
      return false;
    m_used.leave_out_leaves(is_wood);
    Links links = links_of_used();
    Linked_parts linked;
    link_parts(links, !m_has_leaves, linked);
    trace_paths(links, linked);
    return true;
  }

  /// The tree of the axes as they are. Returns the one that stands on the root.
  Index join_axes()
  {
    const Index root = root_axis(m_scan, m_axes, m_root, m_options.root.has_value());
    const Axis_joiner joiner(m_axes, m_scan.spacing, m_options.joints);
    m_joints = joiner.template run<ConcurrencyTag>(root);
    m_joints[root].is_reversed = is_root_reversed(m_scan, m_axes.axes[root].axis, m_root);
    m_tree = branch_tree(m_axes, m_joints, root, m_scan.spacing);
    return root;
  }

  /// Takes out of the radii what beams and voxels add to them.
  void correct_widening()
  {
    correct_beam_divergence(m_options.scanners, m_options.beam_width, m_options.beam, m_tree);
    const double step = voxel_size(m_scan, m_options.grid);
    correct_voxel_size(step, m_options.grid, m_tree);
    m_report.voxel_size = m_scan.frame.unit * step;
  }

  void count()
  {
    Skeleton_report& r = m_report;
    const double unit = m_scan.frame.unit;
    r.status = m_tree.nodes.empty() ? Status::nothing_to_do : Status::converged;
    r.number_of_nodes = m_tree.nodes.size();
    r.number_of_branches = m_tree.branches.size();
    r.number_of_unreached_branches = m_tree.number_of_unreached_axes;
    count_unexplained(m_used.flags(), m_axes, m_tree, r);
    m_successors = successors(m_tree);
    r.residual = unit * median_residual(m_scan, m_tree, m_successors);
    report_sizes(m_tree, unit, m_options.up, m_options.breast_height, r);
    if (!m_tree.nodes.empty())
      r.height = std::max(
          r.height,
          unit * (m_used.top_of_leaves(m_options.up) - m_options.up.dot(m_tree.nodes[0].point)));
  }

  std::vector<Vec3> m_input;
  std::vector<std::uint8_t> m_is_wood;     ///< of the input
  std::vector<std::uint8_t> m_may_be_used; ///< for a given skeleton: points before any are left out
  Session_options m_options;
  bool m_are_walls_out = false, m_has_leaves = false;
  int m_stage = 0, m_leaf_rounds = 0, m_regroupings = 0;
  Skeleton_report m_report;
  Scan m_scan;
  Point_labels<ConcurrencyTag> m_used{m_scan, m_report};
  Wall_removal<ConcurrencyTag> m_wall_removal{m_scan, m_options.walls, m_used, m_report};
  std::vector<Index> m_root;
  Shortest_paths m_paths;
  std::vector<float> m_wood_score; ///< of wood, where leaves are left out
  Layer_tree m_layers;
  Axis_set m_axes;
  std::vector<Found_section> m_sections;
  std::vector<Joint> m_joints;
  Branch_tree m_tree;
  std::vector<Index> m_successors; ///< of its nodes
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SESSION_STAGES_H
