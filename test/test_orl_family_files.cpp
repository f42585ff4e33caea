// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Families of trees are saved and restored; files and values with errors are rejected.

#include <pcs/IO/read_shape_space.h>
#include <pcs/IO/write_shape_space.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/sample_tree.h>
#include <support/orl_families.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <unistd.h>
#include <vector>

namespace test_orl_family_files {

using pcs::Matching_weights;

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;

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
  weights.do_keep_whorls = false;
  Space space, other;
  for (const Tree& tree : relatives(3, 51))
    space.add_skeleton(tree);
  space.build(np::matching_weights(weights));
  other.restore(space.data());
  BOOST_TEST((other.data().matching == space.data().matching));
  BOOST_TEST(other.data().matching[13] == 0.125);
  BOOST_TEST(other.data().matching.back() == 0);
}

BOOST_AUTO_TEST_CASE(files_of_version_5_have_no_confidences)
{
  const std::vector<Tree> trees = relatives(2, 51);
  Space space;
  for (const Tree& tree : trees)
    space.add_skeleton(tree);
  space.build();
  const std::string path = (std::filesystem::temp_directory_path() /
                            ("pcs_version_" + std::to_string(getpid()) + ".txt"))
                               .string();
  pcs::Orl_space_data data = space.data();
  for (auto& branch : data.branches)
    branch.confidence = std::numeric_limits<double>::quiet_NaN();
  pcs::IO::write_shape_space(path, data);
  std::string text;
  {
    std::ifstream in(path);
    text.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  const std::size_t version = text.find("pcs_shape_space 6"), end = text.find(" 1\nbranches");
  BOOST_TEST_REQUIRE(version == 0u);
  BOOST_TEST_REQUIRE(end != std::string::npos); // whorls are kept
  text.erase(end, 2);
  text[16] = '5';
  for (std::size_t at = text.find("branches"), last = text.find("references");;) {
    at = text.find(" -\n", at);
    if (at > last)
      break;
    text.erase(at, 2);
    last -= 2;
  }
  std::ofstream(path) << text;
  Space other;
  other.restore(pcs::IO::read_shape_space(path));
  std::filesystem::remove(path);
  BOOST_TEST(space.distance(space.embed(trees[1]), other.embed(trees[1])) == 0);
  for (const auto& match : other.matches())
    BOOST_TEST(std::isnan(match.confidence));
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
    if (n == 2) {
      const auto matches = space.matches(), stored = other.matches();
      BOOST_TEST_REQUIRE(stored.size() == matches.size());
      std::size_t number_of_confidences = 0;
      for (std::size_t m = 0; m < matches.size(); ++m) {
        BOOST_TEST(stored[m].parent == matches[m].parent);
        BOOST_TEST((stored[m].tip == matches[m].tip));
        const double a_confidence = matches[m].confidence, b_confidence = stored[m].confidence;
        number_of_confidences += std::isfinite(a_confidence) ? 1 : 0;
        BOOST_TEST((a_confidence == b_confidence ||
                    (std::isnan(a_confidence) && std::isnan(b_confidence))));
      }
      BOOST_TEST(number_of_confidences > 0u);
    }

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
    refuse([](auto& d) { d.branches[1].confidence = 1.5; });
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

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_orl_family_files
