// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Measures the pairs of trees of table 4.1 [Aiteanu 2022]: seconds for correspondences,
// milliseconds for an instance.

#include <pcs/IO/read_txtskl.h>
#include <pcs/IO/write_points.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/internal/Stopwatch.h>
#include <support/orl_trees.h>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
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

} // namespace

int main(int argc, char** argv)
{
  std::string data, output;
  CLI::App app("Compares the times of correspondences and instances with the published ones "
               "[Aiteanu 2022, section 4.11.1].");
  app.add_option("--data", data, "folder with the skeletons, AL06a.txtskl and others")->required();
  app.add_option("--output",
                 output,
                 "write the points at seven parameters of each path to this folder");
  CLI11_PARSE(app, argc, argv);

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
