// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading cylinder tables, written by pcs and by other programs.

#include "temporary_files.h"
#include <pcs/IO/read_cylinders.h>
#include <pcs/IO/write_tree_tables.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace test_cylinders {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point_3 = Kernel::Point_3;
using Ids = std::vector<std::int64_t>;

namespace {

struct Cylinder_files : Temporary_files
{
  Tree read_table(const std::string& content) const
  {
    Tree tree;
    Ids ids;
    const std::string name = file("a.csv", content);
    BOOST_TEST(pcs::IO::is_cylinder_table(name));
    pcs::IO::read_cylinders<Kernel>(name, tree, ids);
    BOOST_TEST(ids.size() == num_vertices(tree));
    return tree;
  }

  void refuses_table(const std::string& content, const std::string& expected) const
  {
    Tree tree = pcs_test::make_small_tree<Kernel>();
    std::string message = "no error";
    try {
      pcs::IO::read_cylinders<Kernel>(file("bad.csv", content), tree);
    } catch (const pcs::IO_error& e) {
      message = e.what();
    }
    BOOST_TEST(message.find(expected) != std::string::npos,
               "expected '" << expected << "' in '" << message << "'");
    BOOST_TEST(num_vertices(tree) == 8u); // unchanged
  }
};

//! The length of all edges, and the volume of the frusta around those within branches.
std::pair<double, double> sizes(const Tree& tree)
{
  double length = 0, volume = 0;
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const auto &a = tree[source(e, tree)], &b = tree[target(e, tree)];
    if (a.branch != b.branch)
      continue;
    const double d = std::sqrt(CGAL::squared_distance(a.point, b.point));
    length += d;
    volume += d * (a.radius * a.radius + a.radius * b.radius + b.radius * b.radius);
  }
  return {length, volume};
}

//! Checks the tree of three cylinders of the tests of other programs: a trunk of two cylinders, and
//! a branch that begins at the end of the first.
void check_fork(const Tree& tree)
{
  BOOST_TEST_REQUIRE(num_vertices(tree) == 5u);
  const std::size_t root = tree[boost::graph_bundle].root;
  BOOST_TEST((tree[root].point == Point_3(1, 2, 3)));
  BOOST_TEST(tree[root].radius == 0.25);
  BOOST_TEST_REQUIRE(out_degree(root, tree) == 1u);
  const std::size_t fork = target(*out_edges(root, tree).first, tree);
  BOOST_TEST((tree[fork].point == Point_3(1, 2, 4)));
  BOOST_TEST(tree[fork].radius == 0.1875); // mean of 0.25 and 0.125
  BOOST_TEST_REQUIRE(out_degree(fork, tree) == 2u);
  std::size_t number_of_bases = 0;
  for (const auto e : boost::make_iterator_range(out_edges(fork, tree))) {
    const std::size_t v = target(e, tree);
    if (tree[v].branch == tree[root].branch) {
      BOOST_TEST((tree[v].point == Point_3(1, 2, 5)));
      BOOST_TEST(tree[v].radius == 0.125);
      continue;
    }
    ++number_of_bases;
    BOOST_TEST((tree[v].point == Point_3(1, 2, 4)));
    BOOST_TEST_REQUIRE(out_degree(v, tree) == 1u);
    const std::size_t tip = target(*out_edges(v, tree).first, tree);
    BOOST_TEST((tree[tip].point == Point_3(3, 2, 4)));
    BOOST_TEST(tree[tip].radius == 0.0625);
    BOOST_TEST(tree[tip].branch == tree[v].branch);
  }
  BOOST_TEST(number_of_bases == 1u);
  const auto& branches = tree[boost::graph_bundle].branches;
  BOOST_TEST_REQUIRE(branches.size() == 2u);
  BOOST_TEST(branches[1].parent == 0u);
  BOOST_TEST(branches[1].order == 1);
}

const std::string header = "sx,sy,sz,ax,ay,az,length,radius,parent,branch\n";

} // namespace

BOOST_FIXTURE_TEST_SUITE(cylinders, Cylinder_files)

BOOST_AUTO_TEST_CASE(own_tables_keep_branches_lengths_and_positions)
{
  const Tree tree = pcs_test::make_small_tree<Kernel>();
  pcs::IO::write_cylinders<Kernel>(path("a.csv"), tree);
  Tree copy;
  const pcs::IO::Tree_selection selection = pcs::IO::read_cylinders<Kernel>(path("a.csv"), copy);
  BOOST_TEST(selection.number_of_trees == 1u);
  BOOST_TEST(warnings(selection).empty());
  const auto &before = tree[boost::graph_bundle].branches,
             &after = copy[boost::graph_bundle].branches;
  BOOST_TEST_REQUIRE(after.size() == before.size());
  BOOST_TEST(sizes(copy).first == sizes(tree).first, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(sizes(copy).second == sizes(tree).second, boost::test_tools::tolerance(0.1));
  BOOST_TEST(
      (copy[copy[boost::graph_bundle].root].point == tree[tree[boost::graph_bundle].root].point));
  // Every tip is reproduced, on a branch of the same order.
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    if (out_degree(v, tree) > 0)
      continue;
    std::size_t number_of_equal = 0;
    for (std::size_t w = 0; w < num_vertices(copy); ++w)
      number_of_equal += out_degree(w, copy) == 0 &&
                         CGAL::squared_distance(copy[w].point, tree[v].point) < 1e-24 &&
                         after[copy[w].branch].order == before[tree[v].branch].order;
    BOOST_TEST(number_of_equal == 1u);
  }
}

BOOST_AUTO_TEST_CASE(tables_of_treeqsm_are_read)
{
  const std::string text =
      "radius (m)\tlength (m)\tstart_point\taxis_direction\tparent\textension\t"
      "branch\tbranch_order\tposition_in_branch\tmad\tSurfCov\tadded\t"
      "UnmodRadius (m)\n"
      "0.25\t1\t1\t2\t3\t0\t0\t1\t0\t2\t1\t0\t1\t0.001\t0.5\t0\t0.3\n"
      "0.125\t1\t1\t2\t4\t0\t0\t1\t1\t0\t1\t0\t2\t0.001\t0.5\t0\t0.3\n"
      "0.0625\t2\t1\t2\t4\t1\t0\t0\t1\t0\t2\t1\t1\t0.001\t0.5\t0\t0.3\n";
  check_fork(read_table(text));
}

BOOST_AUTO_TEST_CASE(tables_of_simpleforest_are_read)
{
  const std::string text = "type, ID, parentID, startX, startY, startZ, endX, endY, endZ, radius, "
                           "segmentID, parentSegmentID, branchID, treeSpecies\n"
                           "cylinder, 0, -1, 1, 2, 3, 1, 2, 4, 0.25, 0, -1, 0, unknown\n"
                           "cylinder, 1, 0, 1, 2, 4, 1, 2, 5, 0.125, 0, 0, 0, unknown\n"
                           "cylinder, 2, 0, 1, 2, 4, 3, 2, 4, 0.0625, 1, 0, 1, unknown\n";
  check_fork(read_table(text));
}

BOOST_AUTO_TEST_CASE(tables_of_archi_are_read_in_any_order_of_rows)
{
  const std::string text = "startX,startY,startZ,endX,endY,endZ,cyl_ID,parent_ID,extension_ID,"
                           "radius_cyl,length,axis_ID\n"
                           "1,2,4,3,2,4,3,1,0,0.0625,2,7\n"
                           "1,2,4,1,2,5,2,1,0,0.125,1,4\n"
                           "1,2,3,1,2,4,1,0,2,0.25,1,4\n";
  check_fork(read_table(text));
}

BOOST_AUTO_TEST_CASE(tables_of_rtwig_are_read)
{
  const std::string text =
      "\"\",\"parent\",\"radius\",\"length\",\"start.x\",\"start.y\",\"start.z\","
      "\"axis.x\",\"axis.y\",\"axis.z\",\"id\",\"branch\"\r\n"
      "\"1\",NA,0.25,1,1,2,3,0,0,2,1,1\r\n"
      "\"2\",1,0.125,1,1,2,4,0,0,2,2,1\r\n"
      "\"3\",1,0.0625,2,1,2,4,5,0,0,3,2\r\n";
  check_fork(read_table(text)); // axes of arbitrary lengths
}

BOOST_AUTO_TEST_CASE(branches_are_determined_if_the_table_has_none)
{
  const std::string text = "start_1;start_2;start_3;end_1;end_2;end_3;radius;parent\n"
                           "1;2;3;1;2;4;0.25;0\n1;2;4;3;2;4;0.0625;1\n1;2;4;1;2;5;0.125;1\n";
  check_fork(read_table(text)); // the thickest cylinder continues
  // A branch of SimpleForest and its descendants have one number.
  check_fork(read_table(header + "1,2,3,0,0,1,1,0.25,0,5\n1,2,4,1,0,0,2,0.0625,1,5\n"
                                 "1,2,4,0,0,1,1,0.125,1,5\n"));
}

BOOST_AUTO_TEST_CASE(branches_begin_at_the_nearer_end_of_their_parent)
{
  // The second branch starts at the root, as a child of the first cylinder and without a parent.
  for (const std::string parent : {"1", "0"}) {
    const Tree tree = read_table(header + "0,0,0,0,0,1,4,0.5,0,1\n0,0,0.25,1,0,0,2,0.1," + parent +
                                 ",2\n0,0,3,1,0,0,2,0.1,1,3\n");
    BOOST_TEST_REQUIRE(num_vertices(tree) == 6u);
    const std::size_t root = tree[boost::graph_bundle].root;
    BOOST_TEST(out_degree(root, tree) == 2u);
    BOOST_TEST(tree[boost::graph_bundle].branches.size() == 3u);
  }
}

BOOST_AUTO_TEST_CASE(one_of_several_trees_is_read)
{
  const std::string name = file("a.csv",
                                header + "0,0,0,0,0,1,1,0.1,0,1\n9,0,0,0,0,1,1,0.1,0,1\n"
                                         "9,0,1,0,0,1,1,0.1,2,1\n");
  Tree tree;
  Ids ids;
  const pcs::IO::Tree_selection selection = pcs::IO::read_cylinders<Kernel>(name, tree, ids);
  BOOST_TEST(selection.number_of_trees == 2u);
  BOOST_TEST(selection.number_of_omitted_nodes == 1u);
  BOOST_TEST((ids == Ids{-1, 2, 3}));
  pcs::IO::read_cylinders<Kernel>(name, tree, ids, 2);
  BOOST_TEST((ids == Ids{-1, 1}));
}

BOOST_AUTO_TEST_CASE(other_tables_are_no_cylinders)
{
  for (const std::string text : {"id,parent,branch,order,x,y,z,r,a,b,hits\n",
                                 "1 0 0 0 0 1 -1\n",
                                 "",
                                 "x,y,z\n",
                                 "# start_point radius\n1 0 0 0 0 1 -1\n"})
    BOOST_TEST(!pcs::IO::is_cylinder_table(file("a.txt", text)), text);
  BOOST_TEST(pcs::IO::is_cylinder_table(file("a.txt", "# a remark\n\n" + header)));
}

BOOST_AUTO_TEST_CASE(malformed_tables_are_refused_with_the_line)
{
  refuses_table("", "the file is empty");
  refuses_table(header, "the file has no node");
  refuses_table("sx,sy,ax,ay,az,length,radius,parent\n", "line 1: there is no column 'startZ'");
  refuses_table("sx,sy,sz,ax,ay,az,length,parent\n", "line 1: there is no column 'radius'");
  refuses_table("sx,sy,sz,ax,ay,az,radius,parent\n",
                "line 1: the ends of the cylinders are missing");
  refuses_table("sx,sy,sz,ax,ay,az,length,radius,parent,Radius (m)\n",
                "line 1: the column 'radius' is named twice");
  refuses_table(header + "0,0,0,0,0,1,1,0.1,0\n", "line 2: expected 10 columns as in the header");
  refuses_table(header + "1,0,0,0,0,0,1,1,0.1,0,1\n", "without row names");
  refuses_table(header + "0,0,nan,0,0,1,1,0.1,0,1\n", "expected a finite number as 'startZ'");
  refuses_table(header + "0,0,0,0,0,1,1,-0.1,0,1\n", "'radius' must not be negative");
  refuses_table(header + "0,0,0,0,0,1,-1,0.1,0,1\n", "'length' must not be negative");
  refuses_table(header + "0,0,0,0,0,0,1,0.1,0,1\n", "line 2: the axis of a cylinder is null");
  refuses_table(header + "1e308,0,0,1,0,0,1.5e308,0.1,0,1\n", "out of range");
  refuses_table(header + "0,0,0,0,0,1,1,0.1,0.5,1\n", "expected an integer as 'parent'");
  refuses_table(header + "0,0,0,0,0,1,1,0.1,0,1\n0,0,1,0,0,1,1,0.1,7,1\n",
                "line 3: there is no node with the id 7");
  refuses_table(header + "0,0,0,0,0,1,1,0.1,0,1\n0,0,1,0,0,1,1,0.1,2,1\n", "form a cycle");
  refuses_table(header + "0,0,0,0,0,1,1,0.1,1,1\n", "no node has the parent -1");
}

BOOST_AUTO_TEST_CASE(a_long_chain_takes_no_stack)
{
  std::string text = header;
  for (int i = 0; i < 100000; ++i)
    text += "0,0," + std::to_string(i) + ",0,0,1,1,0.1," + std::to_string(i) + ",1\n";
  BOOST_TEST(num_vertices(read_table(text)) == 100001u);
}

BOOST_AUTO_TEST_CASE(a_negative_id_is_refused_with_the_line)
{
  refuses_table("id,sx,sy,sz,ax,ay,az,length,radius,parent\n-3,0,0,0,0,0,1,1,0.1,0\n",
                "line 2: an id must not be negative, found -3");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_cylinders
