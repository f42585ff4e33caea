// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares correspondences with the truth of virtual trees, and predictions with scanned plants.

#include <support/growth_series.h>
#include <support/material_places.h>

#include <boost/test/unit_test.hpp>

#include <cstdlib>
#include <string>

namespace test_orl_truth {

using namespace orl_test;

BOOST_AUTO_TEST_SUITE(orl_truth)

BOOST_AUTO_TEST_CASE(points_of_a_younger_tree_find_their_branch)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(11));
  pcs::Matching_weights published;
  published.is_published = true;
  for (const double age : {0.9, 0.7}) {
    const auto own = measure_ages(tree, age, 11, 4, pcs::parameters::default_values());
    const auto text = measure_ages(tree, age, 11, 4, pcs::parameters::matching_weights(published));
    BOOST_TEST_MESSAGE("age " << age << ": right branch " << own.right_branch << ", same wood "
                              << own.same_wood << "; published " << text.right_branch << ", "
                              << text.same_wood);
    BOOST_TEST(own.number_of_points > 500u);
    BOOST_TEST(own.right_branch > 0.85);
    BOOST_TEST(own.right_branch >= text.right_branch - 0.01);
    BOOST_TEST(own.same_wood > 0.25);
  }
}

BOOST_AUTO_TEST_CASE(branches_that_grew_at_their_tips_keep_their_beginning)
{
  // At half the age, most of the wood of the old tree does not exist yet.
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(21));
  const auto measure = [&](pcs::Branch_growth growth) {
    pcs::Matching_weights weights;
    weights.growth = growth;
    return measure_ages(tree, 0.5, 21, 4, pcs::parameters::matching_weights(weights));
  };
  using pcs::Branch_growth;
  const auto any = measure(Branch_growth::any), tips = measure(Branch_growth::at_tips),
             along = measure(Branch_growth::along_branches);
  BOOST_TEST_MESSAGE("right branch " << any.right_branch << ", stretched " << along.right_branch
                                     << "; same wood " << any.same_wood << ", stretched "
                                     << along.same_wood);
  BOOST_TEST(any.right_branch == tips.right_branch);
  BOOST_TEST(any.same_wood == tips.same_wood);
  BOOST_TEST(tips.right_branch > 0.9);
  BOOST_TEST(tips.right_branch > along.right_branch);
  BOOST_TEST(tips.same_wood > along.same_wood);
}

BOOST_AUTO_TEST_CASE(a_tree_that_did_not_grow_keeps_its_wood)
{
  // Two scans of one tree; the radius of a twig is a few point spacings.
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(12));
  const auto m = measure_ages(tree, 1, 12, 4, pcs::parameters::default_values());
  BOOST_TEST_MESSAGE("right branch " << m.right_branch << ", same wood " << m.same_wood << " of "
                                     << m.attainable);
  BOOST_TEST(m.right_branch > 0.95);
  BOOST_TEST(m.same_wood > 0.5 * m.attainable);
  BOOST_TEST(m.same_wood == m.same_share);
}

BOOST_AUTO_TEST_CASE(the_trunk_of_a_growing_tree_goes_on_as_the_trunk)
{
  // The trunk of the young tree has the length of one of its last twigs. Many paths of the old tree
  // have a common beginning.
  Tree tree;
  pcs::grow_tree(tree, pcs::forked_habit(), pcs::parameters::random_seed(1));
  std::vector<std::size_t> old_nodes;
  const Tree young = pcs::tree_at_age(tree, 0.5, old_nodes);
  const Tree turned =
      moved(tree, Eigen::AngleAxisd(2, Vec3::UnitZ()).toRotationMatrix(), Vec3::Zero());
  for (const bool is_turned : {false, true}) {
    pcs::Orl_shape_space<Kernel> space;
    space.add_skeleton(young);
    space.add_skeleton(is_turned ? turned : tree);
    const auto report = space.build(pcs::parameters::alignment(
        is_turned ? pcs::Orl_alignment::rotate_about_up : pcs::Orl_alignment::as_given));
    BOOST_TEST(report.is_grown_at_tips);
    BOOST_TEST(std::abs(report.yaw + (is_turned ? 2 : 0)) < 1e-6); // wood does not rotate
    std::size_t before = space.matches()[0].tip[0];
    while (old_nodes[before] == pcs::npos)
      before = pcs::parent_node<Kernel>(before, young);
    BOOST_TEST(tree[old_nodes[before]].branch == tree[space.matches()[0].tip[1]].branch);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_growth_order)

BOOST_AUTO_TEST_CASE(a_growing_tree_is_predicted_best_with_branches_born_in_order)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::broadleaf_habit(), pcs::parameters::random_seed(31));
  Seen_plant stages[3];
  for (int k = 0; k < 3; ++k) {
    stages[k].tree = pcs::tree_at_age<Kernel>(tree, 0.5 + 0.25 * k);
    stages[k].scan = scan_wood(stages[k].tree, 100 + k, 4).points;
  }
  const Prediction p = predict({stages[0], stages[1], stages[2], 0.5, Vec3::UnitZ(), true});
  BOOST_TEST_MESSAGE("in order " << p.in_order << ", geodesic " << p.geodesic << ", linear "
                                 << p.linear << ", no change " << p.first << ", " << p.last);
  BOOST_TEST(p.is_grown_at_tips);
  BOOST_TEST(p.in_order < 0.8 * p.geodesic);
  BOOST_TEST(p.in_order < p.last);
  BOOST_TEST(p.geodesic < p.linear);
  BOOST_TEST(p.geodesic < p.first);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_truth)

BOOST_AUTO_TEST_CASE(a_plant_in_the_middle_is_predicted_from_the_ends)
{
  const char* data = std::getenv("PCS_TEST_DATA");
  if (data == nullptr) {
    BOOST_TEST_MESSAGE("skipped: PCS_TEST_DATA is not set");
    return;
  }
  const std::string folder = std::string(data) + "/orl/tomato_series/";
  const auto read = [&](const std::string& day, const std::string& extension) {
    return read_plant(folder + day + extension, folder + day + ".graph.txt", 40000);
  };
  const Seen_plant first = read("03-05", ".xyz"), middle = read("03-08", ".ply"),
                   last = read("03-10", ".ply");
  const Prediction p = predict({first, middle, last, 3. / 5, Vec3::UnitZ(), false});
  BOOST_TEST_MESSAGE("geodesic " << p.geodesic << ", linear " << p.linear << ", no change "
                                 << p.first << ", " << p.last);
  BOOST_TEST(p.geodesic < p.linear);
  BOOST_TEST(p.geodesic < p.first);
  BOOST_TEST(p.geodesic < p.last);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_orl_truth
