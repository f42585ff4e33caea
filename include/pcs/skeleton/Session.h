// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The stages of a skeletonization, one after the other, with all that they leave behind.

#ifndef PCS_SKELETON_SESSION_H
#define PCS_SKELETON_SESSION_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Branch_tree.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/mark_walls.h>
#include <pcs/skeleton/regroup_axes.h>
#include <pcs/skeleton/report_sizes.h>
#include <pcs/skeleton/root_axis.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Runs the stages in order; each runs those before it that have not run yet, and stops when cancelled.
template <class ConcurrencyTag>
class Session
{
public:
  /// `input` is finite, with at least two different points; `is_wood` is empty or has one entry per point.
  Session(std::vector<Vec3> input, std::vector<std::uint8_t> is_wood, Session_options options)
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
    prepare_scan<ConcurrencyTag>(m_input, m_options.up, m_scan);
    const double unit = m_scan.frame.unit;
    m_options.up = Vec3::UnitZ(); // from here on, all is in coordinates of the scan
    m_options.breast_height /= unit;
    const std::size_t n = m_scan.size();
    m_point_of_input = m_scan.point_of_input;
    std::vector<std::uint8_t> is_wood(n, m_is_wood.empty());
    for (std::size_t i = 0; i < m_is_wood.size(); ++i)
      is_wood[m_scan.point_of_input[i]] |= m_is_wood[i];
    m_is_used.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      m_is_used[i] = is_wood[i] && !m_scan.is_outlier[i];
    if (std::find(m_is_used.begin(), m_is_used.end(), 1) == m_is_used.end())
      m_is_used = is_wood; // all are far from each other: better these than none
    for (std::size_t i = 0; i < n; ++i)
      m_scan.is_outlier[i] = !m_is_used[i];
    std::vector<Vec3>().swap(m_input);
    m_is_leaf.resize(n);
    m_is_found_leaf.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i)
      m_is_leaf[i] = !is_wood[i];
    m_report.number_of_duplicates = m_report.number_of_points - n;
    const auto number_of = [](const std::vector<std::uint8_t>& flags, std::uint8_t value) {
      return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), value));
    };
    m_report.number_of_leaf_points = number_of(is_wood, 0);
    m_report.number_of_outliers = number_of(m_scan.is_outlier, 1) - m_report.number_of_leaf_points;
    m_report.spacing = unit * m_scan.spacing;
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
    if (m_options.given) {
      m_stage = 2;
      return progress(0.6);
    }
    if (!m_are_walls_out) { // when stopped below, they are
      if (m_options.do_mark_ground && is_one_sheet(m_scan, m_is_used, m_options.ground.sheet)) {
        m_report.number_of_ground_points =
            static_cast<std::size_t>(std::count(m_is_used.begin(), m_is_used.end(), 1));
        std::fill(m_is_used.begin(), m_is_used.end(), std::uint8_t(0));
        m_stage = 2;
        return progress(0.6);
      }
      leave_out_faces(true);
    }
    m_are_walls_out = true;
    std::vector<Link> links = links_of_used();
    std::vector<Link> gaps;
    const auto find_root_and_gaps = [&] {
      m_root = root_points(links);
      gaps = links_across_gaps(m_scan, m_is_used, m_options.axes.links, links);
    };
    // most scans have no ground, and what is found meanwhile stays
    std::vector<std::uint8_t> is_above = m_is_used;
    std::size_t ground = 0;
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] {
          if (m_options.do_mark_ground)
            ground = mark_ground(m_scan, links, m_options.up, m_options.ground, is_above);
        },
        find_root_and_gaps);
    if (!progress(0.42))
      return false; // the ground is not left out yet
    m_report.number_of_ground_points = ground;
    if (ground > 0) {
      leave_out(std::move(is_above));
      links = links_of_used();
    }
    const bool may_have_faces = m_has_faces || ground > 0; // if not, they were looked for already
    if ((may_have_faces && leave_out_rest_of_faces(links)) || ground > 0)
      find_root_and_gaps();
    links.insert(links.end(), gaps.begin(), gaps.end());
    trace_paths(links);
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
    if (m_root.empty()) { // nothing is a tree, or it is known
      m_stage = 3;
      return progress(0.9);
    }
    if (m_options.method == Skeleton_method::sections) {
      const std::vector<Surface_frame> frames = principal_curvatures<ConcurrencyTag>(m_scan);
      if (!progress(0.7))
        return false;
      m_sections = detect_sections(m_scan, m_is_used, frames, m_options.slices);
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
      reclaim();
    fuse_axes<ConcurrencyTag>(m_scan.spacing, m_options.fusion, m_axes);
    const double unit = m_scan.frame.unit;
    m_report.noise = unit * m_axes.noise;
    m_report.density = m_axes.density / (unit * unit);
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
    if (m_options.given) {
      m_tree = measure_given(m_scan, m_is_used, *m_options.given, m_options.given_rules);
    } else if (m_options.method == Skeleton_method::sections && !m_root.empty()) {
      m_tree = section_skeleton(m_scan, m_is_used, m_sections, m_root, m_options.section_tree);
      correct_beam(m_options.scanners, m_options.beam_width, m_options.beam, m_tree);
      count();
      m_report.seconds.joints = watch.lap();
      m_stage = 4;
      return progress(0.97);
    }
    if (!m_axes.axes.empty()) { // none with a given skeleton
      Index root = join_axes();
      while (m_regroupings + 1 < m_options.joints.rounds) {
        if (!progress(0.9 + 0.05 * (m_regroupings + 1) / m_options.joints.rounds))
          return false;
        regroup_axes(m_tree, m_axes);
        fuse_axes<ConcurrencyTag>(m_scan.spacing, m_options.fusion, m_axes);
        ++m_regroupings; // stopped from here on, the work goes on with these axes
        root = join_axes();
      }
      if (!progress(0.95))
        return false;
      prune_stubs(m_scan.spacing, m_options.stubs, m_tree);
      const Section_support support =
          support_of_sections<ConcurrencyTag>(m_scan, m_tree, m_axes.noise, m_options.support);
      if (m_leaf_rounds > 0) // what is left of leaves makes twigs thick
        m_options.support.pipes.slack = m_options.leaves.pipe_slack;
      bound_radii(m_scan, support, m_axes.density, m_options.support, m_tree);
      mend_foot(m_scan,
                m_is_used,
                support,
                m_axes.density,
                m_options.support,
                m_options.foot,
                m_tree);
      m_report.number_of_other_stems =
          count_other_stems(m_axes, m_joints, root, m_tree, m_options.stems);
    }
    m_report.seconds.joints = watch.lap();
    if (!progress(0.97))
      return false;
    correct_beam(m_options.scanners, m_options.beam_width, m_options.beam, m_tree);
    estimate_sections<ConcurrencyTag>(m_scan, m_axes.noise, m_options.sections, m_tree);
    count();
    m_report.seconds.sections = watch.lap();
    m_stage = 4;
    return true;
  }

  const Scan& scan() const { return m_scan; }
  const std::vector<std::uint8_t>& is_used() const { return m_is_used; }
  const std::vector<Index>& root() const { return m_root; }
  const Shortest_paths& paths() const { return m_paths; }
  const Layer_tree& layers() const { return m_layers; }
  const Axis_set& axes() const { return m_axes; }
  const std::vector<Found_section>& sections() const { return m_sections; }
  const std::vector<Joint>& joints() const { return m_joints; }
  const Branch_tree& tree() const { return m_tree; }
  const Skeleton_report& report() const { return m_report; }
  Skeleton_report& report() { return m_report; }

  /// The node that explains an input point, or `none`.
  Index node_of_input(std::size_t i) const { return m_tree.node_of_point[m_point_of_input[i]]; }

  /// The unit vector across its branch from the axis to an input point; null on the axis. It has a node.
  Vec3 normal_of_input(std::size_t i) const
  {
    const Index p = m_point_of_input[i];
    const Vec3& point = m_scan.points[p];
    Vec3 across;
    if (m_options.method == Skeleton_method::chains && !m_options.given) {
      const Axis& axis = m_axes.axes[m_axes.axis_of_point[p]].axis;
      across = point - point_at(axis, nearest_place(axis, m_axes.segment_of_point[p], point));
    } else {
      const Branch_node& node = m_tree.nodes[m_tree.node_of_point[p]];
      const Vec3& base = node.parent == none ? node.point : m_tree.nodes[node.parent].point;
      const Vec3 along = node.point - base;
      const double length2 = along.squaredNorm();
      const double t = length2 > 0 ? (point - base).dot(along) / length2 : 0;
      across = point - base - std::min(1.0, std::max(0.0, t)) * along;
    }
    const double length = across.norm();
    return length > 0 ? m_scan.frame.direction_to_input(across / length) : Vec3(Vec3::Zero());
  }

  /// Distance of an input point from the surface of its branch; negative inside. It has a node.
  double residual_of_input(std::size_t i) const
  {
    return m_scan.frame.unit * residual_of_point(m_point_of_input[i]);
  }

  /// Whether an input point is left out as a leaf, by the caller or because it was found to be one.
  bool is_leaf_of_input(std::size_t i) const { return m_is_leaf[m_point_of_input[i]] != 0; }

private:
  std::vector<Link> links_of_used() const
  {
    return neighbor_links<ConcurrencyTag>(m_scan, m_is_used, m_options.axes.links);
  }

  /// The others stay where they are, for distances, and count as outliers.
  void use_only(const std::vector<std::uint8_t>& is_used)
  {
    m_is_used = is_used;
    for (std::size_t i = 0; i < m_scan.size(); ++i)
      m_scan.is_outlier[i] = !m_is_used[i];
  }

  /// Takes walls and roofs out, or all faces. Returns whether there are any.
  bool leave_out_faces(bool are_walls)
  {
    if (!m_options.do_mark_ground)
      return false;
    std::vector<Flat_face> faces = flat_faces(m_scan, m_options.walls, m_is_used);
    m_has_faces = !faces.empty();
    if (are_walls)
      faces = walls_and_roofs(m_scan, faces, m_options.up, m_options.walls, m_is_used);
    std::vector<std::uint8_t> is_part = m_is_used;
    const std::size_t marked = mark_faces(m_scan, faces, is_part);
    if (!leave_out_walls(marked, is_part))
      return false;
    m_faces.insert(m_faces.end(), faces.begin(), faces.end());
    return true;
  }

  /// Leaves all but `is_part` out, if that is anything. Returns whether it did.
  bool leave_out_walls(std::size_t marked, const std::vector<std::uint8_t>& is_part)
  {
    const auto left = static_cast<std::size_t>(std::count(is_part.begin(), is_part.end(), 1));
    if (marked == 0 || double(left) < m_options.walls.least * double(left + marked))
      return false;
    m_report.number_of_wall_points += marked;
    leave_out(is_part);
    return true;
  }

  /// The other faces, and what is left beside them. `links` are those between the used points, also afterwards. Returns
  /// whether there is any.
  bool leave_out_rest_of_faces(std::vector<Link>& links)
  {
    bool is_found = false;
    for (int round = 1; round < m_options.walls.rounds && leave_out_faces(false); ++round)
      is_found = true;
    if (is_found)
      links = links_of_used();
    std::vector<std::uint8_t> is_part = m_is_used;
    const std::size_t marked = mark_beside_faces(m_scan, m_faces, links, m_options.walls, is_part);
    if (leave_out_walls(marked, is_part)) {
      links = links_of_used();
      is_found = true;
    }
    return is_found;
  }

  /// What is left of the scan has a spacing and more outliers of its own.
  void leave_out(std::vector<std::uint8_t> is_above)
  {
    measure_part<ConcurrencyTag>(is_above, m_scan);
    const auto outliers =
        static_cast<std::size_t>(std::count(m_scan.is_outlier.begin(), m_scan.is_outlier.end(), 1));
    if (outliers < static_cast<std::size_t>(std::count(is_above.begin(), is_above.end(), 1))) {
      for (std::size_t i = 0; i < m_scan.size(); ++i)
        is_above[i] = is_above[i] && !m_scan.is_outlier[i];
      m_report.number_of_outliers += outliers;
    }
    use_only(is_above);
    m_report.spacing = m_scan.frame.unit * m_scan.spacing;
  }

  /// Paths from the root, and their layers. `links` close gaps, too.
  void trace_paths(const std::vector<Link>& links)
  {
    {
      const Neighbor_graph graph = graph_of(m_scan.size(), links);
      m_paths = shortest_paths(m_scan, graph, m_root);
    }
    m_layers = layer_tree(m_scan, links, m_paths);
    merge_rings(m_scan, m_options.rings, m_layers);
  }

  /// Takes the leaves out, and looks for paths over the rest. `false` if there is nothing to do.
  bool remove_leaves()
  {
    if (m_axes.axes.empty())
      return false;
    const bool is_sure = m_options.leaf_removal == Leaf_removal::always;
    const std::vector<std::uint8_t> is_wood =
        m_leaf_rounds > 0
            ? wood_by_axes<ConcurrencyTag>(m_scan,
                                           m_axes,
                                           m_is_used,
                                           m_options.breast_height,
                                           m_options.leaves)
            : wood_by_points<ConcurrencyTag>(m_scan, m_axes, m_is_used, is_sure, m_options.leaves);
    const bool has_wood = std::find(is_wood.begin(), is_wood.end(), 1) != is_wood.end();
    if (!has_wood || is_wood == m_is_used)
      return false;
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_used[i] && !is_wood[i]) {
        m_is_leaf[i] = m_is_found_leaf[i] = 1;
        ++m_report.number_of_leaf_points;
      }
    use_only(is_wood);
    std::vector<Link> links = links_of_used();
    m_root = root_points(links);
    const std::vector<Link> gaps =
        links_across_gaps(m_scan, m_is_used, m_options.axes.links, links);
    links.insert(links.end(), gaps.begin(), gaps.end());
    trace_paths(links);
    return true;
  }

  /// What lies on the surfaces is no leaf.
  void reclaim()
  {
    m_report.number_of_leaf_points -=
        reclaim_points<ConcurrencyTag>(m_scan, m_options.axes.chains, m_is_found_leaf, m_axes);
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_leaf[i] && m_axes.is_covered(i)) {
        m_is_leaf[i] = 0;
        m_is_used[i] = 1;
        m_scan.is_outlier[i] = 0;
      }
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

  double residual_of_point(Index p) const
  {
    const Index v = m_tree.node_of_point[p];
    if (m_options.method == Skeleton_method::chains && !m_options.given)
      return m_axes.height_above(p, m_scan.points[p]);
    const Branch_node& node = m_tree.nodes[v];
    const Branch_node& below = m_tree.nodes[node.parent == none ? v : node.parent];
    const Vec3 d = node.point - below.point, q = m_scan.points[p] - below.point;
    const double t =
        d.squaredNorm() > 0 ? std::min(1.0, std::max(0.0, q.dot(d) / d.squaredNorm())) : 1;
    return (q - t * d).norm() - (1 - t) * below.radius - t * node.radius;
  }

  std::vector<Index> root_points(const std::vector<Link>& links) const
  {
    if (!m_options.root)
      return find_root(m_scan, m_is_used, links, m_options.up, m_options.roots);
    const auto found = m_scan.search->nearest_if(m_scan.frame.to_local(*m_options.root),
                                                 std::numeric_limits<double>::max(),
                                                 [&](Index i) { return m_is_used[i] != 0; });
    return {found.index};
  }

  void count()
  {
    Skeleton_report& r = m_report;
    const double unit = m_scan.frame.unit;
    r.status = m_tree.nodes.empty() ? Status::nothing_to_do : Status::converged;
    r.number_of_nodes = m_tree.nodes.size();
    r.number_of_branches = m_tree.branches.size();
    r.number_of_unreached_branches = m_tree.number_of_unreached_axes;
    for (std::size_t i = 0; i < m_scan.size(); ++i) {
      if (!m_is_used[i])
        continue;
      const bool has_node = !m_tree.node_of_point.empty() && m_tree.node_of_point[i] != none;
      const bool is_covered =
          has_node || (!m_axes.axis_of_point.empty() && m_axes.is_covered(static_cast<Index>(i)));
      r.number_of_unexplained_points += !is_covered;
      r.number_of_unreached_points += is_covered && !has_node;
    }
    r.residual = unit * median_residual();
    report_sizes(m_tree, unit, m_options.up, m_options.breast_height, r);
    if (!m_tree.nodes.empty())
      r.height =
          std::max(r.height, unit * (top_of_leaves() - m_options.up.dot(m_tree.nodes[0].point)));
  }

  /// Height of the highest leaves that were found, but for one in a thousand; the lowest number without.
  double top_of_leaves() const
  {
    std::vector<double> heights;
    for (std::size_t i = 0; i < m_scan.size(); ++i)
      if (m_is_found_leaf[i])
        heights.push_back(m_options.up.dot(m_scan.points[i]));
    if (heights.empty())
      return std::numeric_limits<double>::lowest();
    const auto at = heights.end() - 1 - static_cast<std::ptrdiff_t>(heights.size() / 1000);
    std::nth_element(heights.begin(), at, heights.end());
    return *at;
  }

  /// Of some ten thousand points spread over all.
  double median_residual() const
  {
    std::vector<double> distances;
    constexpr std::size_t enough = 20000;
    const std::size_t n = m_tree.node_of_point.size(), step = 1 + n / enough;
    for (std::size_t i = 0; i < n; i += step)
      if (m_tree.node_of_point[i] != none)
        distances.push_back(std::abs(residual_of_point(static_cast<Index>(i))));
    return median(distances);
  }

  std::vector<Vec3> m_input;
  std::vector<std::uint8_t> m_is_wood, m_is_used;
  std::vector<std::uint8_t> m_is_leaf, m_is_found_leaf; ///< the second: not by `wood_map`
  Session_options m_options;
  int m_stage = 0, m_leaf_rounds = 0, m_regroupings = 0;
  Scan m_scan;
  std::vector<Index> m_point_of_input, m_root;
  Shortest_paths m_paths;
  Layer_tree m_layers;
  std::vector<Flat_face> m_faces; ///< that are left out
  bool m_are_walls_out = false, m_has_faces = false;
  Axis_set m_axes;
  std::vector<Found_section> m_sections;
  std::vector<Joint> m_joints;
  Branch_tree m_tree;
  Skeleton_report m_report;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SESSION_H
