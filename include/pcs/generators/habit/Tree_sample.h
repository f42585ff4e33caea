// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The branches of one tree skeleton as samples of a habit: axes, radii, and places on the parents.

#ifndef PCS_GENERATORS_HABIT_TREE_SAMPLE_H
#define PCS_GENERATORS_HABIT_TREE_SAMPLE_H

#include <pcs/core/Tree_skeleton.h>

#include <CGAL/number_utils.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

using Vector3 = Eigen::Vector3d;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A stem is the trunk or a leader above its fork; a stub is a short blunt branch of the trunk.
enum class Axis_kind { stem, branch, stub };

/// One branch, from the axis of its parent to its tip.
struct Axis
{
  std::size_t parent = npos; ///< in `Tree_sample::axes`
  int order = 0;
  Axis_kind kind = Axis_kind::branch;
  std::vector<Vector3> points;
  std::vector<double> at, radius; ///< length from the base, and radius, of each point [L]
  std::vector<std::size_t> nodes; ///< of the skeleton, for each point
  double error = 0;               ///< relative standard error of the radii [-]
  double flatness = unknown;      ///< ratio of the half axes of the section [-]

  double place_at = 0, place_radius = 0; ///< on the parent: length from its base, and radius [L]
  std::size_t place = npos;              ///< the point of the parent
  double insertion = unknown;            ///< angle to the parent [rad]
  bool is_cut = false;                   ///< ends blunt, so its length is a lower bound

  double length() const { return at.back(); }
  double base_radius() const { return radius.front(); }
  /// The first point that is outside of the parent, but leaves four points of the axis.
  std::size_t first_outside() const
  {
    std::size_t i = 0;
    while (i + 4 < at.size() && at[i] < place_radius)
      ++i;
    return i;
  }
  /// Index of `spacing`, `bare`, `bend` and `tropism`.
  std::size_t row() const
  {
    return kind == Axis_kind::stem ? 0 : static_cast<std::size_t>(std::min(order, 2));
  }
  /// Index of `taper`, `tip_share`, `insertion` and `child_radius`.
  std::size_t short_row() const { return kind == Axis_kind::stem ? 0 : 1; }
};

/// A tree; `axes[0]` is its trunk, and parents precede their branches.
struct Tree_sample
{
  std::vector<Axis> axes;
  double size = 1; ///< length of the trunk, relative to the mean of all trees
};

/// Reads the branches of a skeleton. The part of a branch that is thinner than `smallest_radius` is
/// left out, with all that it carries.
template <class Kernel>
class Sample_reader
{
public:
  Sample_reader(const Tree_skeleton<Kernel>& tree, double smallest_radius)
    : m_tree(tree),
      m_smallest(smallest_radius),
      m_nodes(nodes_by_branch<Kernel>(tree)),
      m_axis(num_vertices(tree), npos),
      m_index(num_vertices(tree), npos)
  {
  }

  Tree_sample operator()()
  {
    const std::size_t root = m_tree[boost::graph_bundle].root;
    if (root == npos)
      return {};
    std::vector<std::vector<std::size_t>> children(m_nodes.size());
    for (std::size_t b = 0; b < m_nodes.size(); ++b)
      if (!m_nodes[b].empty()) {
        const std::size_t carrier = parent_node<Kernel>(m_nodes[b].front(), m_tree);
        if (carrier != npos)
          children[m_tree[carrier].branch].push_back(b);
      }
    std::vector<std::size_t> order = {m_tree[root].branch};
    for (std::size_t i = 0; i < order.size(); ++i)
      if (add(m_nodes[order[i]]))
        order.insert(order.end(), children[order[i]].begin(), children[order[i]].end());
    classify();
    return std::move(m_result);
  }

private:
  Vector3 point(std::size_t v) const
  {
    return {CGAL::to_double(m_tree[v].point.x()),
            CGAL::to_double(m_tree[v].point.y()),
            CGAL::to_double(m_tree[v].point.z())};
  }

  /// Adds a branch if it has a length, and its place on its parent is known.
  bool add(const std::vector<std::size_t>& nodes)
  {
    const std::size_t carrier = parent_node<Kernel>(nodes.front(), m_tree);
    if (carrier != npos && m_axis[carrier] == npos)
      return false;
    Axis axis;
    double errors = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto& node = m_tree[nodes[i]];
      const double radius = CGAL::to_double(node.radius);
      if (!(radius > 0 && radius >= m_smallest))
        break;
      const Vector3 p = point(nodes[i]);
      const Vector3 before = i > 0 ? axis.points.back() : carrier != npos ? point(carrier) : p;
      const double step = (p - before).norm();
      if (i > 0 && step == 0)
        continue;
      axis.at.push_back((i > 0 ? axis.at.back() : 0) + step);
      axis.points.push_back(p);
      axis.radius.push_back(radius);
      axis.nodes.push_back(nodes[i]);
      errors += CGAL::to_double(node.radius_error) / radius;
      m_index[nodes[i]] = axis.points.size() - 1;
    }
    if (axis.points.size() < 2)
      return false;
    axis.error = errors / static_cast<double>(axis.points.size());
    read_section(nodes.front(), axis);
    if (carrier != npos)
      attach(carrier, axis);
    for (const std::size_t v : nodes)
      if (m_index[v] != npos)
        m_axis[v] = m_result.axes.size();
    m_result.axes.push_back(std::move(axis));
    return true;
  }

  void read_section(std::size_t v, Axis& axis) const
  {
    const double major = CGAL::to_double(m_tree[v].major_radius);
    const double minor = CGAL::to_double(m_tree[v].minor_radius);
    if (minor > 0 && major > minor)
      axis.flatness = minor / major;
  }

  void attach(std::size_t carrier, Axis& axis) const
  {
    axis.parent = m_axis[carrier];
    axis.place = m_index[carrier];
    const Axis& parent = m_result.axes[axis.parent];
    axis.order = parent.order + 1;
    axis.place_at = parent.at[axis.place];
    axis.place_radius = parent.radius[axis.place];
    const std::size_t from = std::max<std::size_t>(axis.place, 1);
    const Vector3 along = parent.points[from] - parent.points[from - 1];
    // a chord of a few edges averages errors of positions; its bend is part of the simulation
    const std::size_t first = axis.first_outside();
    const std::size_t to = std::min(first + 3, axis.points.size() - 1);
    const Vector3 chord = axis.points[to] - axis.points[first];
    axis.insertion = std::atan2(along.cross(chord).norm(), along.dot(chord));
  }

  /// Finds the leaders, the stubs, and the branches that end blunt.
  void classify()
  {
    std::vector<Axis>& axes = m_result.axes;
    if (axes.empty())
      return;
    Axis& trunk = axes.front();
    trunk.kind = Axis_kind::stem;
    double thinnest = trunk.radius.back();
    for (const Axis& a : axes)
      thinnest = std::min(thinnest, a.radius.back());
    for (std::size_t i = 1; i < axes.size(); ++i) {
      Axis& a = axes[i];
      const double tip = a.radius.back() / a.base_radius();
      const bool is_thick = a.base_radius() > 2 * thinnest;
      if (a.parent == 0 && a.base_radius() > 0.7 * a.place_radius &&
          a.base_radius() > 0.4 * trunk.base_radius() &&
          a.length() > 0.5 * (trunk.length() - a.place_at))
        a.kind = Axis_kind::stem;
      else if (a.parent == 0 && tip > 0.7 && is_thick && a.length() < 25 * a.base_radius())
        a.kind = Axis_kind::stub;
      a.is_cut = a.kind == Axis_kind::stub || (tip > 0.5 && a.radius.back() > 2 * thinnest);
    }
  }

  const Tree_skeleton<Kernel>& m_tree;
  const double m_smallest;
  const std::vector<std::vector<std::size_t>> m_nodes;
  std::vector<std::size_t> m_axis, m_index; // of each node, in the sample
  Tree_sample m_result;
};

template <class Kernel>
Tree_sample read_sample(const Tree_skeleton<Kernel>& tree, double smallest_radius)
{
  return Sample_reader<Kernel>(tree, smallest_radius)();
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_TREE_SAMPLE_H
