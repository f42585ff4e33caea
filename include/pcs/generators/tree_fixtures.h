// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Simple trees of known geometry: cylinder, cone, arc of a torus, oblique ellipse, fork, twigs.

#ifndef PCS_GENERATORS_TREE_FIXTURES_H
#define PCS_GENERATORS_TREE_FIXTURES_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

template <class Kernel>
class Fixture
{
public:
  //! adds a branch along the points; the first node coincides with the node of the parent
  void add(std::size_t parent,
           const std::vector<Eigen::Vector3d>& points,
           double radius,
           double tip_radius,
           double flatness = 1,
           const Eigen::Vector3d& major_axis = Eigen::Vector3d::Zero())
  {
    using FT = typename Kernel::FT;
    using Vector_3 = typename Kernel::Vector_3;
    auto& bundle = tree[boost::graph_bundle];
    const std::size_t b = bundle.branches.size();
    Tree_branch branch;
    branch.id = b;
    if (parent != npos) {
      branch.parent = tree[parent].branch;
      branch.order = bundle.branches[branch.parent].order + 1;
    } else {
      bundle.root = 0;
    }
    bundle.branches.push_back(branch);
    const double n = static_cast<double>(points.size() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double t = n > 0 ? static_cast<double>(i) / n : 0;
      const double r = (1 - t) * radius + t * tip_radius;
      Tree_node<Kernel> node;
      node.point =
          typename Kernel::Point_3(FT(points[i].x()), FT(points[i].y()), FT(points[i].z()));
      node.radius = FT(r);
      node.major_radius = FT(r / std::sqrt(flatness));
      node.minor_radius = FT(r * std::sqrt(flatness));
      node.major_axis = Vector_3(FT(major_axis.x()), FT(major_axis.y()), FT(major_axis.z()));
      node.is_measured = true;
      node.branch = b;
      const std::size_t v = add_vertex(node, tree);
      if (parent != npos)
        add_edge(parent, v, tree);
      parent = v;
    }
  }

  void add_straight(std::size_t parent,
                    const Eigen::Vector3d& from,
                    const Eigen::Vector3d& to,
                    double radius,
                    double tip_radius,
                    double flatness = 1,
                    const Eigen::Vector3d& major_axis = Eigen::Vector3d::Zero())
  {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i <= number_of_steps; ++i)
      points.emplace_back(from + double(i) / number_of_steps * (to - from));
    add(parent, points, radius, tip_radius, flatness, major_axis);
  }

  static constexpr int number_of_steps = 20;
  Tree_skeleton<Kernel> tree;
};

inline void check_fixture(std::initializer_list<double> lengths, const char* caller)
{
  for (const double length : lengths)
    if (!(length > 0) || !std::isfinite(length))
      throw Invalid_input(std::string("pcs::") + caller + "(): all lengths must be positive");
}

} // namespace internal
} // namespace generators

//! \ingroup PkgPcsGeneratorsRef
//! an upright cone of height `height` with its axis on the z-axis; equal radii give a cylinder
template <class Kernel>
Tree_skeleton<Kernel> make_cone_tree(double height, double radius, double tip_radius)
{
  generators::internal::check_fixture({height, radius, tip_radius}, "make_cone_tree");
  generators::internal::Fixture<Kernel> f;
  f.add_straight(npos, {0, 0, 0}, {0, 0, height}, radius, tip_radius);
  return f.tree;
}

//! \ingroup PkgPcsGeneratorsRef
//! an upright cylinder with its axis on the z-axis
template <class Kernel>
Tree_skeleton<Kernel> make_cylinder_tree(double height, double radius)
{
  generators::internal::check_fixture({height, radius}, "make_cylinder_tree");
  return make_cone_tree<Kernel>(height, radius, radius);
}

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief an arc of a torus that begins upright at the origin and bends towards +x.

  \param bend_radius of the axis, which is a circle around `(bend_radius, 0, 0)`; larger than
      `radius`
  \param angle of the arc, in (0, pi] [rad]
*/
template <class Kernel>
Tree_skeleton<Kernel> make_torus_arc_tree(double bend_radius, double radius, double angle)
{
  generators::internal::check_fixture({bend_radius, radius, angle, bend_radius - radius},
                                      "make_torus_arc_tree");
  if (angle > 3.15)
    throw Invalid_input("pcs::make_torus_arc_tree(): `angle` must not be larger than pi");
  std::vector<Eigen::Vector3d> points;
  constexpr int n = 64;
  for (int i = 0; i <= n; ++i) {
    const double a = angle * i / n;
    points.emplace_back(bend_radius * (1 - std::cos(a)), 0, bend_radius * std::sin(a));
  }
  generators::internal::Fixture<Kernel> f;
  f.add(npos, points, radius, radius);
  return f.tree;
}

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief a leaning cylinder with an elliptic section; the longer half axis is along y.

  \param tilt of the axis from the z-axis towards +x, in [0, pi / 2) [rad]
  \param flatness ratio of the shorter and the longer half axis, in (0, 1]
*/
template <class Kernel>
Tree_skeleton<Kernel>
make_oblique_ellipse_tree(double length, double radius, double tilt, double flatness)
{
  generators::internal::check_fixture({length, radius, flatness}, "make_oblique_ellipse_tree");
  if (flatness > 1 || !(tilt >= 0 && tilt < 1.5707))
    throw Invalid_input("pcs::make_oblique_ellipse_tree(): `flatness` must be at most 1, `tilt` in "
                        "[0, pi / 2)");
  generators::internal::Fixture<Kernel> f;
  f.add_straight(npos,
                 {0, 0, 0},
                 {length * std::sin(tilt), 0, length * std::cos(tilt)},
                 radius,
                 radius,
                 flatness,
                 Eigen::Vector3d::UnitY());
  return f.tree;
}

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief a Y: a stem of length `length` that continues, and a branch that leaves its upper end.

  \param angle between the two arms [rad]
  \param branch_radius of the branch; the stem has `radius`
*/
template <class Kernel>
Tree_skeleton<Kernel>
make_fork_tree(double length, double radius, double branch_radius, double angle)
{
  generators::internal::check_fixture({length, radius, branch_radius, angle}, "make_fork_tree");
  generators::internal::Fixture<Kernel> f;
  std::vector<Eigen::Vector3d> points;
  constexpr int n = generators::internal::Fixture<Kernel>::number_of_steps;
  const Eigen::Vector3d fork(0, 0, length);
  const Eigen::Vector3d left(-std::sin(angle / 2), 0, std::cos(angle / 2));
  const Eigen::Vector3d right(std::sin(angle / 2), 0, std::cos(angle / 2));
  for (int i = 0; i <= n; ++i)
    points.emplace_back(0, 0, length * i / n);
  for (int i = 1; i <= n; ++i)
    points.emplace_back(fork + length * i / n * left);
  f.add(npos, points, radius, radius);
  f.add_straight(n, fork, fork + length * right, branch_radius, branch_radius);
  return f.tree;
}

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief two upright twigs side by side on a horizontal branch along x.

  \param distance of the axes of the twigs
*/
template <class Kernel>
Tree_skeleton<Kernel> make_parallel_twigs_tree(double length, double radius, double distance)
{
  generators::internal::check_fixture({length, radius, distance}, "make_parallel_twigs_tree");
  generators::internal::Fixture<Kernel> f;
  const double a = length / 4;
  f.add(npos,
        {{0, 0, 0}, {a, 0, 0}, {a + distance, 0, 0}, {2 * a + distance, 0, 0}},
        2 * radius,
        2 * radius);
  f.add_straight(1, {a, 0, 0}, {a, 0, length}, radius, radius);
  f.add_straight(2, {a + distance, 0, 0}, {a + distance, 0, length}, radius, radius);
  return f.tree;
}

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief two branches of a trunk that cross without touching, `gap` between their surfaces.

  The trunk begins at the origin and has the height `length`; the branches leave it at a half and at
  three quarters of its height.
*/
template <class Kernel>
Tree_skeleton<Kernel> make_crossing_branches_tree(double length, double radius, double gap)
{
  generators::internal::check_fixture({length, radius, gap}, "make_crossing_branches_tree");
  generators::internal::Fixture<Kernel> f;
  const double l = length;
  f.add(npos, {{0, 0, 0}, {0, 0, l / 2}, {0, 0, 3 * l / 4}, {0, 0, l}}, 3 * radius, 3 * radius);
  // both pass (l / 2, 0, 5 l / 8) at the distance `side`, on opposite sides
  const Eigen::Vector3d side(0, radius + gap / 2, 0);
  const Eigen::Vector3d middle(l / 2, 0, 5 * l / 8);
  const Eigen::Vector3d low(0, 0, l / 2), high(0, 0, 3 * l / 4);
  f.add_straight(1, low, low + 2 * (middle + side - low), radius, radius);
  f.add_straight(2, high, high + 2 * (middle - side - high), radius, radius);
  return f.tree;
}

} // namespace pcs

#endif // PCS_GENERATORS_TREE_FIXTURES_H
