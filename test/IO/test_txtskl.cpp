// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading skeletons that are listed level by level.

#include "temporary_files.h"
#include <pcs/IO/read_txtskl.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <string>

namespace test_txtskl {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point_3 = Kernel::Point_3;

namespace {

struct Txtskl_files : Temporary_files
{
  void refuses(const std::string& content, const std::string& expected) const
  {
    Tree tree = pcs_test::make_small_tree<Kernel>();
    const std::size_t n = num_vertices(tree);
    std::string message = "no error";
    try {
      pcs::IO::read_txtskl<Kernel>(file("a.txtskl", content), tree);
    } catch (const pcs::IO_error& error) {
      message = error.what();
    }
    BOOST_TEST(message.find(expected) != std::string::npos, expected << " in: " << message);
    BOOST_TEST(num_vertices(tree) == n); // unchanged
  }
};

const std::string head = "2\nLayer 0\n1\n-1 -1\n3\n0 0 0 0.1\n0 1 0 0.1\n0 2 0 0.05\n";
const std::string good = head + "Layer 1\n2\n0 1\n2\n0 1 0 0.05\n1 1.5 0 0.02\n"
                                "0 2\n1\n0 3 0 0.01\n";

} // namespace

BOOST_FIXTURE_TEST_SUITE(txtskl, Txtskl_files)

BOOST_AUTO_TEST_CASE(branches_hang_on_the_points_of_their_fathers)
{
  Tree tree;
  pcs::IO::read_txtskl<Kernel>(file("a.txtskl", good), tree);
  const auto& bundle = tree[boost::graph_bundle];
  BOOST_TEST_REQUIRE(num_vertices(tree) == 6u);
  BOOST_TEST(num_edges(tree) == 5u);
  BOOST_TEST(bundle.root == 0u);
  BOOST_TEST_REQUIRE(bundle.branches.size() == 3u);
  BOOST_TEST(bundle.branches[2].parent == 0u);
  BOOST_TEST((tree[4].point == Point_3(1, 1.5, 0)));
  BOOST_TEST(tree[4].radius == 0.02);
  for (const auto& [u, v] : {std::make_pair(0, 1), {1, 2}, {1, 3}, {3, 4}, {2, 5}})
    BOOST_TEST(edge(static_cast<std::size_t>(u), static_cast<std::size_t>(v), tree).second);
  // Line ends of other systems, and no end of the last line.
  std::string other;
  for (const char c : good)
    other += c == '\n' ? std::string("\r\n") : std::string(1, c);
  other.erase(other.size() - 2);
  pcs::IO::read_txtskl<Kernel>(file("b.txtskl", other), tree);
  BOOST_TEST(num_vertices(tree) == 6u);
}

BOOST_AUTO_TEST_CASE(what_is_wrong_is_named_with_its_line)
{
  refuses("", "the number of layers");
  refuses("x", "the number of layers");
  refuses("-1", "the number of layers");
  refuses("1000000000\n", "the number of layers");
  refuses("1\nBranch 0\n", "expected 'Layer'");
  refuses("1\nLayer 7\n1\n-1 -1\n1\n0 0 0 1\n", "expected 'Layer 0', found 'Layer 7'");
  refuses(head + "Layer 3\n1\n0 1\n1\n0 1 0 0\n", "expected 'Layer 1', found 'Layer 3'");
  refuses("1\nLayer 0\n2\n", "expected 1 branch");
  refuses("1\nLayer 0\n1\n0 0\n1\n0 0 0 0\n", "there is no parent 0 0");
  refuses("1\nLayer 0\n1\n-1 -1\n0\n", "no points");
  refuses("1\nLayer 0\n1\n-1 -1\n1\n0 0 0 -1\n", "radius is negative");
  refuses("1\nLayer 0\n1\n-1 -1\n1\n0 nan 0 1\n", "finite");
  refuses("1\nLayer 0\n1\n-1 -1\n1\n0 1e999 0 1\n", "coordinate");
  refuses("1\nLayer 0\n1\n-1 -1\n1\n0 a 0 1\n", "coordinate");
  refuses(head + "Layer 1\n1\n1 0\n1\n0 0 0 0\n", "there is no parent 1 0");
  refuses(head + "Layer 1\n1\n0 3\n1\n0 0 0 0\n", "there is no parent 0 3");
  refuses(head + "Layer 1\n1\n0 -1\n1\n0 0 0 0\n", "there is no parent 0 -1");
  refuses(good + "Layer 2\n", "expected the end of the file");
  refuses(head, "expected 'Layer'");
  refuses(head + "Layer 1\n1\n0 x\n", "a.txtskl");
  Tree tree;
  BOOST_CHECK_THROW(pcs::IO::read_txtskl<Kernel>(path("missing"), tree), pcs::IO_error);
}

BOOST_AUTO_TEST_CASE(a_file_without_layers_is_refused)
{
  refuses("0\n", "expected at least 1 layer");
}

BOOST_AUTO_TEST_CASE(a_file_that_was_cut_is_refused)
{
  const std::size_t last = good.rfind(' '); // before the last radius
  for (std::size_t n = 0; n <= last; ++n)
    refuses(good.substr(0, n), "expected");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_txtskl
