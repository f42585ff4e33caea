// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading and writing SWC files.

#include "temporary_files.h"
#include <pcs/IO/read_swc.h>
#include <pcs/IO/write_swc.h>
#include <support/exceptions.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace test_swc {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point_3 = Kernel::Point_3;

namespace {

struct Swc_files : Temporary_files
{
  Tree read_tree(const std::string& content) const
  {
    Tree tree;
    pcs::IO::read_swc<Kernel>(file("a.swc", content), tree);
    return tree;
  }

  void refuses_tree(const std::string& content, const std::string& expected) const
  {
    Tree tree = pcs_test::make_small_tree<Kernel>();
    std::string message = "no error";
    try {
      pcs::IO::read_swc<Kernel>(file("bad.swc", content), tree);
    } catch (const pcs::IO_error& e) {
      message = e.what();
    }
    BOOST_TEST(message.find(expected) != std::string::npos,
               "expected '" << expected << "' in '" << message << "'");
    BOOST_TEST(num_vertices(tree) == 8u); // unchanged
  }
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(swc, Swc_files)

BOOST_AUTO_TEST_CASE(a_tree_comes_back_bit_by_bit)
{
  Tree tree = pcs_test::make_small_tree<Kernel>();
  tree[4].point = Point_3(487123.123456789, 5123456.1 / 3, -1e-17);
  tree[4].radius = 0.1 / 3;
  pcs::IO::write_swc<Kernel>(path("a.swc"), tree);
  Tree copy;
  pcs::IO::read_swc<Kernel>(path("a.swc"), copy);
  BOOST_TEST_REQUIRE(num_vertices(copy) == num_vertices(tree));
  BOOST_TEST(copy[boost::graph_bundle].root == 0u);
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    BOOST_TEST((copy[v].point == tree[v].point));
    BOOST_TEST(copy[v].radius == tree[v].radius);
    BOOST_TEST(copy[v].minor_radius == tree[v].radius);
    BOOST_TEST(copy[v].branch == tree[v].branch);
    BOOST_TEST(pcs::parent_node<Kernel>(v, copy) == pcs::parent_node<Kernel>(v, tree));
  }
  BOOST_TEST(number_of_files() == 1u);
}

BOOST_AUTO_TEST_CASE(types_tell_branches_where_they_are_orders)
{
  // Node, parent, type: node 2 continues the trunk, although 3 is thicker. Parents are after their
  // children.
  const auto branches = [&](const std::string& types) {
    const char* const rows[] = {"3 ", "2 ", "1 ", "4 "};
    const char* const places[] = {" 1 0 1 0.3 1\n",
                                  " 0 0 2 0.1 1\n",
                                  " 0 0 0 0.4 -1\n",
                                  " 2 0 1 0.2 3\n"};
    std::string content;
    for (std::size_t i = 0; i < 4; ++i)
      content += rows[i] + types.substr(2 * i, 2) + places[i];
    Tree tree;
    pcs::IO::read_swc<Kernel>(file("a.swc", content), tree);
    const auto& found = tree[boost::graph_bundle].branches;
    return std::array<bool, 3>{tree[1].branch == tree[2].branch, // the trunk continues to node 2
                               tree[0].branch == tree[2].branch,
                               found[tree[3].branch].order > found[tree[0].branch].order};
  };
  using Answer = std::array<bool, 3>;
  BOOST_TEST((branches("6 5 5 6 ") == Answer{true, false, false}));
  BOOST_TEST((branches("6 5 5 7 ") == Answer{true, false, true}));
  // Without orders, the thickest child continues.
  for (const char* const types : {"5 5 5 5 ", "0 0 0 0 ", "7 5 5 7 ", "6 5 6 6 ", "3 3 1 3 "})
    BOOST_TEST((branches(types) == Answer{false, true, false}));
}

BOOST_AUTO_TEST_CASE(ids_are_those_of_the_file)
{
  // Ids that doubles do not represent exactly, after a byte order mark.
  Tree tree;
  std::vector<std::int64_t> ids = {1};
  const std::string large = "900719925474099";
  pcs::IO::read_swc<Kernel>(file("a.swc",
                                 "\xEF\xBB\xBF" + large + "33 1 0 0 0 1 -1\r\n" + large +
                                     "31 1 0 0 1 1 " + large + "33\r\n"),
                            tree,
                            ids);
  BOOST_TEST((ids == std::vector<std::int64_t>{90071992547409933, 90071992547409931}));
  pcs::IO::read_swc<Kernel>(file("b.swc", "\xEF\xBB\xBF# a remark\n7 1 0 0 0 1 -1\n"), tree, ids);
  BOOST_TEST((ids == std::vector<std::int64_t>{7}));
}

BOOST_AUTO_TEST_CASE(the_text_is_as_the_format_wants_it)
{
  const Tree tree = pcs_test::make_tree<Kernel>(
      {{pcs::npos, 0, 0, 0, 0, 0.5}, {0, 0, 0, 0.25, 1, 0.25}, {1, 1, 0, 0.25, 1, 0.125}});
  pcs::IO::write_swc<Kernel>(path("a.swc"), tree);
  BOOST_TEST(content("a.swc") ==
             "# id type x y z radius parent\n1 5 0 0 0 0.5 -1\n2 5 0 0.25 1 0.25 1\n"
             "3 6 0 0.25 1 0.125 2\n");
}

BOOST_AUTO_TEST_CASE(parents_come_first_even_if_the_graph_numbers_them_otherwise)
{
  const Tree tree = pcs_test::make_tree<Kernel>(
      {{2, 0, 0, 0, 2, 0.1}, {pcs::npos, 0, 0, 0, 0, 0.3}, {1, 0, 0, 0, 1, 0.2}});
  pcs::IO::write_swc<Kernel>(path("a.swc"), tree);
  BOOST_TEST(content("a.swc") ==
             "# id type x y z radius parent\n1 5 0 0 0 0.3 -1\n2 5 0 0 1 0.2 1\n"
             "3 5 0 0 2 0.1 2\n");
}

BOOST_AUTO_TEST_CASE(any_graph_with_two_maps_can_be_written)
{
  using Graph = boost::adjacency_list<boost::listS, boost::vecS, boost::directedS>;
  Graph graph(2);
  add_edge(0, 1, graph);
  const std::vector<Point_3> points = {Point_3(1, 2, 3), Point_3(4, 5, 6)};
  const std::vector<float> radii = {0.5f, 0.25f};
  const auto index = boost::typed_identity_property_map<std::size_t>();
  pcs::IO::write_swc(path("a.swc"),
                     graph,
                     0,
                     boost::make_iterator_property_map(points.begin(), index),
                     boost::make_iterator_property_map(radii.begin(), index));
  BOOST_TEST(content("a.swc") == "# id type x y z radius parent\n1 0 1 2 3 0.5 -1\n"
                                 "2 0 4 5 6 0.25 1\n");
}

BOOST_AUTO_TEST_CASE(comments_blank_lines_and_children_before_parents_are_fine)
{
  const Tree tree = read_tree("# made by hand\r\n\r\n 7 3 1 2 3 .5 9 \r\n9 3 +1 2 0 1e0 -1\r\n");
  BOOST_TEST(num_vertices(tree) == 2u);
  BOOST_TEST(tree[boost::graph_bundle].root == 1u);
  BOOST_TEST((tree[0].point == Point_3(1, 2, 3)));
  BOOST_TEST(pcs::parent_node<Kernel>(0, tree) == 1u);
}

BOOST_AUTO_TEST_CASE(malformed_files_are_refused_with_the_line)
{
  refuses_tree("", "the file has no node");
  refuses_tree("# nothing\n", "the file has no node");
  refuses_tree("1 0 0 0 0 1 -1\n2 0 0 0 1 1\n", "line 2: expected the 7 columns");
  refuses_tree("1 0 0 0 0 1 # -1\n", "line 1: expected the 7 columns");
  refuses_tree("1 0 0 0 0 1 -1\n2 0 0 0 1 1 1 3 0 0 0 2 1 2\n",
               "line 2: expected 7 columns as in the first row, found 14");
  refuses_tree("1 0 0 0 0 1 -1 2 0 0 0 1 1 1\n3 0 0 0 2 1 1\n",
               "line 2: expected 14 columns as in the first row, found 7");
  refuses_tree("1 0 0 0 zero 1 -1\n", "line 1: expected a number as 'z', found 'zero'");
  refuses_tree("1 0 0 0 nan 1 -1\n", "line 1: expected a finite number as 'z'");
  refuses_tree("1 0 0 0 1e999 1 -1\n", "line 1: 'z' is out of range");
  refuses_tree("1.5 0 0 0 0 1 -1\n", "line 1: expected an integer as 'id'");
  refuses_tree("1 0 0 0 0 -1 -1\n", "line 1: 'radius' must not be negative");
  refuses_tree("-4 0 0 0 0 1 -1\n", "line 1: an id must not be negative");
}

BOOST_AUTO_TEST_CASE(further_columns_and_comments_behind_data_are_ignored)
{
  const Tree tree = read_tree("##n type x y z radius parent seg level\n"
                              "1 1 0 0 0 1 -1 7 8.5 # soma\n"
                              "2 3 0 0 1 0.5 1 8 nan# no blank before\n"
                              "3 3 0 0 2 0.25 2 label\n"
                              " # indented\n");
  BOOST_TEST_REQUIRE(num_vertices(tree) == 3u);
  BOOST_TEST(tree[2].radius == 0.25);
  BOOST_TEST(pcs::parent_node<Kernel>(2, tree) == 1u);
}

BOOST_AUTO_TEST_CASE(one_of_several_trees_is_read)
{
  // Trees of 2, 3 and 2 nodes with alternating rows.
  const std::string content = "10 0 0 0 0 1 -1\n21 0 5 0 1 1 20\n11 0 0 0 1 1 10\n"
                              "20 0 5 0 0 2 -1\n31 0 9 0 1 1 30\n22 0 5 0 2 1 21\n"
                              "30 0 9 0 0 3 -1\n";
  const std::string name = file("a.swc", content);
  using Ids = std::vector<std::int64_t>;
  const auto read = [&](std::size_t number, Tree& tree) {
    Ids ids;
    const pcs::IO::Tree_selection selection = pcs::IO::read_swc<Kernel>(name, tree, ids, number);
    BOOST_TEST(selection.number_of_trees == 3u);
    BOOST_TEST(selection.number_of_nodes == 7u);
    BOOST_TEST(selection.number_of_omitted_nodes == 7 - ids.size());
    BOOST_TEST(num_vertices(tree) == ids.size());
    return ids;
  };
  Tree tree;
  BOOST_TEST((read(1, tree) == Ids{21, 20, 22}));
  BOOST_TEST(tree[boost::graph_bundle].root == 1u);
  BOOST_TEST(tree[1].radius == 2);
  BOOST_TEST(pcs::parent_node<Kernel>(0, tree) == 1u);
  BOOST_TEST(pcs::parent_node<Kernel>(2, tree) == 0u);
  BOOST_TEST((read(2, tree) == Ids{10, 11}));
  BOOST_TEST((read(3, tree) == Ids{31, 30}));
  for (const std::size_t number : {0u, 4u}) {
    std::string message;
    try {
      pcs::IO::read_swc<Kernel>(name, tree, number);
    } catch (const pcs::IO_error& e) {
      message = e.what();
    }
    BOOST_TEST(message.find("there is no tree " + std::to_string(number) +
                            ": the file has 3 trees") != std::string::npos,
               message);
    BOOST_TEST(tree[1].radius == 3); // unchanged
  }
  const pcs::IO::Tree_selection selection = pcs::IO::read_swc<Kernel>(name, tree);
  BOOST_TEST_REQUIRE(warnings(selection).size() == 1u);
  BOOST_TEST(warnings(selection)[0].find("4 of 7 nodes, in the 2 other trees") !=
             std::string::npos);
  BOOST_TEST(warnings(pcs::IO::read_swc<Kernel>(file("b.swc", "1 0 0 0 0 1 -1\n"), tree)).empty());
}

BOOST_AUTO_TEST_CASE(files_that_hold_no_tree_are_refused_with_the_line)
{
  refuses_tree("1 0 0 0 0 1 -1\n1 0 0 0 1 1 1\n", "line 2: the id 1 is used twice");
  refuses_tree("1 0 0 0 0 1 -1\n2 0 0 0 1 1 3\n", "line 2: there is no node with the id 3");
  refuses_tree("1 0 0 0 0 1 2\n2 0 0 0 1 1 1\n", "no node has the parent -1");
  refuses_tree("1 0 0 0 0 1 -1\n2 0 0 0 1 1 3\n3 0 0 0 1 1 2\n", "form a cycle");
  refuses_tree("1 0 0 0 0 1 -1\n2 0 0 0 1 1 2\n", "line 2: the parents of this node form a cycle");
}

BOOST_AUTO_TEST_CASE(a_long_chain_costs_no_stack)
{
  std::string text = "0 0 0 0 0 1 -1\n";
  for (int i = 1; i < 200000; ++i)
    text +=
        std::to_string(i) + " 0 0 0 " + std::to_string(i) + " 1 " + std::to_string(i - 1) + "\n";
  BOOST_TEST(num_vertices(read_tree(text)) == 200000u);
}

BOOST_AUTO_TEST_CASE(what_cannot_be_written_leaves_no_file)
{
  Tree tree = pcs_test::make_small_tree<Kernel>();
  tree[7].point = Point_3(0, std::numeric_limits<double>::quiet_NaN(), 0);
  BOOST_CHECK_THROW(pcs::IO::write_swc<Kernel>(path("a.swc"), tree), pcs::Invalid_input);
  tree = pcs_test::make_small_tree<Kernel>();
  tree[7].radius = -1;
  BOOST_CHECK_THROW(pcs::IO::write_swc<Kernel>(path("a.swc"), tree), pcs::Invalid_input);
  tree = pcs_test::make_small_tree<Kernel>();
  remove_edge(4, 6, tree);
  BOOST_CHECK_THROW(pcs::IO::write_swc<Kernel>(path("a.swc"), tree), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::IO::write_swc<Kernel>(path("a.swc"), Tree()), pcs::Invalid_input);
  BOOST_CHECK_THROW(
      pcs::IO::write_swc<Kernel>(path("no/a.swc"), pcs_test::make_small_tree<Kernel>()),
      pcs::IO_error);
  BOOST_TEST(number_of_files() == 0u);
}

BOOST_AUTO_TEST_CASE(graphs_that_are_no_trees_are_refused_with_a_reason)
{
  const auto refused = [&](const Tree& tree, const char* message) {
    BOOST_CHECK_EXCEPTION(pcs::IO::write_swc<Kernel>(path("a.swc"), tree),
                          pcs::Invalid_input,
                          pcs_test::message_has(message));
    BOOST_TEST(number_of_files() == 0u);
  };
  refused(Tree(), "the tree has no nodes");
  Tree tree = pcs_test::make_small_tree<Kernel>();
  const std::size_t n = num_vertices(tree);
  add_edge(0, n - 1, tree);
  refused(tree, "has two parents or is its own ancestor");
  tree = pcs_test::make_small_tree<Kernel>();
  add_vertex(tree);
  refused(tree, "1 nodes cannot be reached from the root");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_swc
