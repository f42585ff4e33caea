// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Families of trees: seconds, correlation of modes with known parameters, agreement of random trees
// with the inputs, seconds per random tree.

#include <pcs/IO/read_txtskl.h>
#include <pcs/IO/write_points.h>
#include <pcs/IO/write_swc.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/compare_trees.h>
#include <pcs/find_modes.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/mean_tree.h>
#include <pcs/sample_tree.h>
#include <pcs/shape_space/statistics/Tree_distribution.h>
#include <pcs/shape_space/statistics/find_modes.h>
#include <support/trees_of_parameters.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using pcs::Mode_inner_product;
using pcs::Orl_orientation;
using pcs::Tree_mean;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point = Kernel::Point_3;
using Space = pcs::Orl_shape_space<Kernel>;
using namespace pcs::shape_space;
namespace np = pcs::parameters;

void write(const Space& space,
           const pcs::Orl_tree& tree,
           const std::string& folder,
           const std::string& name)
{
  if (folder.empty())
    return;
  Tree skeleton;
  space.skeleton(tree, skeleton);
  pcs::IO::write_swc((std::filesystem::path(folder) / (name + ".swc")).string(), skeleton);
}

void print(const char* name, const Tree_descriptors& f)
{
  std::printf("%-8s length %9.2f height %8.3f width %8.3f branches %4zu angles",
              name,
              f.length,
              f.height,
              f.crown_width,
              f.total_number_of_branches());
  for (std::size_t k = 1; k < f.mean_angle.size(); ++k)
    std::printf(" %.2f+-%.2f", f.mean_angle[k], f.angle_deviation[k]);
  std::printf("\n");
}

void run_group(const std::vector<std::string>& files, const std::string& folder)
{
  Space space;
  for (const std::string& file : files) {
    Tree tree;
    pcs::IO::read_txtskl<Kernel>(file, tree);
    space.add_skeleton(tree);
  }
  pcs::internal::Stopwatch watch;
  std::cout << space.build() << '\n';
  std::printf("%zu trees, %zu branches, built in %.1f s\n",
              files.size(),
              space.family().layout.branches.size(),
              watch.lap());
  std::vector<Tree_descriptors> inputs;
  for (std::size_t h = 0; h < files.size(); ++h) {
    inputs.push_back(pcs::measure_shape(space, space.tree(h)));
    print("input", inputs.back());
    write(space, space.tree(h), folder, "input_" + std::to_string(h));
  }
  watch.lap();
  const pcs::Orl_tree mean = pcs::mean_tree(space);
  const pcs::Orl_tree square = pcs::mean_tree(space, np::tree_mean(Tree_mean::frechet));
  std::printf("both means in %.3f s\n", watch.lap());
  print("L1 mean", pcs::measure_shape(space, mean));
  print("L2 mean", pcs::measure_shape(space, square));
  write(space, mean, folder, "mean_1");
  write(space, square, folder, "mean_2");
  const auto modes = pcs::find_modes(space, files.size());
  std::printf("modes in %.3f s; fraction of the variance, left-out error:\n   0  0.000 %9.3f\n",
              watch.lap(),
              modes.left_out_error(0));
  for (std::size_t k = 1; k <= modes.size(); ++k)
    std::printf("%4zu  %.3f %9.3f\n", k, modes.share(k), modes.left_out_error(k));
  for (std::size_t k = 0; k < std::min<std::size_t>(3, modes.size()); ++k)
    for (const double side : {-2.0, 2.0}) {
      std::vector<double> scores(k, 0);
      scores.push_back(side);
      write(space,
            pcs::tree_of_modes(space, modes, scores),
            folder,
            "mode_" + std::to_string(k + 1) + (side < 0 ? "_minus" : "_plus"));
    }
  const auto distribution = pcs::learn_distribution(space);
  std::printf("shrinkage %.2f\n", distribution.distribution->shrinkage());
  std::size_t number_inside = 0, number_alike = 0;
  for (std::uint64_t i = 0; i < 12; ++i) {
    const pcs::Orl_tree tree = pcs::sample_tree(space, distribution, 1, i);
    const Tree_descriptors f = pcs::measure_shape(space, tree);
    number_inside += range_violation(f, inputs, false) == 0;
    number_alike += range_violation(f, inputs) == 0;
    print("new", f);
    write(space, tree, folder, "sample_" + std::to_string(i));
  }
  std::printf(
      "%zu of 12 random trees are inside the range of the inputs, %zu of them in numbers and "
      "angles of branches of each order as well\n",
      number_inside,
      number_alike);
}

/// Leaves each tree out of the topology, then matches it to the mean of the others.
void run_left_out(const std::vector<std::string>& files)
{
  std::vector<Tree> trees(files.size());
  for (std::size_t i = 0; i < files.size(); ++i)
    pcs::IO::read_txtskl<Kernel>(files[i], trees[i]);
  std::vector<double> error(files.size() - 1, 0);
  double represented = 0;
  for (std::size_t left = 0; left < trees.size(); ++left) {
    Space space;
    for (std::size_t i = 0; i < trees.size(); ++i)
      if (i != left)
        space.add_skeleton(trees[i]);
    space.build();
    double share = 0;
    const pcs::Orl_tree placed = space.embed(trees[left], np::default_values(), &share);
    represented += share / static_cast<double>(trees.size());
    const auto modes = pcs::find_modes(space, trees.size());
    for (std::size_t k = 0; k < error.size(); ++k)
      error[k] += project_on_modes(space.family().layout,
                                   space.family().weights,
                                   Orl_orientation::gauge_fixed,
                                   modes,
                                   placed.coordinates(),
                                   k)
                      .distance /
                  static_cast<double>(trees.size());
  }
  std::printf(
      "left out of the topology, %.3f of the length is represented; modes and mean error:\n",
      represented);
  for (std::size_t k = 0; k < error.size(); ++k)
    std::printf("%4zu %9.3f\n", k, error[k]);
}

/// Trees of two known parameters: correlation of these with the first two modes.
void run_parameters(std::size_t n, std::uint64_t seed)
{
  using namespace orl_test;
  std::printf("| habit | second parameter | age, by branches | second | age, by metric | second | "
              "seconds |\n|---|---|---|---|---|---|---|\n");
  for (auto [name, habit] : pcs::tree_habits())
    for (const Second_parameter second :
         {Second_parameter::crown_angle, Second_parameter::tropism}) {
      habit.number_of_orders = 3;
      const Trees_of_parameters family = grow_trees(habit, second, seed, static_cast<int>(n));
      Space space;
      for (const Tree& tree : family.trees)
        space.add_skeleton(tree);
      space.build();
      std::printf("| %s | %s |",
                  name.c_str(),
                  second == Second_parameter::tropism ? "tropism" : "crown angle");
      pcs::internal::Stopwatch watch;
      for (const Mode_inner_product measure :
           {Mode_inner_product::branches, Mode_inner_product::metric}) {
        const auto modes = pcs::find_modes(space, 2, np::mode_inner_product(measure));
        std::printf(" %.3f | %.3f |",
                    correlation(modes.scores, family.known.col(0)),
                    correlation(modes.scores, family.known.col(1)));
      }
      std::printf(" %.2f |\n", watch.lap());
      std::fflush(stdout);
    }
}

double megabytes()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void run_speed(std::size_t number_of_points, std::size_t number_of_trees)
{
  Space space;
  for (int i = 0; i < 3; ++i) {
    Tree tree;
    pcs::Tree_habit habit = pcs::fruit_habit();
    habit.number_of_orders = 3;
    pcs::grow_tree(tree, habit.scaled(0.9 + 0.1 * i), np::random_seed(2));
    // Uniform along the branches, so that every branch has points.
    std::vector<Point> scan;
    pcs::internal::Random_stream random(3, i);
    std::vector<std::pair<std::size_t, std::size_t>> all;
    for (const auto e : boost::make_iterator_range(edges(tree)))
      all.emplace_back(source(e, tree), target(e, tree));
    while (scan.size() < number_of_points) {
      const auto& [a, b] = all[random.bits() % all.size()];
      const double t = random.uniform(), angle = random.uniform(0, 2 * CGAL_PI);
      const Kernel::Vector_3 v = tree[b].point - tree[a].point;
      const Kernel::Vector_3 other =
          std::abs(v.z()) > std::abs(v.x()) ? Kernel::Vector_3(1, 0, 0) : Kernel::Vector_3(0, 0, 1);
      Kernel::Vector_3 x = CGAL::cross_product(v, other);
      if (!(x.squared_length() > 0))
        continue;
      x = x / std::sqrt(x.squared_length());
      const Kernel::Vector_3 y = CGAL::cross_product(v, x) / std::sqrt(v.squared_length());
      scan.push_back(tree[a].point + t * v +
                     tree[b].radius * (std::cos(angle) * x + std::sin(angle) * y));
    }
    space.add(tree, scan);
  }
  std::cout << space.build(np::points_of(std::size_t(1))) << '\n';
  const auto distribution = pcs::learn_distribution(space);
  std::vector<Point> points;
  double making = 0, writing = 0, before = 0;
  std::size_t total = 0;
  const std::string path =
      (std::filesystem::temp_directory_path() / "pcs_bench_shape_space.ply").string();
  for (std::uint64_t i = 0; i < number_of_trees; ++i) {
    pcs::internal::Stopwatch watch;
    const pcs::Orl_tree tree = pcs::sample_tree(space, distribution, 1, i);
    space.points(tree, points);
    making += watch.lap();
    pcs::IO::write_points(path, pcs::IO::Point_table(points));
    writing += watch.lap();
    total += points.size();
    if (i == 2)
      before = megabytes();
  }
  std::filesystem::remove(path);
  const auto n = static_cast<double>(number_of_trees);
  std::printf("%zu trees of %.0f points: %.1f ms to make one, %.1f ms to write one, ratio %.2f; "
              "%.0f MB after 3 trees, %.0f MB after all\n",
              number_of_trees,
              static_cast<double>(total) / n,
              1000 * making / n,
              1000 * writing / n,
              making / writing,
              before,
              megabytes());
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Families of trees: means, modes and random trees.");
  std::vector<std::string> files;
  std::string folder;
  std::size_t parameters = 0, points = 0, trees = 100;
  std::uint64_t seed = 1;
  bool is_left_out = false;
  app.add_option("files", files, ".txtskl skeletons of one group");
  app.add_option("--output", folder, "write skeletons of means, modes and random trees here");
  app.add_flag("--left-out",
               is_left_out,
               "only the error of each tree with the modes of the others");
  app.add_option("--parameters", parameters, "number of virtual trees with two known parameters");
  app.add_option("--seed", seed, "seed of virtual and random trees")->capture_default_str();
  app.add_option("--points", points, "measure the time per random tree with this number of points");
  app.add_option("--trees", trees, "number of random trees for --points");
  CLI11_PARSE(app, argc, argv);
  try {
    if (!folder.empty())
      std::filesystem::create_directories(folder);
    if (files.size() > 1 && !is_left_out)
      run_group(files, folder);
    if (files.size() > 2 && is_left_out)
      run_left_out(files);
    if (parameters > 2)
      run_parameters(parameters, seed);
    if (points > 0 && trees > 0)
      run_speed(points, trees);
  } catch (const std::exception& e) {
    std::cerr << "bench_shape_space: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
