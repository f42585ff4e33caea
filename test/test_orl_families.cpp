// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Families of trees: independence of threads, cancellation, errors.

#include <pcs/Orl_shape_space.h>
#include <pcs/compare_trees.h>
#include <pcs/find_modes.h>
#include <pcs/fit_growth_path.h>
#include <pcs/mean_tree.h>
#include <pcs/sample_tree.h>
#include <support/exceptions.h>
#include <support/orl_families.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace test_orl_families {

using pcs::Change_limits;
using pcs::Tree_sampling_options;
using pcs_test::message_has;

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;

BOOST_AUTO_TEST_SUITE(orl_families)

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

} // namespace test_orl_families
