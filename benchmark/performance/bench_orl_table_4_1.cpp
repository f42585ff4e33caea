// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Measures the pairs of trees of table 4.1 [Aiteanu 2022]: seconds for correspondences,
// milliseconds for an instance. With --large, or pairs of skeletons: processor time and memory of
// the matching of branches.

#include <pcs/IO/read_swc.h>
#include <pcs/IO/read_txtskl.h>
#include <pcs/IO/write_points.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/Stopwatch.h>
#include <support/measuring.h>
#include <support/orl_trees.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace {

using orl_test::Kernel;
using orl_test::Point;
using orl_test::Tree;

struct Pair
{
  const char *one, *two;
  std::size_t points_1, points_2;
  double text_minutes, text_milliseconds;
};
constexpr Pair pairs[] = {{"AL06a", "AL12a", 232054, 99960, 22, 650},
                          {"AL17a", "BS07a", 150195, 130137, 20.5, 500},
                          {"AL06a", "Weeping_Willow", 232054, 83981, 21, 450}};

/// Samples points on the tubes of the branches, without the edges that connect a branch to its
/// parent.
std::vector<Point> sample(Tree tree, std::size_t n, unsigned seed)
{
  remove_edge_if(
      [&](const auto& e) { return tree[source(e, tree)].branch != tree[target(e, tree)].branch; },
      tree);
  return orl_test::whole_tube_points(tree, n, seed);
}

/// Minimum time of nine trees with all points, at adjacent parameters of the path.
double milliseconds_of_instance(const pcs::Orl_shape_space<Kernel>& space,
                                double lambda,
                                std::vector<Point>& points)
{
  pcs::Orl_tree tree;
  double best = 1e300;
  for (int repetition = 0; repetition < 10; ++repetition) {
    pcs::internal::Stopwatch watch;
    space.geodesic(0, 1, lambda + 0.01 * repetition, tree);
    space.points(tree, points);
    if (repetition > 0) // the first repetition allocates memory
      best = std::min(best, 1e3 * watch.lap());
  }
  return best;
}

/// Time of one slerp per point, for comparison.
double milliseconds_of_slerps(std::size_t n)
{
  std::vector<pcs::Quaternion> from(n), to(n), out(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double x = static_cast<double>(i % 1000) * 1e-3;
    from[i] = pcs::rotation_exp({x, 0.1, 0.2});
    to[i] = pcs::rotation_exp({0.3, x, 0.5});
  }
  double best = 1e300;
  for (int repetition = 0; repetition < 5; ++repetition) {
    pcs::internal::Stopwatch watch;
    for (std::size_t i = 0; i < n; ++i)
      out[i] = from[i].slerp(0.3, to[i]);
    best = std::min(best, 1e3 * watch.lap());
  }
  return out[n / 2].norm() > 0.5 ? best : 0;
}

/// A trunk of `n` edges with a straight twig of random direction and length at each node.
Tree star(std::size_t n, unsigned seed)
{
  constexpr double height = 20, radius = 0.1;
  Tree tree;
  const auto add = [&](std::size_t parent, const Point& p, double r) {
    pcs::Tree_node<Kernel> node;
    node.point = p;
    node.radius = r;
    const std::size_t v = add_vertex(node, tree);
    if (parent != pcs::npos)
      add_edge(parent, v, tree);
    return v;
  };
  std::size_t trunk = add(pcs::npos, Point(0, 0, 0), radius);
  tree[boost::graph_bundle].root = trunk;
  for (std::size_t k = 1; k <= n; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(n), z = height * share;
    trunk = add(trunk, Point(0, 0, z), radius * (1 - 0.9 * share));
    pcs::internal::Random_stream random(seed, k);
    const double x = 0.5 * random.normal(), y = 0.5 * random.normal();
    const std::size_t middle = add(trunk, Point(x / 2, y / 2, z), 0.005);
    add(middle, Point(x, y, z), 0.005);
  }
  return tree;
}

/// Two virtual trees of different habits.
std::array<Tree, 2> unrelated_trees()
{
  std::array<Tree, 2> trees;
  pcs::Tree_habit weeping = pcs::weeping_habit();
  for (double& spacing : weeping.spacing)
    spacing *= 0.9;
  pcs::grow_tree(trees[0], pcs::broadleaf_habit(), pcs::parameters::random_seed(3));
  pcs::grow_tree(trees[1], weeping, pcs::parameters::random_seed(3));
  return trees;
}

/// Matches the branches of two trees, and prints one row.
void print_matching(const std::string& name, const Tree& one, const Tree& two)
{
  pcs::Orl_shape_space<Kernel> space;
  space.add_skeleton(one);
  space.add_skeleton(two);
  const double before = pcs_bench::peak_megabytes();
  const std::clock_t begin = std::clock();
  const pcs::Orl_report r = space.build();
  const double cpu = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const double memory = pcs_bench::peak_megabytes();
  constexpr std::size_t number_of_slerps = 10000; // few, so that a loaded machine interrupts none
  const double slerps = milliseconds_of_slerps(number_of_slerps) / 1e3;
  std::printf("| %s | %zu, %zu | %zu | %.1f | %.0f | %.0f | %.0f |\n",
              name.c_str(),
              r.number_of_branches[0],
              r.number_of_branches[1],
              r.number_of_matched_branches,
              cpu,
              memory,
              memory - before,
              cpu / slerps * number_of_slerps / 1e6);
  std::fflush(stdout);
}

/// Calls `work()` in a process of its own, so that its largest memory is known. Returns whether it
/// succeeded. Requires that no thread has started.
template <class Work>
bool run_apart(const Work& work)
{
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    int code = 1;
    try {
      work();
      code = 0;
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s\n", e.what());
    }
    std::fflush(stdout);
    _exit(code);
  }
  int status = 1;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

/// Measures pairs of skeletons in SWC, two unrelated trees, and two stars.
bool measure_matching(const std::vector<std::string>& files, bool has_virtual_trees)
{
  std::printf("| pair | branches | matched | CPU [s] | memory [MB] | of the matching [MB] | "
              "CPU / 10^6 slerps |\n|---|---|---|---|---|---|---|\n");
  bool is_fine = true;
  for (std::size_t i = 0; i + 1 < files.size(); i += 2)
    is_fine = run_apart([&] {
                std::array<Tree, 2> trees;
                for (std::size_t t = 0; t < 2; ++t)
                  pcs::IO::read_swc<Kernel>(files[i + t], trees[t]);
                const auto name = [&](std::size_t t) {
                  return std::filesystem::path(files[i + t]).stem().string();
                };
                print_matching(name(0) + ", " + name(1), trees[0], trees[1]);
              }) &&
              is_fine;
  if (!has_virtual_trees)
    return is_fine;
  is_fine = run_apart([] {
              const auto trees = unrelated_trees();
              print_matching("broadleaf and weeping, unrelated", trees[0], trees[1]);
            }) &&
            is_fine;
  return run_apart(
             [] { print_matching("two stars of 3000 twigs", star(3000, 1), star(3000, 2)); }) &&
         is_fine;
}

} // namespace

int main(int argc, char** argv)
{
  std::string data, output;
  std::vector<std::string> skeletons;
  bool is_large = false;
  CLI::App app("Compares the times of correspondences and instances with the published ones "
               "[Aiteanu 2022, section 4.11.1].");
  app.add_option("--data", data, "folder with the skeletons, AL06a.txtskl and others");
  app.add_option("--pairs", skeletons, "skeletons (SWC): each two are matched, without points");
  app.add_flag("--large", is_large, "match two unrelated virtual trees, and two stars");
  app.add_option("--output",
                 output,
                 "write the points at seven parameters of each path to this folder");
  CLI11_PARSE(app, argc, argv);
  if (skeletons.size() % 2 != 0 || (data.empty() && skeletons.empty() && !is_large)) {
    std::fprintf(stderr, "give --data, --large, or --pairs with an even number of skeletons\n");
    return 1;
  }
  if ((!skeletons.empty() || is_large) && !measure_matching(skeletons, is_large))
    return 1;
  if (data.empty())
    return 0;

  std::printf("| pair | matching [s] | points [s] | all [s] | CPU [s] | 2022 [min] | points | "
              "instance [ms] | at -0.5 [ms] | at 1.5 [ms] "
              "| slerps [ms] | "
              "ratio | 2022 [ms] |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Pair& pair : pairs) {
    Tree one, two;
    pcs::IO::read_txtskl<Kernel>(data + "/" + pair.one + ".txtskl", one);
    pcs::IO::read_txtskl<Kernel>(data + "/" + pair.two + ".txtskl", two);
    pcs::Orl_shape_space<Kernel> space;
    space.add(one, sample(one, pair.points_1, 1));
    space.add(two, sample(two, pair.points_2, 2));
    const std::clock_t begin = std::clock(); // CPU time of all threads of this process
    const pcs::Orl_report r = space.build();
    const double cpu = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    std::vector<Point> points;
    const double best = milliseconds_of_instance(space, 0.4, points),
                 before = milliseconds_of_instance(space, -0.5, points),
                 behind = milliseconds_of_instance(space, 1.41, points);
    const double slerps = milliseconds_of_slerps(points.size());
    std::printf(
        "| %s, %s | %.2f | %.2f | %.2f | %.2f | %.1f | %zu | %.2f | %.2f | %.2f | %.2f | %.2f | "
        "%.0f |\n",
        pair.one,
        pair.two,
        r.seconds.matching + r.seconds.topology,
        r.seconds.assignment + r.seconds.transport + r.seconds.instances,
        r.seconds.total(),
        cpu,
        pair.text_minutes,
        points.size(),
        best,
        before,
        behind,
        slerps,
        best / slerps,
        pair.text_milliseconds);
    if (output.empty())
      continue;
    std::filesystem::create_directories(output);
    for (const double lambda : {-0.5, 0., 0.25, 0.5, 0.75, 1., 1.5}) {
      space.points(space.geodesic(0, 1, lambda), points);
      char name[64];
      std::snprintf(name, sizeof(name), "/%s_%s_%.2f.ply", pair.one, pair.two, lambda);
      pcs::IO::write_points(output + name, points);
    }
  }
  return 0;
}
