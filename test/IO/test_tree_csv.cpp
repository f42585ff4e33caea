// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading and writing trees as CSV.

#include "temporary_files.h"
#include <pcs/IO/read_tree_csv.h>
#include <pcs/IO/write_tree_csv.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace test_tree_csv {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

namespace {

const std::string header = "id,parent,branch,order,x,y,z,r,a,b,hits\n";

struct Csv_files : Temporary_files
{
  void refuses_tree(const std::string& content, const std::string& expected) const
  {
    Tree tree = pcs_test::make_small_tree<Kernel>();
    std::vector<std::size_t> hits = {1};
    std::string message = "no error";
    try {
      pcs::IO::read_tree_csv<Kernel>(file("bad.csv", content), tree, hits);
    } catch (const pcs::IO_error& e) {
      message = e.what();
    }
    BOOST_TEST(message.find(expected) != std::string::npos,
               "expected '" << expected << "' in '" << message << "'");
    BOOST_TEST(num_vertices(tree) == 8u); // unchanged
    BOOST_TEST(hits.size() == 1u);
  }
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(tree_csv, Csv_files)

BOOST_AUTO_TEST_CASE(a_tree_comes_back_with_branches_sections_and_hits)
{
  Tree tree = pcs_test::make_small_tree<Kernel>();
  tree[5].major_radius = 0.1 / 3;
  tree[5].minor_radius = 0.02;
  tree[boost::graph_bundle].branches[2].id = 17; // another branch was pruned
  const std::vector<std::size_t> hits = {5, 4, 3, 0, 2, 1, 0, 9};
  pcs::IO::write_tree_csv<Kernel>(path("a.csv"), tree, hits);
  Tree copy;
  std::vector<std::size_t> read_hits;
  pcs::IO::read_tree_csv<Kernel>(path("a.csv"), copy, read_hits);
  BOOST_TEST(read_hits == hits);
  BOOST_TEST_REQUIRE(num_vertices(copy) == num_vertices(tree));
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    BOOST_TEST((copy[v].point == tree[v].point));
    BOOST_TEST(copy[v].radius == tree[v].radius);
    BOOST_TEST(copy[v].major_radius == tree[v].major_radius);
    BOOST_TEST(copy[v].minor_radius == tree[v].minor_radius);
    BOOST_TEST(copy[v].branch == tree[v].branch);
    BOOST_TEST(pcs::parent_node<Kernel>(v, copy) == pcs::parent_node<Kernel>(v, tree));
  }
  const auto& branches = copy[boost::graph_bundle].branches;
  BOOST_TEST_REQUIRE(branches.size() == 3u);
  BOOST_TEST(branches[2].id == 17u);
  BOOST_TEST(branches[2].parent == 1u);
  BOOST_TEST(branches[2].order == 2);
  BOOST_TEST(branches[0].parent == pcs::npos);
}

BOOST_AUTO_TEST_CASE(hits_may_be_missing_and_columns_stand_in_any_order)
{
  pcs::IO::write_tree_csv<Kernel>(path("a.csv"), pcs_test::make_small_tree<Kernel>());
  BOOST_TEST(content("a.csv").substr(0, 59) ==
             "id,parent,branch,order,x,y,z,r,a,b\n0,-1,0,0,0,0,0,0.2,0.2,0");
  Tree tree;
  std::vector<std::size_t> hits = {1, 2};
  pcs::IO::read_tree_csv<Kernel>(path("a.csv"), tree, hits);
  BOOST_TEST(hits.empty());

  pcs::IO::read_tree_csv<Kernel>(
      file("b.csv", "parent,id,z,y,x,b,a,r,order,branch\r\n-1,4,3,2,1,.1,.3,.2,0,8\r\n"),
      tree);
  BOOST_TEST((tree[0].point == Kernel::Point_3(1, 2, 3)));
  BOOST_TEST(tree[0].major_radius == 0.3);
  BOOST_TEST(tree[boost::graph_bundle].branches[0].id == 8u);
}

BOOST_AUTO_TEST_CASE(ids_are_those_of_the_file)
{
  Tree tree;
  std::vector<std::size_t> hits;
  std::vector<std::int64_t> ids;
  pcs::IO::read_tree_csv<Kernel>(
      file("a.csv", "\xEF\xBB\xBF" + header + "90071992547409933,-1,0,0,0,0,0,1,1,1,0\n"),
      tree,
      hits,
      ids);
  BOOST_TEST((ids == std::vector<std::int64_t>{90071992547409933}));
}

BOOST_AUTO_TEST_CASE(the_root_may_stand_in_any_row_and_old_ids_are_replaced)
{
  Tree tree;
  std::vector<std::size_t> hits;
  std::vector<std::int64_t> ids{4, 5, 6};
  const std::string rows = "8,9,0,0,0,0,1,1,1,1,0\n9,-1,0,0,0,0,0,1,1,1,0\n";
  pcs::IO::read_tree_csv<Kernel>(file("root.csv", header + rows), tree, hits, ids);
  BOOST_TEST(tree[boost::graph_bundle].root == 1u);
  BOOST_TEST((ids == std::vector<std::int64_t>{8, 9}));
}

BOOST_AUTO_TEST_CASE(malformed_files_are_refused_with_the_line)
{
  refuses_tree("", "the file is empty");
  refuses_tree(header, "the file has no node");
  refuses_tree("id,parent\n", "line 1: there is no column 'branch'");
  refuses_tree("id,parent,wood\n", "line 1: unknown column 'wood'");
  refuses_tree("id,id\n", "line 1: the column 'id' is named twice");
  refuses_tree(header + "0,-1,0,0,0,0,0,1,1,1\n", "line 2: expected 11 columns, found 10");
  refuses_tree(header + "0,-1,0,0,0,0,x,1,1,1,0\n", "line 2: expected a number as 'z'");
  refuses_tree(header + "0,-1,0,0,0,0,inf,1,1,1,0\n", "line 2: expected a finite number as 'z'");
  refuses_tree(header + "0,-1,0,0,0,0,0,-1,1,1,0\n", "line 2: 'r' must not be negative");
  refuses_tree(header + "0,-1,0,0,0,0,0,1,1,1,-2\n", "line 2: 'hits' must not be less than 0");
  refuses_tree(header + "0,-2,0,0,0,0,0,1,1,1,0\n", "line 2: 'parent' must not be less than -1");
}

BOOST_AUTO_TEST_CASE(broken_trees_and_branches_are_refused_with_the_line)
{
  const std::string root = header + "0,-1,0,0,0,0,0,1,1,1,0\n";
  refuses_tree(root + "1,2,0,0,0,0,1,1,1,1,0\n", "line 3: there is no node with the id 2");
  refuses_tree(root + "1,-1,0,0,0,0,1,1,1,1,0\n", "line 3: a second root");
  refuses_tree(root + "1,0,0,1,0,0,1,1,1,1,0\n", "line 3: branch 0 has two different orders");
  refuses_tree(root + "1,0,0,0,0,0,1,1,1,1,0\n2,0,0,0,0,0,1,1,1,1,0\n",
               "the nodes of branch 0 are not a chain");
  refuses_tree(root + "1,0,1,1,0,0,1,1,1,1,0\n2,1,0,0,0,0,1,1,1,1,0\n",
               "line 4: the nodes of branch 0 are not a chain");
}

BOOST_AUTO_TEST_CASE(wrong_sizes_and_branches_are_refused_and_leave_no_file)
{
  Tree tree = pcs_test::make_small_tree<Kernel>();
  BOOST_CHECK_THROW(pcs::IO::write_tree_csv<Kernel>(path("a.csv"), tree, {1, 2}),
                    pcs::Invalid_input);
  tree[3].branch = 9;
  BOOST_CHECK_THROW(pcs::IO::write_tree_csv<Kernel>(path("a.csv"), tree), pcs::Invalid_input);
  BOOST_TEST(number_of_files() == 0u);
}

BOOST_AUTO_TEST_CASE(the_truth_of_the_virtual_scans_loads)
{
  const char* data = std::getenv("PCS_TEST_DATA");
  if (data == nullptr) {
    BOOST_TEST_MESSAGE("skipped: PCS_TEST_DATA is not set");
    return;
  }
  Tree tree;
  std::vector<std::size_t> hits;
  pcs::IO::read_tree_csv<Kernel>(std::string(data) + "/trees/synth_sparse_truth.csv", tree, hits);
  BOOST_TEST(num_vertices(tree) == 5511u);
  BOOST_TEST(tree[boost::graph_bundle].branches.size() == 332u);
  BOOST_TEST(hits.front() == 350u);
}

BOOST_AUTO_TEST_CASE(orders_beyond_the_integers_are_refused_with_the_line)
{
  refuses_tree(header + "0,-1,0,2147483648,0,0,0,1,1,1,0\n",
               "line 2: 'order' is out of range: 2147483648");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_tree_csv
