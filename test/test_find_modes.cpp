// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Modes of variation: known parameters are found, and inputs are given back.

#include <pcs/Orl_shape_space.h>
#include <pcs/find_modes.h>
#include <pcs/mean_tree.h>
#include <pcs/shape_space/statistics/Tangent_space.h>
#include <pcs/shape_space/statistics/find_modes.h>
#include <pcs/shape_space/statistics/mean_tree.h>
#include <support/drawn.h>
#include <support/orl_families.h>
#include <support/trees_of_parameters.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <set>
#include <vector>

namespace test_find_modes {

using pcs::Mode_inner_product;
using pcs::Orl_orientation;
using pcs::Tree_mean;

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;

BOOST_AUTO_TEST_SUITE(orl_modes)

BOOST_AUTO_TEST_CASE(equal_trees_are_no_outliers)
{
  for (const std::size_t n : {std::size_t(2), std::size_t(3)}) {
    Space space;
    for (std::size_t k = 0; k < n; ++k)
      space.add_skeleton(orl_test::random_tree(8, 3, 2));
    space.build();
    for (const Mode_inner_product measure :
         {Mode_inner_product::branches, Mode_inner_product::metric}) {
      const auto modes = pcs::find_modes(space, 9, np::mode_inner_product(measure));
      BOOST_TEST(modes.size() == 0u);
      for (std::size_t h = 0; h < n; ++h)
        BOOST_TEST(pcs::outlier_score(space, modes, space.tree(h)) == 0);
    }
  }
}

BOOST_AUTO_TEST_CASE(all_modes_give_the_inputs_back)
{
  const Family space(6);
  const auto modes = pcs::find_modes(space, 100);
  BOOST_TEST(modes.size() == 5u);
  BOOST_TEST(std::abs(modes.share(5) - 1) < 1e-9);
  for (std::size_t h = 0; h < 6; ++h) {
    const pcs::Orl_tree tree = space.tree(h);
    const double size = total_length(tree.coordinates());
    const pcs::Orl_tree same = pcs::reconstruct_tree(space, modes, tree, 5);
    BOOST_TEST(space.distance(same, tree) < 1e-9 * size);
    Tree one, two; // missing branches do not get lengths from rounding errors
    space.skeleton(tree, one);
    space.skeleton(same, two);
    BOOST_TEST(num_vertices(one) == num_vertices(two));
    double last = 1e300;
    for (std::size_t k = 1; k <= 5; ++k) {
      const double d = pcs::project_on_modes(space, pcs::find_modes(space, k), tree).distance;
      BOOST_TEST(d < last + 1e-9 * size);
      last = d;
    }
    BOOST_TEST(last < 1e-9 * size);
  }
  for (const Mode_inner_product measure :
       {Mode_inner_product::branches, Mode_inner_product::metric}) {
    const auto all = pcs::find_modes(space, 100, np::mode_inner_product(measure));
    BOOST_TEST(all.size() == 5u);
    const Eigen::MatrixXd products = all.scores.transpose() * all.scores / 5;
    BOOST_TEST((products - Eigen::MatrixXd::Identity(5, 5)).norm() < 1e-9); // uncorrelated
    BOOST_TEST((all.directions.colwise().norm().array() - 1).abs().maxCoeff() < 1e-12);
    for (Eigen::Index k = 1; k < 5; ++k)
      BOOST_TEST(all.shares[k] <= all.shares[k - 1]);
    const pcs::Orl_tree tree = space.tree(3);
    BOOST_TEST(space.distance(pcs::reconstruct_tree(space, all, tree, 5), tree) <
               1e-9 * total_length(tree.coordinates()));
    if (measure == Mode_inner_product::metric)
      BOOST_TEST(
          (all.directions.transpose() * all.directions - Eigen::MatrixXd::Identity(5, 5)).norm() <
          1e-9);
  }
}

BOOST_AUTO_TEST_CASE(trees_that_only_lack_branches_have_modes)
{
  const auto with = [](std::size_t number_of_branches) {
    Tree tree;
    const auto add = [&](std::size_t parent, const Vec3& p) {
      const auto v = add_vertex(tree);
      tree[v].point = to_cgal(p);
      tree[v].radius = 0.1;
      if (v > 0)
        add_edge(parent, v, tree);
      return v;
    };
    for (std::size_t k = 0; k < 6; ++k)
      add(k - 1, Vec3(0, 0, static_cast<double>(k)));
    for (std::size_t k = 1; k <= number_of_branches; ++k)
      add(k, Vec3(k % 2 == 0 ? 0.5 : -0.5, 0.2, static_cast<double>(k) + 0.2));
    return tree;
  };
  const Space space = make_space({with(4), with(2), with(4), with(2)});
  const auto modes = pcs::find_modes(space, 3);
  BOOST_TEST_REQUIRE(modes.size() == 1u);
  BOOST_TEST((modes.features.measure == Mode_inner_product::metric));
  BOOST_TEST(modes.scores(0, 0) * modes.scores(1, 0) < 0);
  BOOST_TEST(std::abs(modes.scores(0, 0) - modes.scores(2, 0)) < 1e-9);
  for (std::size_t h = 0; h < 4; ++h)
    BOOST_TEST(space.distance(pcs::reconstruct_tree(space, modes, space.tree(h), 1),
                              space.tree(h)) < 1e-9);
  BOOST_TEST(pcs::find_modes(space, 0).size() == 0u);
}

BOOST_AUTO_TEST_CASE(trees_far_out_on_a_mode_are_trees)
{
  const Family space(6);
  const auto check = [&](const pcs::Orl_tree& tree) {
    const Orl_coordinates& x = tree.coordinates();
    for (std::size_t b = 0; b < space.family().layout.branches.size(); ++b) {
      const Orl_layout::Branch& branch = space.family().layout.branches[b];
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e) {
        BOOST_TEST(std::isfinite(x.length[e]));
        BOOST_TEST((b > 0 || x.length[e] > 0));
        BOOST_TEST((x.radius[e] > 0 || !(x.length[e] > 0)));
        BOOST_TEST((x.base_radius[b] > 0 || !(x.length[e] > 0)));
      }
    }
    Tree skeleton;
    space.skeleton(tree, skeleton);
    BOOST_TEST(num_vertices(skeleton) >= 2u);
  };
  const auto modes = pcs::find_modes(space, 5);
  for (std::size_t k = 0; k < modes.size(); ++k)
    for (const double score : {-1000., -50., -5., 5., 50., 1000.}) {
      std::vector<double> scores(k, 0);
      scores.push_back(score);
      check(pcs::tree_of_modes(space, modes, scores));
    }
  for (const double step : {-100., -3., 4., 100.})
    check(pcs::parallel_displacement(space,
                                     pcs::mean_tree(space, np::tree_mean(Tree_mean::frechet)),
                                     space.tree(0),
                                     space.tree(1),
                                     step));
}

BOOST_AUTO_TEST_CASE(two_known_modes_are_found)
{
  // Trees at random positions of a plane through a mean.
  const Family base(5);
  const Orl_coordinates mean =
      pcs::mean_tree(base, np::tree_mean(Tree_mean::frechet)).coordinates();
  const Tangent_space tangent(base.family().layout, mean, base.family().weights);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd plane(tangent.dimension(), 2);
  for (Eigen::Index i = 0; i < plane.size(); ++i)
    plane.data()[i] = normal(random);
  plane.col(0).normalize();
  plane.col(1) = (plane.col(1) - plane.col(0).dot(plane.col(1)) * plane.col(0)).normalized();
  std::vector<Orl_coordinates> trees;
  std::vector<const Orl_coordinates*> pointers;
  for (int i = 0; i < 20; ++i)
    trees.push_back(
        tangent.exp(0.06 * normal(random) * plane.col(0) + 0.03 * normal(random) * plane.col(1)));
  for (const Orl_coordinates& x : trees)
    pointers.push_back(&x);
  using Tag = CGAL::Parallel_if_available_tag;
  const Orl_coordinates middle = mean_tree<Tag>(base.family().layout,
                                                pointers,
                                                std::vector<double>(20, 1),
                                                Tree_mean::frechet);
  const auto modes = find_modes<Tag>(base.family().layout,
                                     pointers,
                                     base.family().weights,
                                     Orl_orientation::gauge_fixed,
                                     middle,
                                     2);
  BOOST_REQUIRE(modes.size() == 2u);
  BOOST_TEST(modes.share(2) > 0.98);
  Eigen::MatrixXd found = modes.directions;
  found.col(1) = (found.col(1) - found.col(0).dot(found.col(1)) * found.col(0)).normalized();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(plane.transpose() * found);
  const double cosine = svd.singularValues().minCoeff();
  BOOST_TEST(std::acos(std::min(1.0, cosine)) < 5 * CGAL_PI / 180);
}

BOOST_AUTO_TEST_CASE(age_and_crown_angle_of_trees_with_different_branches_are_found)
{
  // Branches emerge one after the other and grow from then on. Some are lost, and all have small
  // individual variations.
  for (const unsigned seed : {31u, 131u, 231u, 331u}) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    const std::vector<Branch> all = random_branches(seed + 1, 6, 3);
    std::vector<double> birth(all.size(), 0);
    for (std::size_t b = 1; b < all.size(); ++b)
      birth[b] = std::max(birth[all[b].parent], uniform(random));
    const Eigen::Index n = 14;
    Eigen::MatrixXd known(n, 2);
    std::vector<Tree> trees;
    std::set<std::size_t> counts;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double age = 0.7 + 0.6 * uniform(random), angle = 0.6 * uniform(random) - 0.3;
      known.row(i) << age, angle;
      std::vector<Branch> branches = all;
      Turns turns(all.size(), Eigen::Matrix3d::Identity());
      std::vector<char> is_kept(all.size(), 1);
      for (std::size_t b = 0; b < all.size(); ++b) {
        const double size = std::max(0.0, age - 0.9 * birth[b]) * std::exp(0.05 * normal(random));
        for (Vec3& p : branches[b].points)
          p *= size;
        is_kept[b] = b == 0 || (size > 0.1 && uniform(random) > 0.08);
        const Vec3 noise = 0.05 * pcs_test::drawn<Vec3>([&] { return normal(random); });
        const Vec3 d = all[b].points.back().normalized();
        if (b > 0)
          turns[b] = (Eigen::AngleAxisd(noise.norm(), noise.normalized()) *
                      Eigen::AngleAxisd(angle, Vec3::UnitZ().cross(d).normalized()))
                         .toRotationMatrix();
      }
      std::vector<std::size_t> tip;
      trees.push_back(make_tree(branches, turns, is_kept, tip));
      counts.insert(num_vertices(trees.back()));
    }
    BOOST_TEST(counts.size() > 6u); // the trees differ
    const Space space = make_space(trees);
    const auto modes = pcs::find_modes(space, 2);
    BOOST_REQUIRE(modes.size() == 2u);
    BOOST_TEST(correlation(modes.scores, known.col(0)) > 0.95, seed);
    BOOST_TEST(correlation(modes.scores, known.col(1)) > 0.95, seed);
  }
}

BOOST_AUTO_TEST_CASE(left_out_trees_are_nearer_with_more_modes)
{
  const Family space(7);
  const auto modes = pcs::find_modes(space, 6);
  for (std::size_t k = 0; k < 5; ++k)
    BOOST_TEST(modes.left_out_error(k + 1) < modes.left_out_error(k) * (1 + 1e-12));
  BOOST_TEST(modes.left_out_error(5) < 0.999 * modes.left_out_error(0));
  // Comparison with the definition, for one tree and two modes.
  const Family others(7);
  std::vector<Orl_coordinates> x;
  std::vector<const Orl_coordinates*> pointers;
  for (std::size_t h = 0; h < 7; ++h)
    x.push_back(space.tree(h).coordinates());
  for (std::size_t h = 1; h < 7; ++h)
    pointers.push_back(&x[h]);
  const auto rest = find_modes<CGAL::Sequential_tag>(space.family().layout,
                                                     pointers,
                                                     space.family().weights,
                                                     Orl_orientation::gauge_fixed,
                                                     modes.mean,
                                                     2);
  const double d = project_on_modes(space.family().layout,
                                    space.family().weights,
                                    Orl_orientation::gauge_fixed,
                                    rest,
                                    x[0])
                       .distance;
  BOOST_TEST(std::abs(d - modes.left_out[0][2]) < 1e-4 * d); // covariances are computed iteratively
}

BOOST_AUTO_TEST_CASE(a_tree_without_part_in_the_topology_is_nearer_with_more_modes)
{
  // Lengths and angles of the branches follow two parameters, so that the other trees contain
  // information about each tree.
  std::mt19937 random(12);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const std::vector<Branch> all = random_branches(13, 5, 2);
  std::vector<Tree> trees;
  for (int i = 0; i < 9; ++i) {
    const double size = uniform(random), slant = uniform(random);
    std::vector<Branch> branches = all;
    Turns turns(all.size(), Eigen::Matrix3d::Identity());
    for (std::size_t b = 1; b < all.size(); ++b) {
      for (Vec3& p : branches[b].points)
        p *= std::exp(0.3 * (b % 2 ? size : -size) + 0.01 * normal(random));
      const Vec3 d = all[b].points.back().normalized();
      turns[b] = Eigen::AngleAxisd(0.3 * slant + 0.01 * normal(random),
                                   Vec3::UnitZ().cross(d).normalized())
                     .toRotationMatrix();
    }
    std::vector<std::size_t> tip;
    trees.push_back(make_tree(branches, turns, std::vector<char>(all.size(), 1), tip));
  }
  double error[3] = {0, 0, 0};
  for (std::size_t left = 0; left < 3; ++left) {
    std::vector<Tree> others = trees;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left));
    const Space space = make_space(others);
    const pcs::Orl_tree placed = space.embed(trees[left]);
    for (std::size_t k = 0; k < 3; ++k)
      error[k] += pcs::project_on_modes(space, pcs::find_modes(space, k), placed).distance;
  }
  BOOST_TEST(error[1] < 0.9 * error[0]);
  BOOST_TEST(error[2] < 0.4 * error[0]);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_grown_modes)

BOOST_AUTO_TEST_CASE(parameters_of_grown_trees_are_found)
{
  for (const Second_parameter second : {Second_parameter::crown_angle, Second_parameter::tropism}) {
    pcs::Tree_habit habit =
        second == Second_parameter::crown_angle ? pcs::fruit_habit() : pcs::conifer_habit();
    habit.number_of_orders = 3;
    const Trees_of_parameters family = grow_trees(habit, second, 9, 12);
    const Space space = make_space(family.trees);
    const auto modes = pcs::find_modes(space, 2);
    const double age = correlation(modes.scores, family.known.col(0)),
                 other = correlation(modes.scores, family.known.col(1));
    BOOST_TEST(age > 0.95, age);
    BOOST_TEST(other > 0.95, other);
    // The metric confuses lost branches with the second parameter.
    const auto plain =
        pcs::find_modes(space, 2, np::mode_inner_product(Mode_inner_product::metric));
    BOOST_TEST(correlation(plain.scores, family.known.col(1)) < other);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_find_modes
