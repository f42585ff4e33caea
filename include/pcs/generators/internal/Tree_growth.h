// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The rules by which a virtual tree grows.

#ifndef PCS_GENERATORS_INTERNAL_TREE_GROWTH_H
#define PCS_GENERATORS_INTERNAL_TREE_GROWTH_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/internal/crown_reach.h>
#include <pcs/generators/internal/normal_vector.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/constants.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

using pcs::internal::Random_stream;
using Vector3 = Eigen::Vector3d;

//! returns a unit vector perpendicular to `direction`, the same for the same input
inline Vector3 any_normal(const Vector3& direction)
{
  Eigen::Index least = 0;
  direction.cwiseAbs().minCoeff(&least);
  return direction.cross(Vector3::Unit(least)).normalized();
}

//! rotates `normal` with the change of direction by the smallest possible angle
inline Vector3 transported(const Vector3& normal, const Vector3& direction)
{
  const Vector3 across = normal - normal.dot(direction) * direction;
  return across.squaredNorm() > 1e-12 ? Vector3(across.normalized()) : any_normal(direction);
}

class Tree_growth
{
public:
  Tree_growth(const Tree_habit& habit, std::uint64_t seed) : m_habit(habit), m_seed(seed) {}

  void run()
  {
    Random_stream random(m_seed, 1);
    Bud trunk;
    const double lean_y = m_habit.lean * random.normal();
    const double lean_x = m_habit.lean * random.normal();
    trunk.direction = Vector3(lean_x, lean_y, 1);
    trunk.direction.normalize();
    trunk.radius = m_habit.trunk_radius;
    trunk.length = m_habit.height;
    trunk.kind = Kind::stem;
    trunk.seed = random.bits();
    m_buds.push_back(trunk);
    for (std::size_t i = 0; i < m_buds.size(); ++i)
      grow(Bud(m_buds[i]));
  }

  //! a known axis on which branches grow, from its base to its tip
  struct Given_axis
  {
    std::vector<Vector3> points;
    std::vector<double> at, radii; // lengths from the base, and radii, of the points
    std::size_t parent_node = npos, parent_axis = npos;
    int order = 0;
    bool is_stem = false;
  };

  //! grows branches on known axes, whose nodes and branches come first; parents precede their
  //! branches
  void grow_on(const std::vector<Given_axis>& axes)
  {
    std::vector<std::vector<Place>> places;
    for (const Given_axis& axis : axes) {
      Bud bud;
      bud.parent_node = axis.parent_node;
      bud.parent_branch = axis.parent_axis;
      bud.base = axis.points.front();
      bud.radius = axis.radii.front();
      bud.length = axis.at.back();
      bud.order = axis.order;
      bud.kind = axis.is_stem ? Kind::stem : Kind::branch;
      bud.seed = Random_stream(m_seed, 7, m_buds.size()).bits();
      places.push_back(add_nodes(axis, m_buds.size()));
      m_buds.push_back(bud);
      ++m_next_branch;
    }
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (axes[i].order + 1 < m_habit.number_of_orders)
        sprout(Bud(m_buds[i]), i, places[i]);
    for (std::size_t i = axes.size(); i < m_buds.size(); ++i)
      grow(Bud(m_buds[i]));
  }

  template <class Kernel>
  Tree_skeleton<Kernel> skeleton() const
  {
    using FT = typename Kernel::FT;
    Tree_skeleton<Kernel> tree(m_nodes.size());
    for (std::size_t v = 0; v < m_nodes.size(); ++v) {
      const Node& node = m_nodes[v];
      auto& out = tree[v];
      const Vector3& p = node.point;
      const Vector3& a = node.major_axis;
      out.point = typename Kernel::Point_3(FT(p.x()), FT(p.y()), FT(p.z()));
      out.radius = FT(node.radius);
      const double stretch = std::sqrt(m_buds[node.branch].flatness);
      out.major_radius = FT(node.radius / stretch);
      out.minor_radius = FT(node.radius * stretch);
      out.major_axis = typename Kernel::Vector_3(FT(a.x()), FT(a.y()), FT(a.z()));
      out.is_measured = true;
      out.branch = node.branch;
      if (node.parent != npos)
        add_edge(node.parent, v, tree);
    }
    auto& bundle = tree[boost::graph_bundle];
    bundle.root = 0;
    for (std::size_t b = 0; b < m_buds.size(); ++b)
      bundle.branches.push_back({m_buds[b].parent_branch, m_buds[b].order, b});
    return tree;
  }

private:
  enum class Kind { stem, branch, stub };

  struct Bud
  {
    std::size_t parent_node = npos, parent_branch = npos;
    Vector3 base = Vector3::Zero(), direction = Vector3::UnitZ();
    double radius = 0, length = 0, flatness = 1;
    int order = 0;
    Kind kind = Kind::branch;
    std::uint64_t seed = 0;
  };

  struct Node
  {
    Vector3 point, major_axis;
    double radius;
    std::size_t parent, branch;
  };

  //! a node of the current branch
  struct Place
  {
    std::size_t node;
    Vector3 direction, normal;
    double at, radius; // length from the base
  };

  static constexpr std::size_t largest_number_of_nodes = 10'000'000;

  static std::size_t row(const Bud& bud)
  {
    return bud.kind == Kind::stem ? 0 : std::size_t(std::min(bud.order, 2));
  }
  static std::size_t short_row(const Bud& bud) { return bud.kind == Kind::stem ? 0 : 1; }

  double radius_at(const Bud& bud, double at) const
  {
    const std::size_t i = short_row(bud);
    const double rest = std::max(0.0, 1 - at / bud.length);
    double r = bud.radius;
    if (bud.kind == Kind::stub)
      r *= 0.8 + 0.2 * rest; // broken off, without a tip
    else
      r *= (1 - m_habit.tip_share[i]) * std::pow(rest, m_habit.taper[i]) + m_habit.tip_share[i];
    if (bud.order == 0)
      r *= 1 + m_habit.flare * std::exp(-at / m_habit.flare_height);
    if (bud.order == 0 && m_habit.number_of_leaders > 1 && at > m_habit.fork * bud.length)
      r *= 0.85; // reduced because the wood is divided among the stems
    return std::max(r, m_habit.tip_radius);
  }

  std::vector<Place> add_nodes(const Given_axis& axis, std::size_t branch)
  {
    std::vector<Place> places;
    Vector3 normal = Vector3::UnitX();
    for (std::size_t i = 0; i < axis.points.size(); ++i) {
      const std::size_t to = std::min(i + 1, axis.points.size() - 1);
      const Vector3 direction = (axis.points[to] - axis.points[to - 1]).normalized();
      normal = transported(normal, direction);
      places.push_back({m_nodes.size(), direction, normal, axis.at[i], axis.radii[i]});
      m_nodes.push_back({axis.points[i],
                         normal,
                         axis.radii[i],
                         i > 0 ? m_nodes.size() - 1 : axis.parent_node,
                         branch});
    }
    return places;
  }

  void grow(const Bud& bud)
  {
    const std::size_t branch = m_next_branch++;
    Random_stream random(bud.seed, 2);
    m_buds[branch].flatness = random.uniform(m_habit.flattest_section, 1);
    const std::vector<Place> places = grow_axis(bud, branch, random);
    if (bud.kind == Kind::stub)
      return;
    if (bud.order == 0)
      fork(bud, branch, places);
    if (bud.order + 1 < m_habit.number_of_orders)
      sprout(bud, branch, places);
    if (bud.order == 0)
      add_stubs(bud, branch, places);
  }

  std::vector<Place> grow_axis(const Bud& bud, std::size_t branch, Random_stream& random)
  {
    const std::size_t i = row(bud);
    std::vector<Place> places;
    Vector3 point = bud.base, direction = bud.direction, normal = any_normal(direction);
    const double phase = random.uniform(0, 2 * pcs::internal::pi);
    normal = Eigen::AngleAxisd(phase, direction) * normal;
    Vector3 bend = Vector3::Zero();
    std::size_t parent = bud.parent_node;
    bool do_renew = true;
    for (double at = 0;;) {
      const double radius = radius_at(bud, at);
      check_number(static_cast<double>(m_nodes.size()));
      normal = transported(normal, direction);
      places.push_back({m_nodes.size(), direction, normal, at, radius});
      m_nodes.push_back({point, normal, radius, parent, branch});
      parent = m_nodes.size() - 1;
      if (at >= bud.length)
        return places;
      double step = bud.kind == Kind::stem
                        ? m_habit.largest_step
                        : std::clamp(2 * radius, m_habit.smallest_step, m_habit.largest_step);
      if (at + 1.5 * step > bud.length)
        step = bud.length - at;
      if (do_renew || random.uniform() < m_habit.bend_renewal)
        bend = m_habit.bend[i] * normal_vector(random);
      do_renew = false;
      const double sag = bud.kind == Kind::branch ? m_habit.sag * at / bud.length : 0;
      direction +=
          step / m_habit.bend_length * (bend + (m_habit.tropism[i] - sag) * Vector3::UnitZ());
      direction.normalize();
      point += step * direction;
      at = step == bud.length - at ? bud.length : at + step;
      if (bud.order == 0 && !m_is_forked && m_habit.number_of_leaders > 1 &&
          at >= m_habit.fork * bud.length) {
        // the stems lean apart
        m_is_forked = true;
        m_fork_angle = random.uniform(m_habit.fork_angle.least, m_habit.fork_angle.largest);
        m_fork_axis =
            Eigen::AngleAxisd(random.uniform(0, 2 * pcs::internal::pi), direction) * normal;
        m_fork_direction = direction;
        m_fork_place = places.size();
        direction = Eigen::AngleAxisd(-m_fork_angle / 2, m_fork_axis) * direction;
      }
    }
  }

  //! adds the stems besides the trunk that continue above its fork
  void fork(const Bud& bud, std::size_t branch, const std::vector<Place>& places)
  {
    if (!m_is_forked || m_fork_place >= places.size())
      return;
    const Place& place = places[m_fork_place];
    for (std::size_t k = 1; k < m_habit.number_of_leaders; ++k) {
      Random_stream random(bud.seed, 3, k);
      const double turn = 2 * pcs::internal::pi * double(k - 1) /
                          double(std::max<std::size_t>(m_habit.number_of_leaders, 2));
      const Vector3 axis = Eigen::AngleAxisd(turn, m_fork_direction) * m_fork_axis;
      Bud stem = child(branch, place, bud.order + 1, random);
      stem.direction = Eigen::AngleAxisd(m_fork_angle / 2, axis) * m_fork_direction;
      stem.radius = place.radius * random.uniform(0.8, 0.95);
      stem.length = (bud.length - place.at) * random.uniform(0.85, 1.0);
      stem.kind = Kind::stem;
      m_buds.push_back(stem);
    }
  }

  Bud child(std::size_t branch, const Place& place, int order, Random_stream& random) const
  {
    Bud bud;
    bud.parent_node = place.node;
    bud.parent_branch = branch;
    bud.base = m_nodes[place.node].point;
    bud.order = order;
    bud.seed = random.bits();
    return bud;
  }

  void sprout(const Bud& bud, std::size_t branch, const std::vector<Place>& places)
  {
    constexpr double golden_angle = 2.399963229728653;
    const std::size_t i = row(bud);
    Random_stream random(bud.seed, 4);
    double azimuth = random.uniform(0, 2 * pcs::internal::pi);
    check_number(bud.length / m_habit.spacing[i]);
    const double from = m_habit.bare[i] * bud.length;
    std::size_t place = 0;
    for (double at = from; at < bud.length; at += m_habit.spacing[i] * random.uniform(0.5, 1.5)) {
      while (place + 2 < places.size() &&
             std::abs(places[place + 1].at - at) <= std::abs(places[place].at - at))
        ++place;
      const std::size_t n = bud.kind == Kind::stem ? m_habit.whorl : 1;
      for (std::size_t k = 0; k < n; ++k) {
        const double jitter = 0.3 * random.normal();
        const double turn = azimuth + jitter + 2 * pcs::internal::pi * double(k) / double(n);
        add_branch(bud, branch, places[place], turn, (at - from) / (bud.length - from), random);
      }
      azimuth += golden_angle;
    }
  }

  void add_branch(const Bud& parent,
                  std::size_t branch,
                  const Place& place,
                  double azimuth,
                  double share,
                  Random_stream& parent_random)
  {
    const std::size_t i = short_row(parent);
    Random_stream random(parent_random.bits(), 5);
    Bud bud = child(branch, place, parent.order + 1, random);
    const Value_range& insertion = m_habit.insertion[i];
    const double angle = random.uniform(insertion.least, insertion.largest);
    const Vector3 across = Eigen::AngleAxisd(azimuth, place.direction) * place.normal;
    bud.direction = std::cos(angle) * place.direction + std::sin(angle) * across;
    const Value_range& radius = m_habit.child_radius[i];
    bud.radius = place.radius * random.uniform(radius.least, radius.largest);
    const Value_range& slenderness = m_habit.slenderness;
    const double slender = random.uniform(slenderness.least, slenderness.largest);
    const double full = random.uniform(0.8, 1.05);
    if (parent.kind == Kind::stem) {
      bud.radius = std::min(bud.radius, m_habit.largest_branch);
      bud.length = std::min(slender * bud.radius,
                            full * crown_reach(m_habit.crown, m_habit.crown_radius, share));
      // branches shortened by the crown are thinner as well
      bud.radius = std::min(bud.radius, bud.length / (0.6 * slenderness.least));
    } else {
      bud.length = std::min(slender * bud.radius, 0.9 * full * (parent.length - 0.6 * place.at));
    }
    // branches that end inside their parent are omitted
    if (bud.radius >= m_habit.smallest_branch && bud.length > 1.5 * place.radius &&
        bud.length >= 2 * m_habit.smallest_step) {
      check_number(static_cast<double>(m_buds.size()));
      m_buds.push_back(bud);
    }
  }

  /// Checks a number of nodes, or of branches that are not yet grown.
  void check_number(double number) const
  {
    using pcs::internal::to_text;
    if (!(number < static_cast<double>(largest_number_of_nodes)))
      throw Invalid_input("pcs::grow_tree(): the tree would have more than " +
                          std::to_string(largest_number_of_nodes) +
                          " nodes: its trunk has the length " + to_text(m_habit.height) +
                          ", and its branches are " + to_text(m_habit.spacing[0]) +
                          " apart; use one unit for all lengths, or a smaller height");
  }

  void add_stubs(const Bud& trunk, std::size_t branch, const std::vector<Place>& places)
  {
    for (std::size_t k = 0; k < m_habit.number_of_stubs; ++k) {
      Random_stream random(trunk.seed, 6, k);
      const double share = random.uniform(0.3, 1) * std::max(0.1, m_habit.bare[0]);
      const auto i = static_cast<std::size_t>(share * static_cast<double>(places.size() - 1));
      const Place& place = places[i];
      Bud bud = child(branch, place, trunk.order + 1, random);
      const double azimuth = random.uniform(0, 2 * pcs::internal::pi);
      const Vector3 across = Eigen::AngleAxisd(azimuth, place.direction) * place.normal;
      bud.direction = (0.4 * place.direction + across).normalized();
      bud.radius = std::max(m_habit.tip_radius, place.radius * random.uniform(0.1, 0.2));
      bud.length = place.radius + bud.radius * random.uniform(4, 10);
      bud.kind = Kind::stub;
      m_buds.push_back(bud);
    }
  }

  Tree_habit m_habit;
  std::uint64_t m_seed;
  std::vector<Bud> m_buds; // one for each branch
  std::vector<Node> m_nodes;
  std::size_t m_next_branch = 0;
  bool m_is_forked = false;
  double m_fork_angle = 0;
  Vector3 m_fork_axis = Vector3::UnitX(), m_fork_direction = Vector3::UnitZ();
  std::size_t m_fork_place = 0;
};

} // namespace internal
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_INTERNAL_TREE_GROWTH_H
