// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Virtual trees of two ages, scanned independently: how many points find their branch, and their place on it.

#include <pcs/Orl_shape_space.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/generators/tree_at_age.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

/// Points on wood, with the nodes that they were measured at.
struct Labelled_scan
{
  std::vector<Kernel::Point_3> points;
  std::vector<std::size_t> node;
};

Labelled_scan scan(const Tree& tree, int seed)
{
  pcs::Virtual_scanner scanner;
  scanner.angular_step *= 4;
  pcs::Virtual_scan<Kernel> all;
  pcs::scan_tree(tree, all, scanner, pcs::parameters::random_seed(seed));
  Labelled_scan result;
  for (std::size_t i = 0; i < all.points.size(); ++i)
    if (all.node[i] >= 0) {
      result.points.push_back(all.points[i]);
      result.node.push_back(static_cast<std::size_t>(all.node[i]));
    }
  return result;
}

/// Share of the length of its branch, and that length, for each node.
std::vector<std::array<double, 2>> places(const Tree& tree)
{
  std::vector<std::array<double, 2>> result(num_vertices(tree), {0, 0});
  for (const auto& nodes : pcs::nodes_by_branch<Kernel>(tree)) {
    double arc = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (k > 0)
        arc += std::sqrt(CGAL::squared_distance(tree[nodes[k - 1]].point, tree[nodes[k]].point));
      result[nodes[k]][0] = arc;
    }
    for (const std::size_t v : nodes)
      result[v] = {arc > 0 ? result[v][0] / arc : 0, arc};
  }
  return result;
}

} // namespace

int main(int argc, char** argv)
{
  int trees = 3;
  CLI::App app("Correspondences of virtual trees of two ages, scanned independently.");
  app.add_option("--trees", trees, "per habit and age")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::printf("| habit | age | points | right branch [%%] | within one radius of the same share "
              "of it [%%] | seconds |\n|---|---|---|---|---|---|\n");
  for (const std::string habit : {"broadleaf", "fruit"})
    for (const double age : {0.9, 0.7, 0.5}) {
      double right = 0, near = 0, all = 0, seconds = 0;
      for (int seed = 1; seed <= trees; ++seed) {
        Tree old_tree;
        pcs::grow_tree(old_tree,
                       habit == "fruit" ? pcs::fruit_habit() : pcs::broadleaf_habit(),
                       pcs::parameters::random_seed(seed));
        const Tree young_tree = pcs::tree_at_age(old_tree, age);
        const Labelled_scan one = scan(young_tree, 2 * seed), two = scan(old_tree, 2 * seed + 1);
        pcs::Orl_shape_space<Kernel> space;
        space.add(young_tree, one.points);
        space.add(old_tree, two.points);
        seconds += space.build().seconds.total();
        const auto places_1 = places(young_tree), places_2 = places(old_tree);
        const auto& branches_1 = young_tree[boost::graph_bundle].branches;
        const auto& branches_2 = old_tree[boost::graph_bundle].branches;
        // points of the young tree: each has one partner or more, the first one counts
        std::vector<std::size_t> partner(one.points.size(), pcs::npos);
        for (const auto& pair : space.correspondences().pairs)
          if (pair.point[0] != pcs::Orl_correspondences::no_point &&
              pair.point[1] != pcs::Orl_correspondences::no_point &&
              partner[pair.point[0]] == pcs::npos)
            partner[pair.point[0]] = pair.point[1];
        for (std::size_t i = 0; i < partner.size(); ++i) {
          all += 1;
          if (partner[i] == pcs::npos)
            continue;
          const std::size_t a = one.node[i], b = two.node[partner[i]];
          if (branches_1[young_tree[a].branch].id != branches_2[old_tree[b].branch].id)
            continue;
          right += 1;
          const double off = std::abs(places_1[a][0] - places_2[b][0]) * places_2[b][1];
          near += off <= old_tree[b].radius ? 1 : 0;
        }
      }
      std::printf("| %s | %.1f | %.0f | %.1f | %.1f | %.1f |\n",
                  habit.c_str(),
                  age,
                  all / trees,
                  100 * right / all,
                  100 * near / all,
                  seconds / trees);
      std::fflush(stdout);
    }
  return 0;
}
