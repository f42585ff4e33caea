// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Families of trees: one topology, means, modes, new trees, growth, changes, saving.

#include <pcs/IO/read_shape_space.h>
#include <pcs/IO/read_txtskl.h>
#include <pcs/IO/write_shape_space.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/compare_trees.h>
#include <pcs/find_modes.h>
#include <pcs/fit_growth_path.h>
#include <pcs/mean_tree.h>
#include <pcs/sample_tree.h>
#include <pcs/shape_space/embedding/mean_rotation.h>
#include <pcs/shape_space/path/apply_pipe_model.h>
#include <pcs/shape_space/statistics/Tangent_space.h>
#include <pcs/shape_space/statistics/find_modes.h>
#include <pcs/shape_space/statistics/mean_tree.h>
#include <pcs/shape_space/statistics/project_to_range.h>
#include <support/archetypes.h>
#include <support/drawn.h>
#include <support/exceptions.h>
#include <support/orl_trees.h>
#include <support/threads.h>
#include <support/trees_of_parameters.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <unistd.h>

namespace test_Orl_tree_family {

using pcs::Change_limits;
using pcs::Matching_weights;
using pcs::Mode_inner_product;
using pcs::Orl_metric;
using pcs::Orl_orientation;
using pcs::Tree_mean;
using pcs::Tree_sampling_options;

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;
using Space = pcs::Orl_shape_space<Kernel>;
using pcs::Quaternion;
using pcs_test::message_has;

namespace {

/// Similar trees: the branches of one tree are rotated and stretched, and some are cut. Trunks
/// differ in direction and height, too.
std::vector<Tree>
relatives(std::size_t n, unsigned seed, double sigma = 0.15, double cut = 0.15, int orders = 3)
{
  std::vector<Tree> result;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const std::vector<Branch> all = random_branches(seed, 5, orders);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<Branch> branches = all;
    Turns turns(all.size(), Eigen::Matrix3d::Identity());
    std::vector<char> is_kept(all.size(), 1);
    for (std::size_t b = 0; b < all.size(); ++b) {
      const Vec3 u =
          (b == 0 ? 0.3 : 1) * sigma * pcs_test::drawn<Vec3>([&] { return normal(random); });
      turns[b] = Eigen::AngleAxisd(u.norm(), u.normalized()).toRotationMatrix();
      const double stretch = std::exp(0.1 * normal(random));
      for (Vec3& p : branches[b].points)
        p *= stretch;
      is_kept[b] = b == 0 || uniform(random) >= cut;
    }
    std::vector<std::size_t> tip;
    result.push_back(make_tree(branches, turns, is_kept, tip));
  }
  return result;
}

Space make_space(const std::vector<Tree>& trees)
{
  Space space;
  for (const Tree& tree : trees)
    space.add_skeleton(tree);
  space.build();
  return space;
}

std::vector<Point> rings(const Tree& tree, int n = 8)
{
  std::vector<Point> points;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    for (int k = 0; k < n; ++k)
      points.push_back(tree[v].point +
                       tree[v].radius * Kernel::Vector_3(std::cos(2 * CGAL_PI * k / n),
                                                         std::sin(2 * CGAL_PI * k / n),
                                                         0.1));
  return points;
}

double total_length(const Orl_coordinates& x)
{
  double sum = 0;
  for (const double l : x.length)
    sum += l;
  return sum;
}

double sum_of_distances(const Space& space, const Orl_coordinates& x, bool is_squared)
{
  double sum = 0;
  for (std::size_t h = 0; h < space.number_of_trees(); ++h) {
    const double d = distance(x,
                              space.tree(h).coordinates(),
                              space.family().weights,
                              is_squared ? Orl_metric::square : Orl_metric::sum);
    sum += is_squared ? d * d : d;
  }
  return sum;
}

struct Family : Space
{
  explicit Family(std::size_t n = 6, unsigned seed = 3) : Space(make_space(relatives(n, seed))) {}
};

} // namespace

BOOST_AUTO_TEST_SUITE(orl_topology)

BOOST_AUTO_TEST_CASE(branches_of_relatives_are_the_same_branches)
{
  // The original tree has 1 + 5 + 25 branches; wrong matches would add more.
  const Family space(8);
  const std::size_t n = space.family().layout.branches.size();
  BOOST_TEST(n >= 31u);
  BOOST_TEST(n <= 33u);
  for (std::size_t h = 0; h < 8; ++h)
    BOOST_TEST(space.has_branch(h, 0));
}

BOOST_AUTO_TEST_CASE(trees_of_the_space_are_the_inputs)
{
  const std::vector<Tree> trees = relatives(5, 4);
  const Space space = make_space(trees);
  for (std::size_t h = 0; h < trees.size(); ++h) {
    Tree back;
    space.skeleton(space.tree(h), back);
    const auto length = [](const Tree& tree) {
      double sum = 0;
      for (const auto e : boost::make_iterator_range(edges(tree)))
        sum += std::sqrt(
            CGAL::squared_distance(tree[source(e, tree)].point, tree[target(e, tree)].point));
      return sum;
    };
    // Axes are straight between nodes, and branches begin on them.
    BOOST_TEST(std::abs(total_length(space.tree(h).coordinates()) / length(trees[h]) - 1) < 0.03);
    for (std::size_t b = 0; b < space.family().layout.branches.size(); ++b)
      if (space.has_branch(h, b)) {
        // Tips are at their original positions, up to the shift by the straight axes of the
        // parents.
        const Point tip = trees[h][space.tip_of_branch(h, b)].point;
        double least = 1e300;
        for (std::size_t v = 0; v < num_vertices(back); ++v)
          least = std::min(least, CGAL::squared_distance(back[v].point, tip));
        BOOST_TEST(std::sqrt(least) < 0.03 * 10);
      }
  }
}

BOOST_AUTO_TEST_CASE(the_axioms_hold_on_the_shared_topology)
{
  const Family space;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto draw = [&] {
    std::vector<double> w(space.number_of_trees());
    for (double& x : w)
      x = std::abs(normal(random));
    return pcs::weighted_mean(space, w);
  };
  for (int i = 0; i < 200; ++i) {
    const pcs::Orl_tree x = draw(), y = draw(), z = draw();
    for (const Orl_metric metric : {Orl_metric::sum, Orl_metric::square, Orl_metric::cone}) {
      const auto d = [&](const pcs::Orl_tree& a, const pcs::Orl_tree& b) {
        return space.distance(a, b, np::metric(metric));
      };
      BOOST_TEST(d(x, x) == 0);
      BOOST_TEST(d(x, y) > 0);
      BOOST_TEST(std::abs(d(x, y) - d(y, x)) <= 1e-12 * d(x, y));
      BOOST_TEST(d(x, z) <= (d(x, y) + d(y, z)) * (1 + 1e-12));
    }
  }
  const std::vector<double> all = pcs::distance_matrix(space);
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < 6; ++b) {
      BOOST_TEST(all[a * 6 + b] == all[b * 6 + a]);
      BOOST_TEST((a == b) == (all[a * 6 + b] == 0));
    }
}

BOOST_AUTO_TEST_CASE(the_order_of_the_trees_does_not_matter)
{
  const std::vector<Tree> trees = relatives(7, 5, 0.3, 0.3);
  const Space space = make_space(trees);
  std::mt19937 random(2);
  for (int i = 0; i < 3; ++i) {
    std::vector<std::size_t> order{0, 1, 2, 3, 4, 5, 6};
    std::shuffle(order.begin(), order.end(), random);
    std::vector<Tree> other;
    for (const std::size_t k : order)
      other.push_back(trees[k]);
    const Space permuted = make_space(other);
    BOOST_REQUIRE(permuted.family().layout.branches.size() ==
                  space.family().layout.branches.size());
    for (std::size_t a = 0; a < 7; ++a)
      for (std::size_t b = 0; b < a; ++b)
        BOOST_TEST(std::abs(permuted.distance(a, b) - space.distance(order[a], order[b])) <
                   1e-6 * space.distance(order[a], order[b]));
    for (const Tree_mean kind : {Tree_mean::median, Tree_mean::frechet}) {
      const pcs::Orl_tree m = pcs::mean_tree(space, np::tree_mean(kind)),
                          p = pcs::mean_tree(permuted, np::tree_mean(kind));
      // Roots of both means are in the axes of their first tree, which has the same position here.
      BOOST_TEST(
          distance(m.coordinates(), p.coordinates(), space.family().weights, Orl_metric::sum) <
          1e-6 * total_length(m.coordinates()));
    }
  }
}

BOOST_AUTO_TEST_CASE(odd_groups_have_a_topology)
{
  Tree line;
  const auto a = add_vertex(pcs::Tree_node<Kernel>(), line);
  const auto b = add_vertex(pcs::Tree_node<Kernel>(), line);
  line[b].point = Point(0, 0, 2);
  add_edge(a, b, line);
  // Equal trees, trees of a single branch, and trees with only the trunk in common.
  for (const std::vector<Tree>& trees :
       {std::vector<Tree>(4, line),
        std::vector<Tree>(3, relatives(1, 8)[0]),
        std::vector<Tree>{line, relatives(1, 8)[0], relatives(1, 99)[0]}}) {
    const Space space = make_space(trees);
    const pcs::Orl_tree mean = pcs::mean_tree(space);
    BOOST_TEST(std::isfinite(total_length(mean.coordinates())));
    const auto modes = pcs::find_modes(space, 5);
    BOOST_TEST(modes.size() < trees.size());
    const auto tree = pcs::sample_tree(space, 1);
    BOOST_TEST(std::isfinite(total_length(tree.coordinates())));
    BOOST_TEST(total_length(tree.coordinates()) > 0);
    if (trees[0][0].point == trees[1][0].point &&
        num_vertices(trees[0]) == num_vertices(trees[2])) {
      BOOST_TEST(modes.size() == 0u);
      BOOST_TEST(space.distance(tree, space.tree(0)) < 1e-9);
    }
  }
}

BOOST_AUTO_TEST_CASE(a_further_tree_finds_its_place)
{
  std::vector<Tree> trees = relatives(7, 6);
  const Tree last = trees.back();
  trees.pop_back();
  const Space space = make_space(trees);
  double share = 0;
  const pcs::Orl_tree placed = space.embed(last, np::default_values(), &share);
  BOOST_TEST(share > 0.95);
  BOOST_TEST(share <= 1 + 1e-9);
  // An added tree is reproduced.
  const pcs::Orl_tree own = space.embed(trees[2]);
  BOOST_TEST(space.distance(own, space.tree(2)) < 0.1 * space.distance(own, space.tree(3)));
  const auto modes = pcs::find_modes(space, 3);
  const double usual = pcs::outlier_score(space, modes, placed);
  BOOST_TEST(usual > 0.3);
  BOOST_TEST(usual < 2);
  const pcs::Orl_tree strange = space.embed(relatives(1, 77)[0]);
  BOOST_TEST(pcs::outlier_score(space, modes, strange) > 1.5 * usual);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_means)

BOOST_AUTO_TEST_CASE(no_tree_near_the_mean_is_better)
{
  const Family space(5);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const bool is_squared : {false, true}) {
    const Orl_coordinates mean =
        pcs::mean_tree(space, np::tree_mean(is_squared ? Tree_mean::frechet : Tree_mean::median))
            .coordinates();
    const double least = sum_of_distances(space, mean, is_squared);
    std::size_t number_better = 0;
    for (int i = 0; i < 2000; ++i) {
      Orl_coordinates x = mean;
      const auto e = static_cast<std::size_t>(random()) % x.length.size();
      const auto b = static_cast<std::size_t>(random()) % x.attachment.size();
      const double scale = std::pow(10.0, -2 - 2 * (i % 2));
      x.orientation[e] =
          x.orientation[e] *
          pcs::rotation_exp(scale * pcs_test::drawn<Vec3>([&] { return normal(random); }));
      x.length[e] = std::max(0.0, x.length[e] + scale * normal(random));
      x.radius[e] = std::max(0.0, x.radius[e] + scale * normal(random));
      x.base_radius[b] += scale * normal(random);
      x.attachment[b] += scale * normal(random);
      x.root += scale * pcs_test::drawn<Vec3>([&] { return normal(random); });
      number_better += sum_of_distances(space, x, is_squared) < least * (1 - 1e-12);
    }
    BOOST_TEST(number_better == 0u);
  }
}

BOOST_AUTO_TEST_CASE(the_mean_of_two_is_a_midpoint)
{
  const Space space = make_space(relatives(2, 9));
  const double whole = space.distance(0, 1);
  for (const Tree_mean kind : {Tree_mean::median, Tree_mean::frechet}) {
    const pcs::Orl_tree mean = pcs::mean_tree(space, np::tree_mean(kind));
    BOOST_TEST(std::abs(space.distance(mean, space.tree(0)) - whole / 2) < 1e-9 * whole);
    BOOST_TEST(std::abs(space.distance(mean, space.tree(1)) - whole / 2) < 1e-9 * whole);
  }
  const pcs::Orl_tree part = pcs::weighted_mean(space, {3, 1});
  BOOST_TEST(space.distance(part, space.geodesic(0, 1, 0.25)) < 1e-9 * whole);
}

BOOST_AUTO_TEST_CASE(gross_outliers_do_not_move_an_L1_rotation)
{
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    const Quaternion center =
        pcs::rotation_exp(pcs_test::drawn<Vec3>([&] { return normal(random); }));
    std::vector<Quaternion> q;
    for (int k = 0; k < 10; ++k) {
      const Vec3 u = k < 7
                         ? 0.05 * pcs_test::drawn<Vec3>([&] { return normal(random); })
                         : 1.4 * pcs_test::drawn<Vec3>([&] { return normal(random); }).normalized();
      q.push_back(center * pcs::rotation_exp(u));
      if (k % 2)
        q.back().coeffs() = -q.back().coeffs();
    }
    const std::vector<double> w(q.size(), 1);
    BOOST_TEST(angle_between(l1_mean_rotation(q, w), center) < 0.1);
  }
}

BOOST_AUTO_TEST_CASE(an_L1_rotation_may_be_a_data_point_or_the_middle_of_an_arc)
{
  const auto turn = [](double angle) { return pcs::rotation_exp(Vec3(0, 0, angle)); };
  const auto mean = [](const std::vector<Quaternion>& q, const std::vector<double>& w) {
    return l1_mean_rotation(q, w);
  };
  BOOST_TEST(angle_between(mean({turn(0), turn(0.2), turn(1)}, {1, 1, 1}), turn(0.2)) < 1e-12);
  BOOST_TEST(angle_between(mean({turn(0), turn(0.2), turn(0.4), turn(1)}, {1, 1, 1, 1}),
                           turn(0.3)) < 1e-9);
  BOOST_TEST(angle_between(mean({turn(0), turn(1)}, {1, 1}), turn(0.5)) < 1e-9);
  BOOST_TEST(angle_between(mean({turn(0), turn(1)}, {1, 3}), turn(1)) < 1e-9);
  BOOST_TEST(angle_between(mean({turn(0.3)}, {1}), turn(0.3)) < 1e-12);
  // The weight exceeds the pull of all others, which are not symmetric.
  const Quaternion a = pcs::rotation_exp(Vec3(0.5, 0, 0)), b = pcs::rotation_exp(Vec3(0, 0.6, 0));
  BOOST_TEST(angle_between(mean({a, b, turn(0.1)}, {1, 1, 2.1}), turn(0.1)) < 1e-12);
}

BOOST_AUTO_TEST_CASE(combinations_are_between_and_directions_are_free)
{
  const Family space(4);
  for (std::size_t h = 0; h < 4; ++h) {
    std::vector<double> w(4, 0);
    w[h] = 2;
    BOOST_TEST(space.distance(pcs::weighted_mean(space, w), space.tree(h)) < 1e-9);
  }
  const pcs::Orl_tree half = pcs::weighted_mean(space, {1, 1, 0, 0});
  BOOST_TEST(space.distance(half, space.geodesic(0, 1, 0.5)) < 1e-9 * space.distance(0, 1));
  const pcs::Orl_tree moved =
      pcs::parallel_displacement(space, space.tree(0), space.tree(0), space.tree(1), 1);
  BOOST_TEST(space.distance(moved, space.tree(1)) < 1e-9 * space.distance(0, 1));
  const pcs::Orl_tree same =
      pcs::parallel_displacement(space, space.tree(2), space.tree(0), space.tree(1), 0);
  BOOST_TEST(space.distance(same, space.tree(2)) < 1e-9);
  const pcs::Orl_tree beyond = pcs::weighted_mean(space, {2, -1, 0.5, 0});
  for (const double l : beyond.coordinates().length)
    BOOST_TEST(l >= 0);
}

BOOST_AUTO_TEST_CASE(radii_stay_positive_beyond_the_inputs)
{
  const std::vector<Branch> thick = random_branches(5, 3, 2);
  std::vector<Branch> thin = thick;
  for (Branch& b : thin)
    for (double& r : b.radii)
      r *= 0.2;
  const std::vector<char> all(thick.size(), 1);
  const Turns still(thick.size(), Eigen::Matrix3d::Identity());
  std::vector<std::size_t> tip;
  const Space space =
      make_space({make_tree(thick, still, all, tip), make_tree(thin, still, all, tip)});
  const pcs::Orl_tree beyond = pcs::weighted_mean(space, {-1, 2});
  const auto& x = beyond.coordinates();
  std::size_t number_there = 0;
  for (std::size_t e = 0; e < x.length.size(); ++e)
    if (x.length[e] > 0) {
      ++number_there;
      BOOST_TEST(x.radius[e] > 0);
    }
  BOOST_TEST(number_there > 10u);
}

BOOST_AUTO_TEST_SUITE_END()

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

BOOST_AUTO_TEST_SUITE(orl_modes)

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

BOOST_AUTO_TEST_CASE(moments_are_limited_by_the_least_change)
{
  pcs::shape_space::internal::Figure_range mean, deviation;
  mean.add(0.5);
  mean.add(0.6);
  deviation.add(0.1);
  deviation.add(0.2);
  std::vector<double> angles{0.2, 0.4, 0.6, 0.8}; // mean 0.5, deviation 0.2236
  pcs::shape_space::internal::limit_moments(mean, deviation, angles);
  const double factor = 0.2 / std::sqrt(0.05);
  for (std::size_t i = 0; i < 4; ++i)
    BOOST_TEST(std::abs(angles[i] - (0.5 + factor * (0.2 * static_cast<double>(i) - 0.3))) < 1e-12);
  const std::vector<double> inside = angles;
  pcs::shape_space::internal::limit_moments(mean, deviation, angles);
  for (std::size_t i = 0; i < 4; ++i)
    BOOST_TEST(std::abs(angles[i] - inside[i]) < 1e-12);
  std::vector<double> steep{-0.0, 0, 0, 3.0}; // the smallest values are limited to 0
  pcs::shape_space::internal::limit_moments(mean, deviation, steep);
  double m = 0;
  for (const double a : steep) {
    BOOST_TEST(a >= 0);
    m += a / 4;
  }
  BOOST_TEST(m > 0.5 - 1e-3);
  BOOST_TEST(m < 0.6 + 1e-3);
}

BOOST_AUTO_TEST_CASE(branches_keep_their_slant)
{
  // The branches of the input trees have equal slants and random azimuths about an upright trunk.
  // The slants of new trees are equal to these.
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
  // Points of a new tree lie near its axes, within their radii.
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

BOOST_AUTO_TEST_SUITE(orl_growth)

BOOST_AUTO_TEST_CASE(archetypes_of_graph_range_key_map_and_value)
{
  // Minimal requirements: a graph without properties, a scan of generated keys, maps that read by
  // value.
  using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;
  using Bare_point = pcs_test::Triple_archetype<double>;
  std::vector<std::vector<Bare_point>> nodes(3), scans(3);
  std::vector<std::vector<float>> radii(3);
  Space space;
  for (std::size_t t = 0; t < 3; ++t) {
    const Tree tree = relatives(3, 81)[t];
    Graph graph(num_vertices(tree));
    for (const auto e : boost::make_iterator_range(edges(tree)))
      add_edge(source(e, tree), target(e, tree), graph);
    for (std::size_t v = 0; v < num_vertices(tree); ++v) {
      nodes[t].emplace_back(tree[v].point.x(), tree[v].point.y(), tree[v].point.z());
      radii[t].push_back(static_cast<float>(tree[v].radius));
    }
    for (const Point& p : rings(tree))
      scans[t].emplace_back(p.x(), p.y(), p.z());
    const auto maps = [&](std::size_t i) {
      return np::node_point_map(boost::make_iterator_property_map(nodes[i].begin(),
                                                                  get(boost::vertex_index, graph)))
          .node_radius_map(
              boost::make_iterator_property_map(radii[i].begin(), get(boost::vertex_index, graph)));
    };
    space.add(graph,
              pcs_test::Range_archetype(scans[t].size()),
              maps(t).point_map(pcs_test::Map_archetype<Bare_point>(scans[t])));
    if (t == 2) {
      space.build();
      BOOST_TEST(space.distance(space.embed(graph, maps(2)), space.tree(2)) <
                 0.2 * space.distance(0, 2));
    }
  }
  const pcs::Orl_tree tree = pcs::mean_tree(space);
  std::vector<Bare_point> out(tree.number_of_points(), Bare_point(0, 0, 0));
  pcs_test::Range_archetype range(out.size());
  BOOST_TEST(space.points(tree, range, np::point_map(pcs_test::Map_archetype<Bare_point>(out))) ==
             out.size());
  double high = 0;
  for (const Bare_point& p : out)
    high = std::max(high, p.z());
  BOOST_TEST(high > 5);
}

BOOST_AUTO_TEST_CASE(the_path_goes_through_all_trees_smoothly)
{
  const Family space(4);
  const std::vector<double> times{0, 1, 3, 4};
  const auto path = pcs::fit_growth_path(space, {2, 0, 1, 3}, times);
  const std::size_t order[] = {2, 0, 1, 3};
  for (std::size_t i = 0; i < 4; ++i) {
    Tree a, b;
    space.skeleton(pcs::tree_at_time(space, path, times[i]), a);
    space.skeleton(space.tree(order[i]), b);
    BOOST_REQUIRE(num_vertices(a) == num_vertices(b));
    for (std::size_t v = 0; v < num_vertices(a); ++v)
      BOOST_TEST(CGAL::squared_distance(a[v].point, b[v].point) < 1e-16);
  }
  // The speed is continuous at an inner tree.
  const double h = 1e-5;
  const auto at = [&](double t) { return pcs::tree_at_time(space, path, t); };
  const Orl_coordinates l = at(1 - h).coordinates(), m = at(1).coordinates(),
                        r = at(1 + h).coordinates();
  double worst = 0;
  for (std::size_t e = 0; e < m.length.size(); ++e) {
    worst =
        std::max(worst, std::abs((r.length[e] - m.length[e]) - (m.length[e] - l.length[e])) / h);
    const Vec3 before = pcs::rotation_log(l.orientation[e].conjugate() * m.orientation[e]);
    const Vec3 after = pcs::rotation_log(m.orientation[e].conjugate() * r.orientation[e]);
    worst = std::max(worst, (after - before).norm() / h);
  }
  BOOST_TEST(worst < 1e-3);
  BOOST_TEST(
      space.distance(pcs::tree_at_time(space, path, -5), pcs::tree_at_time(space, path, 0)) == 0);
}

BOOST_AUTO_TEST_CASE(nothing_shrinks_when_asked)
{
  const Family space(5);
  const auto path =
      pcs::fit_growth_path(space, {0, 1, 2, 3, 4}, {0, 1, 2, 3, 4}, np::is_monotone(true));
  const auto free = pcs::fit_growth_path(space, {0, 1, 2, 3, 4}, {0, 1, 2, 3, 4});
  Orl_coordinates last = pcs::tree_at_time(space, path, 0).coordinates();
  Orl_coordinates last_free = pcs::tree_at_time(space, free, 0).coordinates();
  std::size_t number_shrunk = 0, number_shrunk_free = 0;
  for (int k = 1; k <= 80; ++k) {
    const Orl_coordinates x = pcs::tree_at_time(space, path, 0.05 * k).coordinates();
    const Orl_coordinates y = pcs::tree_at_time(space, free, 0.05 * k).coordinates();
    for (std::size_t e = 0; e < x.length.size(); ++e) {
      number_shrunk +=
          x.length[e] < last.length[e] * (1 - 1e-12) || x.radius[e] < last.radius[e] * (1 - 1e-12);
      number_shrunk_free += y.length[e] < last_free.length[e] * (1 - 1e-12);
      BOOST_TEST(y.length[e] >= 0);
    }
    last = x;
    last_free = y;
  }
  BOOST_TEST(number_shrunk == 0u);
  BOOST_TEST(number_shrunk_free > 0u);
}

BOOST_AUTO_TEST_CASE(changes_are_named)
{
  const std::vector<Branch> all = random_branches(41, 4, 2);
  std::vector<Branch> later = all;
  Turns still(all.size(), Eigen::Matrix3d::Identity()), turned = still;
  std::vector<char> first(all.size(), 1);
  first[1] = 0; // new
  for (Vec3& p : later[3].points)
    p *= 1.3;
  for (double& r : later[4].radii)
    r *= 1.5;
  turned[4] = Eigen::AngleAxisd(0.4, Vec3(0, 0, 1)).toRotationMatrix();
  std::vector<std::size_t> tip_a, tip_b;
  const Tree a = make_tree(all, still, first, tip_a),
             b = make_tree(later, turned, std::vector<char>(all.size(), 1), tip_b);
  const Space space = make_space({a, b});
  const auto changes = pcs::find_branch_changes(space, 0, 1);
  BOOST_TEST(changes.size() == 5u);
  Space in_world_axes;
  in_world_axes.add_skeleton(a);
  in_world_axes.add_skeleton(b);
  in_world_axes.build(np::orientation(pcs::Orl_orientation::world_axes));
  const auto same = pcs::find_branch_changes(in_world_axes, 0, 1);
  BOOST_TEST_REQUIRE(same.size() == changes.size());
  for (std::size_t i = 0; i < same.size(); ++i) {
    BOOST_TEST(same[i].is_turned == changes[i].is_turned);
    BOOST_TEST(std::abs(same[i].angle - changes[i].angle) < 1e-9);
  }
  for (const std::size_t t : {0u, 1u})
    BOOST_TEST(in_world_axes.distance(in_world_axes.embed(t == 0 ? a : b), in_world_axes.tree(t)) <
               2 * space.distance(space.embed(t == 0 ? a : b), space.tree(t)) + 1e-3);
  for (const Branch_change& c : changes) {
    const std::size_t in_a = space.tip_of_branch(0, c.branch),
                      in_b = space.tip_of_branch(1, c.branch);
    std::size_t k = 0;
    while (k < 5 && !(in_a != pcs::npos && tip_a[k] == in_a) &&
           !(in_b != pcs::npos && tip_b[k] == in_b))
      ++k;
    BOOST_TEST_CONTEXT("branch " << k)
    {
      BOOST_TEST(c.is_new == (k == 1));
      BOOST_TEST(!c.is_lost);
      BOOST_TEST(c.is_longer == (k == 3));
      BOOST_TEST(c.is_thicker == (k == 4));
      BOOST_TEST(c.is_turned == (k == 4));
      BOOST_TEST(!c.is_shorter);
      BOOST_TEST(!c.is_thinner);
      if (k == 3)
        BOOST_TEST(std::abs(c.length[1] / c.length[0] - 1.3) < 1e-6);
      if (k == 4)
        BOOST_TEST(c.angle > 0.05);
    }
  }
  // The opposite order.
  std::size_t number_lost = 0, number_shorter = 0, number_thinner = 0, number_new = 0;
  for (const Branch_change& c : pcs::find_branch_changes(space, 1, 0)) {
    number_lost += c.is_lost;
    number_shorter += c.is_shorter;
    number_thinner += c.is_thinner;
    number_new += c.is_new;
  }
  BOOST_TEST(number_lost == 1u);
  BOOST_TEST(number_shorter == 1u);
  BOOST_TEST(number_thinner == 1u);
  BOOST_TEST(number_new == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_family_files)

BOOST_AUTO_TEST_CASE(a_space_with_folds_is_saved_and_restored)
{
  const auto trunk = [](double fold) {
    Tree tree;
    std::size_t last = pcs::npos;
    for (const double z : {0., 1., 2., 2. - fold, 3., 4.}) {
      pcs::Tree_node<Kernel> node;
      node.point = Point(0.1 * z * z, 0.01 * z, z);
      node.radius = 0.1;
      const std::size_t v = add_vertex(node, tree);
      if (last != pcs::npos)
        add_edge(last, v, tree);
      last = v;
    }
    return tree;
  };
  Space space, other;
  space.add_skeleton(trunk(0.2));
  space.add_skeleton(trunk(-0.2));
  space.build();
  const pcs::Orl_space_data data = space.data();
  BOOST_TEST(!data.references.empty());
  const std::string path =
      (std::filesystem::temp_directory_path() / ("pcs_folds_" + std::to_string(getpid()) + ".txt"))
          .string();
  pcs::IO::write_shape_space(path, data);
  other.restore(pcs::IO::read_shape_space(path));
  std::filesystem::remove(path);
  Tree one, two;
  space.skeleton(space.geodesic(0, 1, 0.4), one);
  other.skeleton(other.geodesic(0, 1, 0.4), two);
  BOOST_REQUIRE(num_vertices(one) == num_vertices(two));
  for (std::size_t v = 0; v < num_vertices(one); ++v)
    BOOST_TEST((one[v].point == two[v].point));
}

BOOST_AUTO_TEST_CASE(weights_of_the_matching_are_kept)
{
  Matching_weights weights;
  weights.trunk_fork_ratio = 0.125;
  weights.number_of_paths = 2000;
  Space space, other;
  for (const Tree& tree : relatives(3, 51))
    space.add_skeleton(tree);
  space.build(np::matching_weights(weights));
  other.restore(space.data());
  BOOST_TEST((other.data().matching == space.data().matching));
  BOOST_TEST(other.data().matching.back() == 0.125);
}

BOOST_AUTO_TEST_CASE(a_space_is_saved_and_restored)
{
  for (const std::size_t n : {std::size_t(2), std::size_t(4)}) {
    const std::vector<Tree> trees = relatives(n, 51);
    Space space;
    for (const Tree& tree : trees)
      space.add(tree, rings(tree));
    space.build();
    const std::string path = (std::filesystem::temp_directory_path() /
                              ("pcs_space_" + std::to_string(getpid()) + ".txt"))
                                 .string();
    pcs::IO::write_shape_space(path, space.data());
    Space other;
    other.restore(pcs::IO::read_shape_space(path));
    BOOST_TEST(other.number_of_trees() == n);
    const pcs::Orl_tree a = pcs::sample_tree(space, 9), b = pcs::sample_tree(other, 9);
    BOOST_TEST(space.distance(a, b) == 0);
    std::vector<Point> p, q;
    space.points(a, p);
    other.points(b, q);
    BOOST_TEST((p == q));
    BOOST_TEST(p.size() > 100u);
    BOOST_TEST(other.distance(0, 1) == space.distance(0, 1));
    double share = 0;
    BOOST_TEST(space.distance(space.embed(trees[0]),
                              other.embed(trees[0], np::default_values(), &share)) == 0);
    BOOST_CHECK_THROW(other.build(), pcs::Invalid_input);
    BOOST_CHECK_THROW(other.add_skeleton(trees[0]), pcs::Invalid_input);

    // A truncated file is rejected.
    std::string text;
    {
      std::ifstream in(path);
      text.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
    std::ofstream(path) << text.substr(0, text.size() / 2);
    BOOST_CHECK_THROW(pcs::IO::read_shape_space(path), pcs::IO_error);
    std::filesystem::remove(path);

    // Invalid values are rejected.
    const pcs::Orl_space_data good = space.data();
    const auto refuse = [&](const auto& spoil) {
      pcs::Orl_space_data bad = good;
      spoil(bad);
      BOOST_CHECK_THROW(other.restore(bad), pcs::Invalid_input);
    };
    refuse([](auto& d) { d.branches[1].parent = 5; });
    refuse([](auto& d) { d.branches[1].reference_edge = 100000; });
    refuse([](auto& d) { d.references.push_back({0, 0}); });
    refuse([](auto& d) { d.references.push_back({100000, 1}); });
    refuse([](auto& d) { // the first edge of a branch, and the last one of its parent
      d.references.push_back({d.branches[0].number_of_edges, d.branches[0].number_of_edges - 1});
    });
    refuse([](auto& d) { d.trees[0].length[3] = -1; });
    refuse([](auto& d) { d.trees[1].orientation[0] = {0, 0, 0, 0}; });
    refuse([](auto& d) { d.trees[0].attachment[1] = 1000; });
    refuse([](auto& d) { d.trees.resize(1); });
    refuse([](auto& d) { d.weights.length.pop_back(); });
    refuse([](auto& d) { d.matching[8] = 0; });
    refuse([](auto& d) {
      if (d.points.empty())
        d.trees[0].has[0] = 0; // two trees have pairs, not partners
      d.partners.emplace_back();
      d.partners.back().point = 1u << 30;
    });
    refuse([](auto& d) {
      if (!d.pairs.empty())
        d.pairs[0].edge = 1000000;
      if (!d.points.empty())
        d.points[0].tree = 77;
    });
    BOOST_TEST(other.distance(0, 1) == space.distance(0, 1)); // unchanged
  }
}

BOOST_AUTO_TEST_CASE(threads_do_not_matter)
{
  const std::vector<Tree> trees = relatives(5, 61, 0.3, 0.3);
  const auto run = [&](auto tag) {
    pcs::Orl_shape_space<Kernel, decltype(tag)> space;
    for (const Tree& tree : trees)
      space.add(tree, rings(tree));
    space.build();
    std::vector<double> figures = pcs::distance_matrix(space);
    for (const pcs::Orl_tree& tree : {pcs::mean_tree(space), pcs::sample_tree(space, 4)}) {
      std::vector<Point> points;
      space.points(tree, points);
      for (const Point& p : points)
        figures.push_back(p.x() + 3 * p.y() + 7 * p.z());
    }
    const auto modes = pcs::find_modes(space, 3);
    figures.insert(figures.end(), modes.scores.data(), modes.scores.data() + modes.scores.size());
    return figures;
  };
  const std::vector<double> one = run(CGAL::Sequential_tag());
  for (const int n : {1, 2, 4}) {
    std::vector<double> many;
    pcs_test::with_threads(n, [&] { many = run(CGAL::Parallel_if_available_tag()); });
    BOOST_TEST((many == one));
  }
}

BOOST_AUTO_TEST_CASE(a_cancelled_build_leaves_no_space)
{
  Space space;
  for (const Tree& tree : relatives(4, 71))
    space.add(tree, rings(tree));
  std::vector<double> seen;
  const auto report = space.build(np::callback([&](double f) {
    seen.push_back(f);
    return f < 0.4;
  }));
  BOOST_TEST(report.status == pcs::Status::cancelled);
  BOOST_TEST(std::is_sorted(seen.begin(), seen.end()));
  BOOST_CHECK_THROW(pcs::mean_tree(space), pcs::Invalid_input);
  BOOST_TEST(space.build().status == pcs::Status::converged);
  BOOST_TEST(space.number_of_trees() == 4u);
}

BOOST_AUTO_TEST_CASE(wrong_values_are_named)
{
  Space space;
  BOOST_CHECK_EXCEPTION(pcs::mean_tree(space),
                        pcs::Invalid_input,
                        message_has("call build() first"));
  BOOST_CHECK_EXCEPTION(space.data(), pcs::Invalid_input, message_has("call build() first"));
  for (const Tree& tree : relatives(3, 72))
    space.add_skeleton(tree);
  BOOST_CHECK_EXCEPTION(space.build(np::number_of_rounds(0)),
                        pcs::Invalid_input,
                        message_has("number_of_rounds"));
  BOOST_CHECK_EXCEPTION(space.build(np::points_of(std::size_t(3))),
                        pcs::Invalid_input,
                        message_has("points_of"));
  space.build();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BOOST_CHECK_EXCEPTION(space.tree(3), pcs::Invalid_input, message_has("no tree 3"));
  BOOST_CHECK_EXCEPTION(pcs::weighted_mean(space, {1, 1}),
                        pcs::Invalid_input,
                        message_has("2 weights for 3"));
  BOOST_CHECK_THROW(pcs::weighted_mean(space, {1, nan, 1}), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::weighted_mean(space, {1, -1, 0}), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::mean_tree(space, np::tree_weights(std::vector<double>{1, -1, 3})),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::fit_growth_path(space, {0}, {0}), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::fit_growth_path(space, {0, 1}, {1, 1}), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::fit_growth_path(space, {0, 7}, {0, 1}), pcs::Invalid_input);
  BOOST_CHECK_THROW(space.for_each_point(space.tree(0), [](auto...) {}), pcs::Invalid_input);
  BOOST_CHECK_THROW(space.correspondences(), pcs::Invalid_input);
  pcs::Orl_space_data stored = space.data();
  stored.trees[1].length[0] = 1e300; // finite, but its square is not
  BOOST_CHECK_EXCEPTION(Space().restore(stored), pcs::Invalid_input, message_has("1e100"));
  const auto modes = pcs::find_modes(space, 2);
  BOOST_CHECK_THROW(pcs::tree_of_modes(space, modes, {1, 2, 3}), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::tree_of_modes(space, modes, {nan}), pcs::Invalid_input);
  Tree_sampling_options options;
  options.truncation = 0;
  BOOST_CHECK_THROW(pcs::sample_tree(space, 1, np::sampling_options(options)), pcs::Invalid_input);
  const Family other(4);
  BOOST_CHECK_THROW(pcs::tree_of_modes(other, modes, {1}), pcs::Invalid_input);
  BOOST_CHECK_THROW(other.distance(space.tree(0), other.tree(0)), pcs::Invalid_input);
  BOOST_CHECK_THROW(
      pcs::find_branch_changes(space, 0, 1, np::change_limits(Change_limits{nan, 0, 0})),
      pcs::Invalid_input);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Orl_tree_family
