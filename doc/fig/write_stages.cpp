// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: writes the data between the stages of the three algorithms, for render_figures.py.

#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/Point_set_deformation.h>
#include <pcs/Tree_skeletonization.h>
#include <pcs/generators/grow_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Table = pcs::IO::Point_table;

/// Points with a number each.
struct Cloud
{
  std::vector<Point> points;
  std::vector<double> value;

  void add(const Point& p, double v)
  {
    points.push_back(p);
    value.push_back(v);
  }
  /// Adds points on the cylinder of radius `r` around a segment, at most `step` from each other
  /// along it.
  void add(const Point& a, const Point& b, double r, double v, double step)
  {
    const Kernel::Vector_3 along = b - a;
    const double length = std::sqrt(along.squared_length());
    if (!(length > 0))
      return;
    const Eigen::Vector3d d(along.x() / length, along.y() / length, along.z() / length);
    const Eigen::Vector3d u = d.unitOrthogonal(), w = d.cross(u);
    const auto n = static_cast<std::size_t>(std::ceil(length / step));
    const auto number_around = static_cast<std::size_t>(std::ceil(2 * CGAL_PI * r / step)) + 3;
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t j = 0; j < number_around; ++j) {
        const double angle =
            2 * CGAL_PI * static_cast<double>(j) / static_cast<double>(number_around);
        const Eigen::Vector3d out = r * (std::cos(angle) * u + std::sin(angle) * w);
        add(a + static_cast<double>(k) / static_cast<double>(n) * along +
                Kernel::Vector_3(out.x(), out.y(), out.z()),
            v);
      }
  }
  void write(const std::string& path) const
  {
    Table table(points);
    table.add_property("value", value);
    pcs::IO::write_points(path, table);
  }
};

/// The handles, the samples with their links, the strained samples, and the rotations of points.
void write_deformation(const std::string& input, const std::string& folder)
{
  std::vector<Point> points = pcs::IO::read_points(input).points();
  const std::vector<Point> rest = points;
  CGAL::Bbox_3 box;
  for (const Point& p : rest)
    box += p.bbox();
  std::vector<std::size_t> held, moved; // tail and head of the Stanford dragon
  Cloud handles, samples, strained, rotated;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const double x = (rest[i].x() - box.xmin()) / (box.xmax() - box.xmin());
    const double y = (rest[i].y() - box.ymin()) / (box.ymax() - box.ymin());
    const bool is_held = y < 0.1, is_moved = x < 0.3 && y > 0.62;
    if (is_held)
      held.push_back(i);
    if (is_moved)
      moved.push_back(i);
    handles.add(rest[i], is_held ? 1 : is_moved ? 2 : 0);
  }
  pcs::Point_set_deformation session(points, pcs::parameters::number_of_samples(2000));
  session.add_handle(held);
  const auto head = session.add_handle(moved);
  session.set_rotation(head, Kernel::Vector_3(0, 0, 1), -42 * CGAL_PI / 180);
  session.deform();
  const std::vector<double> energy = session.energies_of_samples();
  for (std::size_t k = 0; k < session.number_of_samples(); ++k) {
    const std::size_t i = session.point_of_sample(k);
    samples.add(rest[i], handles.value[i]);
    strained.add(points[i], energy[k]);
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    rotated.add(points[i], std::abs(Eigen::AngleAxisd(session.local_rotation(i)).angle()));
  handles.write(folder + "/handles.ply");
  samples.write(folder + "/samples.ply");
  strained.write(folder + "/strained.ply");
  rotated.write(folder + "/rotated.ply");
}

/// The level sets, the fitted axes, and the branches with their radii.
void write_skeleton(const std::string& input, const std::string& folder)
{
  const std::vector<Point> points = pcs::IO::read_points(input).points();
  pcs::Tree_skeletonization stages(points);
  pcs::Tree_skeleton<Kernel> tree;
  stages.extract(tree);
  const pcs::skeleton::Scan_frame& frame = stages.scan().frame;
  const auto to_point = [&frame](const Eigen::Vector3d& local) {
    const Eigen::Vector3d p = frame.to_input(local);
    return Point(p.x(), p.y(), p.z());
  };
  const double step = frame.unit * stages.scan().spacing;
  Cloud level_sets, axes, branches;
  for (std::size_t i = 0; i < stages.scan().points.size(); ++i) {
    const auto node = stages.layers().node_of_point[i];
    if (node != pcs::skeleton::none)
      level_sets.add(to_point(stages.scan().points[i]), static_cast<double>(node));
  }
  const auto& fitted = stages.axes().axes;
  for (std::size_t a = 0; a < fitted.size(); ++a)
    for (std::size_t k = 1; k < fitted[a].axis.size(); ++k)
      axes.add(to_point(fitted[a].axis[k - 1].point),
               to_point(fitted[a].axis[k].point),
               step,
               static_cast<double>(a),
               step);
  const pcs::skeleton::Branch_tree& result = stages.branches();
  for (const auto& node : result.nodes)
    if (node.parent != pcs::skeleton::none)
      branches.add(to_point(result.nodes[node.parent].point),
                   to_point(node.point),
                   frame.unit * node.radius,
                   result.branches[node.branch].order,
                   step);
  level_sets.write(folder + "/level_sets.ply");
  axes.write(folder + "/axes.ply");
  branches.write(folder + "/branches.ply");
}

/// Trees on the geodesic between two trees, with the same value for the same branch.
void write_shape_space(const std::string& folder)
{
  using Tree = pcs::Tree_skeleton<Kernel>;
  pcs::Tree_habit habit = pcs::broadleaf_habit().scaled(0.5);
  habit.number_of_orders = 2;
  std::array<Tree, 2> trees;
  pcs::grow_tree(trees[0], habit, pcs::parameters::random_seed(1));
  pcs::grow_tree(trees[1], habit, pcs::parameters::random_seed(2));
  pcs::Orl_shape_space<Kernel> space;
  for (const Tree& tree : trees)
    space.add_skeleton(tree);
  space.build();
  for (const int quarter : {0, 1, 2, 3, 4}) {
    Tree tree; // with all branches of both trees, so that their numbers do not change
    space.skeleton(space.geodesic(0, 1, 0.25 * quarter),
                   tree,
                   pcs::parameters::do_keep_absent_branches(true));
    Cloud cloud;
    for (const auto e : boost::make_iterator_range(edges(tree))) {
      const auto &a = tree[source(e, tree)], &b = tree[target(e, tree)];
      const bool is_common = space.has_branch(0, b.branch) && space.has_branch(1, b.branch);
      cloud.add(a.point, b.point, b.radius, is_common ? static_cast<double>(b.branch) : -1, 0.01);
    }
    cloud.write(folder + "/between_" + std::to_string(quarter) + ".ply");
  }
}

int main(int argc, char** argv)
try {
  if (argc != 4) {
    std::cerr << "usage: write_stages DRAGON SCAN FOLDER\n"
                 "Writes the data between the stages of the three algorithms. DRAGON is the model "
                 "that ./run downloads, SCAN the scan of a tree, FOLDER exists.\n";
    return EXIT_FAILURE;
  }
  const std::string folder = argv[3];
  write_deformation(argv[1], folder);
  write_skeleton(argv[2], folder);
  write_shape_space(folder);
  return EXIT_SUCCESS;
} catch (const std::exception& e) {
  std::cerr << "write_stages: " << e.what() << '\n';
  return EXIT_FAILURE;
}
