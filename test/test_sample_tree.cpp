// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random trees of a family: within the range of the inputs, reproducible, with points.

#include <pcs/IO/read_txtskl.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/mean_tree.h>
#include <pcs/sample_tree.h>
#include <pcs/shape_space/statistics/project_to_range.h>
#include <support/orl_families.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace test_sample_tree {

using pcs::Tree_mean;
using pcs::Tree_sampling_options;

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;

BOOST_AUTO_TEST_SUITE(orl_samples)

BOOST_AUTO_TEST_CASE(new_trees_are_different_and_within_the_inputs)
{
  const Family space(8);
  const auto distribution = pcs::learn_distribution(space);
  std::vector<Tree_descriptors> inputs;
  for (std::size_t h = 0; h < 8; ++h)
    inputs.push_back(pcs::measure_shape(space, space.tree(h)));
  std::set<double> lengths;
  std::size_t number_inside = 0, number_beyond = 0;
  for (std::uint64_t i = 0; i < 30; ++i) {
    pcs::Sample_report report;
    const pcs::Orl_tree tree =
        pcs::sample_tree(space, distribution, 11, i, np::default_values(), &report);
    number_inside += report.range_violation == 0;
    BOOST_TEST(report.range_violation < 0.1); // orders of few branches have narrow ranges
    const Tree_descriptors f = pcs::measure_shape(space, tree);
    BOOST_TEST(range_violation(f, inputs) == report.range_violation);
    // Independent of `range_violation()`.
    for (const auto& get : {+[](const Tree_descriptors& x) { return x.length; },
                            +[](const Tree_descriptors& x) { return x.height; },
                            +[](const Tree_descriptors& x) { return x.crown_width; },
                            +[](const Tree_descriptors& x) { return x.mean_angle[1]; },
                            +[](const Tree_descriptors& x) {
                              return static_cast<double>(x.total_number_of_branches());
                            }}) {
      double low = 1e300, high = 0;
      for (const Tree_descriptors& input : inputs) {
        low = std::min(low, get(input));
        high = std::max(high, get(input));
      }
      number_beyond += get(f) < low * 0.9999 || get(f) > high * 1.0001;
    }
    const Orl_coordinates& x = tree.coordinates();
    lengths.insert(total_length(x));
    for (std::size_t b = 0; b < space.family().layout.branches.size(); ++b) {
      const auto& branch = space.family().layout.branches[b];
      const bool is_there = x.length[branch.first_edge] > 0;
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
        BOOST_TEST((x.length[e] > 0) == is_there);
        BOOST_TEST((x.radius[e] > 0) == is_there);
      }
      if (is_there && b > 0)
        BOOST_TEST(x.length[space.family().layout.branches[branch.parent].first_edge] > 0);
    }
  }
  BOOST_TEST(lengths.size() == 30u);
  BOOST_TEST(number_inside >= 27u);
  BOOST_TEST(number_beyond <= 3u);
}

BOOST_AUTO_TEST_CASE(new_trees_of_a_few_are_within_them_by_order)
{
  // Three trees have many narrow ranges: numbers, mean angles and their deviations for each order.
  for (const unsigned seed : {14u, 15u, 16u}) {
    const Space space = make_space(relatives(3, seed, 0.3, 0.3, 4));
    const auto distribution = pcs::learn_distribution(space);
    std::vector<Tree_descriptors> inputs;
    for (std::size_t h = 0; h < 3; ++h)
      inputs.push_back(pcs::measure_shape(space, space.tree(h)));
    std::size_t number_inside = 0;
    for (std::uint64_t i = 0; i < 12; ++i) {
      pcs::Sample_report report;
      const Tree_descriptors f = pcs::measure_shape(
          space,
          pcs::sample_tree(space, distribution, 1, i, np::default_values(), &report));
      BOOST_TEST(report.number_of_trials <= 100u);
      bool is_inside = true;
      for (std::size_t k = 1; k < f.mean_angle.size(); ++k) {
        double count[2] = {1e300, 0}, angle[2] = {1e300, 0};
        for (const Tree_descriptors& input : inputs)
          if (k < input.mean_angle.size()) {
            const auto n = static_cast<double>(input.number_of_branches[k]);
            count[0] = std::min(count[0], n);
            count[1] = std::max(count[1], n);
            angle[0] = std::min(angle[0], input.mean_angle[k]);
            angle[1] = std::max(angle[1], input.mean_angle[k]);
          }
        const auto n = static_cast<double>(f.number_of_branches[k]);
        is_inside = is_inside && n >= count[0] && n <= count[1] &&
                    f.mean_angle[k] > angle[0] - 1e-3 && f.mean_angle[k] < angle[1] + 1e-3;
      }
      number_inside += is_inside && report.range_violation == 0;
    }
    BOOST_TEST(number_inside >= 11u);
  }
}

BOOST_AUTO_TEST_CASE(branches_keep_their_slant)
{
  // The branches of the input trees have equal slants and random azimuths about an upright trunk.
  // The slants of random trees are equal to these.
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  std::vector<Tree> trees;
  for (int i = 0; i < 6; ++i) {
    std::vector<Branch> branches(9);
    branches[0].points = {Vec3(0, 0, 0)};
    for (int k = 1; k <= 10; ++k)
      branches[0].points.push_back(Vec3(0, 0, k));
    branches[0].radii.assign(11, 0.2);
    for (std::size_t b = 1; b < 9; ++b) {
      const double azimuth = 2.4 * static_cast<double>(b) + 0.3 * normal(random);
      // Shorter than the remaining part of the trunk.
      const Vec3 d =
          (0.125 * static_cast<double>(9 - b)) * Vec3(std::cos(azimuth), std::sin(azimuth), 0.5);
      branches[b].parent = 0;
      branches[b].at = b + 1;
      branches[b].points = {Vec3(0, 0, 0), d, 2 * d, (3 + 0.2 * normal(random)) * d};
      branches[b].radii.assign(4, 0.1);
    }
    trees.push_back(make_tree(branches));
  }
  const Space space = make_space(trees);
  const auto distribution = pcs::learn_distribution(space);
  Tree_sampling_options free;
  free.do_keep_in_range = false;
  double spread = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    Tree drawn;
    space.skeleton(pcs::sample_tree(space, distribution, 4, i, np::sampling_options(free)), drawn);
    for (const auto e : boost::make_iterator_range(edges(drawn))) {
      const Vec3 v =
          to_eigen(drawn[target(e, drawn)].point) - to_eigen(drawn[source(e, drawn)].point);
      const double slant = std::atan2(v.head<2>().norm(), v.z());
      if (v.norm() > 0 && slant > 0.3) {
        // The direction of growth is that of the mean tree, which differs slightly from that of the
        // trunk.
        BOOST_TEST(std::abs(slant - std::atan2(1, 0.5)) < 0.15);
        spread = std::max(spread, v.head<2>().norm());
      }
    }
  }
  BOOST_TEST(spread > 1);
}

BOOST_AUTO_TEST_CASE(a_seed_gives_a_family_and_a_tree_does_not_depend_on_the_others)
{
  const Family space(4);
  const auto d = pcs::learn_distribution(space);
  const pcs::Orl_tree a = pcs::sample_tree(space, d, 5, 7),
                      b = pcs::sample_tree(space, pcs::learn_distribution(space), 5, 7);
  BOOST_TEST(space.distance(a, b) == 0);
  BOOST_TEST(space.distance(a, pcs::sample_tree(space, d, 5, 8)) > 0);
  BOOST_TEST(space.distance(a, pcs::sample_tree(space, d, 6, 7)) > 0);
}

BOOST_AUTO_TEST_CASE(moments_of_new_trees_are_those_of_the_inputs)
{
  const Space space = make_space(relatives(12, 21, 0.15, 0)); // all trees have all branches
  const auto distribution = pcs::learn_distribution(space);
  Tree_sampling_options free;
  free.do_keep_in_range = false;
  free.truncation = 6;
  const auto figures = [&](std::size_t e, const Orl_coordinates& x) {
    return std::log(x.length[e]);
  };
  // Logarithms of lengths: the means are equal to those of the inputs, and the variances are equal
  // on average.
  const std::size_t n = space.family().layout.number_of_edges(), m = 4000;
  std::vector<double> mean(n, 0), square(n, 0), input_mean(n, 0), input_square(n, 0);
  for (std::size_t i = 0; i < m; ++i) {
    const Orl_coordinates x =
        pcs::sample_tree(space, distribution, 1, i, np::sampling_options(free)).coordinates();
    for (std::size_t e = 0; e < n; ++e) {
      mean[e] += figures(e, x) / static_cast<double>(m);
      square[e] += figures(e, x) * figures(e, x) / static_cast<double>(m);
    }
  }
  for (std::size_t h = 0; h < 12; ++h)
    for (std::size_t e = 0; e < n; ++e) {
      const double v = figures(e, space.tree(h).coordinates());
      input_mean[e] += v / 12;
      input_square[e] += v * v / 12;
    }
  double worst = 0, drawn = 0, given = 0;
  for (std::size_t e = 0; e < n; ++e) {
    const double variance = square[e] - mean[e] * mean[e];
    drawn += variance;
    given += (input_square[e] - input_mean[e] * input_mean[e]) * 12 / 11;
    worst =
        std::max(worst,
                 std::abs(mean[e] - input_mean[e]) / std::sqrt(variance / static_cast<double>(m)));
  }
  BOOST_TEST(worst < 5); // standard errors
  BOOST_TEST(std::abs(drawn / given - 1) < 0.1);
}

BOOST_AUTO_TEST_CASE(distributions_of_other_spaces_are_rejected)
{
  const Space space = make_space(relatives(4, 21)), other = make_space(relatives(4, 22)),
              same = make_space(relatives(4, 21));
  const auto distribution = pcs::learn_distribution(other);
  BOOST_CHECK_THROW(pcs::sample_tree(space, distribution, 1, 0), pcs::Invalid_input);
  BOOST_CHECK_NO_THROW(pcs::sample_tree(space, pcs::learn_distribution(same), 1, 0));
}

BOOST_AUTO_TEST_CASE(limits_hold_when_asked_for)
{
  const Family space(5);
  const auto distribution = pcs::learn_distribution(space);
  const Orl_layout& layout = space.family().layout;
  const auto radius_at = [&](const Orl_coordinates& x, std::size_t b, double t) {
    const auto k = std::min(layout.branches[b].number_of_edges - 1, static_cast<std::size_t>(t));
    const auto at = [&](std::size_t i) {
      return i == 0 ? x.base_radius[b] : x.radius[layout.branches[b].first_edge + i - 1];
    };
    const double f = t - static_cast<double>(k);
    return (1 - f) * at(k) + f * at(k + 1);
  };
  Tree_sampling_options options;
  options.do_limit_radii = true;
  options.do_keep_in_range = false;
  for (std::uint64_t i = 0; i < 10; ++i) {
    const Orl_coordinates x =
        pcs::sample_tree(space, distribution, 2, i, np::sampling_options(options)).coordinates();
    for (std::size_t b = 1; b < layout.branches.size(); ++b)
      BOOST_TEST(x.base_radius[b] <=
                 radius_at(x, layout.branches[b].parent, x.attachment[b]) * (1 + 1e-12));
  }
  options.pipe_exponent = 2;
  options.do_limit_radii = false;
  for (std::uint64_t i = 0; i < 10; ++i) {
    const Orl_coordinates x =
        pcs::sample_tree(space, distribution, 2, i, np::sampling_options(options)).coordinates();
    // Branches at the trunk, and the remaining part at its tip.
    double sum = std::pow(x.radius[layout.branches[0].number_of_edges - 1], 2);
    for (std::size_t b = 1; b < layout.branches.size(); ++b)
      if (layout.branches[b].parent == 0)
        sum += x.base_radius[b] * x.base_radius[b];
    BOOST_TEST(sum <= x.base_radius[0] * x.base_radius[0] * (1 + 1e-9));
  }
}

BOOST_AUTO_TEST_CASE(points_follow_their_branches_in_one_order)
{
  const std::vector<Tree> trees = relatives(4, 31);
  Space space;
  std::vector<std::vector<Point>> scans;
  for (const Tree& tree : trees) {
    scans.push_back(rings(tree));
    space.add(tree, scans.back());
  }
  space.build(np::points_of(std::size_t(2)));
  // Every scan is reproduced on existing branches: by its own points, or by their partners.
  for (std::size_t h = 0; h < 4; ++h) {
    std::vector<Point> again;
    const pcs::Orl_tree tree = space.tree(h);
    space.points(tree, again);
    std::vector<double> weight(again.size(), 0);
    std::vector<std::array<std::size_t, 2>> from(again.size(), {9, 0});
    space.for_each_source(tree, [&](std::size_t i, std::size_t s, std::size_t k, double w) {
      weight[i] += w;
      from[i] = {s, k};
    });
    std::vector<std::size_t> used(scans[h].size(), 0);
    double worst = 0;
    for (std::size_t i = 0; i < again.size(); ++i) {
      BOOST_TEST(weight[i] == 1);
      BOOST_REQUIRE(from[i][0] == h);
      ++used[from[i][1]];
      worst = std::max(worst, std::sqrt(CGAL::squared_distance(again[i], scans[h][from[i][1]])));
    }
    BOOST_TEST(worst < 1e-5); // partners are stored in single precision
    BOOST_TEST(std::count(used.begin(), used.end(), 0u) <
               static_cast<std::ptrdiff_t>(used.size() / 4));
  }
  // The mean contains points of all scans, in proportion to the given weights.
  const std::vector<double> weights{1, 2, 3, 2};
  const pcs::Orl_tree mean =
      pcs::mean_tree(space, np::tree_weights(weights).tree_mean(Tree_mean::frechet));
  std::vector<double> total(mean.number_of_points(), 0);
  std::vector<std::array<double, 4>> share(total.size(), {0, 0, 0, 0});
  space.for_each_source(mean, [&](std::size_t i, std::size_t h, std::size_t, double w) {
    total[i] += w;
    share[i][h] += w;
  });
  std::size_t number_of_all = 0;
  for (std::size_t i = 0; i < total.size(); ++i) {
    BOOST_TEST(std::abs(total[i] - 1) < 1e-12);
    if (share[i][0] > 0 && share[i][1] > 0 && share[i][2] > 0 && share[i][3] > 0) {
      ++number_of_all;
      for (std::size_t h = 0; h < 4; ++h)
        BOOST_TEST(std::abs(share[i][h] - weights[h] / 8) < 1e-12);
    }
  }
  BOOST_TEST(number_of_all > total.size() / 5);
  // The tree of the given scan gets its own points.
  std::vector<Point> points;
  const pcs::Orl_tree own = space.tree(2);
  BOOST_TEST(space.points(own, points) == own.number_of_points());
  std::vector<double> error(points.size(), -1);
  std::vector<std::size_t> source(points.size(), 0);
  space.for_each_source(own, [&](std::size_t i, std::size_t h, std::size_t k, double) {
    source[i] = h;
    error[i] = std::sqrt(CGAL::squared_distance(points[i], scans[h][k]));
  });
  std::size_t number_of_own = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    BOOST_TEST(source[i] == 2u);
    BOOST_TEST(error[i] >= 0);
    BOOST_TEST(error[i] < 1e-9);
    number_of_own += source[i] == 2;
  }
  BOOST_TEST(number_of_own == scans[2].size());
  // Points of a random tree lie near its axes, within their radii.
  const pcs::Orl_tree drawn = pcs::sample_tree(space, 3);
  space.points(drawn, points);
  Tree skeleton;
  space.skeleton(drawn, skeleton);
  std::size_t number_far = 0;
  for (const Point& p : points) {
    double least = 1e300;
    for (const auto e : boost::make_iterator_range(edges(skeleton))) {
      const Vec3 a = to_eigen(skeleton[boost::source(e, skeleton)].point);
      const Vec3 v = to_eigen(skeleton[boost::target(e, skeleton)].point) - a;
      const double t =
          std::min(1.0,
                   std::max(0.0, (to_eigen(p) - a).dot(v) / std::max(1e-300, v.squaredNorm())));
      least = std::min(least, (to_eigen(p) - a - t * v).norm());
    }
    number_far += least > 1.0; // the trunk is 0.3 thick
  }
  BOOST_TEST(number_far == 0u);
  BOOST_TEST(points.size() > scans[0].size() / 2);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_real_groups)

BOOST_AUTO_TEST_CASE(new_trees_of_a_real_group_are_within_it)
{
  const char* const data = std::getenv("PCS_TEST_DATA");
  const std::filesystem::path folder =
      data ? std::filesystem::path(data) / "orl" / "skel_collections" : std::filesystem::path();
  if (!data || !std::filesystem::is_directory(folder)) {
    BOOST_TEST_MESSAGE("skipped: PCS_TEST_DATA does not name a folder with orl/skel_collections");
    return;
  }
  for (const std::string group : {"BS07a", "EU06"}) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().filename().string().rfind(group, 0) == 0)
        files.push_back(entry.path().string());
    BOOST_REQUIRE(files.size() >= 3u);
    std::sort(files.begin(), files.end());
    Space space;
    for (const std::string& file : files) {
      Tree tree;
      pcs::IO::read_txtskl<Kernel>(file, tree);
      space.add_skeleton(tree);
    }
    space.build();
    std::vector<Tree_descriptors> inputs;
    for (std::size_t h = 0; h < files.size(); ++h)
      inputs.push_back(pcs::measure_shape(space, space.tree(h)));
    const Tree_descriptors mean = pcs::measure_shape(space, pcs::mean_tree(space));
    BOOST_TEST(mean.length > 0.5 * inputs[0].length);
    const auto distribution = pcs::learn_distribution(space);
    std::size_t number_inside = 0;
    for (std::uint64_t i = 0; i < 12; ++i)
      number_inside +=
          range_violation(pcs::measure_shape(space, pcs::sample_tree(space, distribution, 1, i)),
                          inputs) == 0;
    BOOST_TEST(number_inside >= 11u, group << " " << number_inside);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_sample_tree
