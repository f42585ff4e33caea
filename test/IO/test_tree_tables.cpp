// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of writing tables of branches and of the measures of a tree.

#include "temporary_files.h"
#include <pcs/IO/write_tree_tables.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace test_tree_tables {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point_3 = Kernel::Point_3;
using Vector_3 = Kernel::Vector_3;

namespace {

constexpr double pi = 3.14159265358979323846;

using Values = std::map<std::string, std::string>; // by column name

struct Table_files : Temporary_files
{
  std::vector<Values> rows(const std::string& name) const
  {
    const auto split = [](const std::string& line) {
      std::vector<std::string> words;
      std::istringstream in(line);
      for (std::string word; std::getline(in, word, ',');)
        words.push_back(word);
      return words;
    };
    std::istringstream in(content(name));
    std::string line;
    std::getline(in, line);
    const std::vector<std::string> names = split(line);
    std::vector<Values> result;
    while (std::getline(in, line)) {
      const std::vector<std::string> words = split(line);
      BOOST_TEST_REQUIRE(words.size() == names.size());
      result.emplace_back();
      for (std::size_t i = 0; i < words.size(); ++i)
        result.back()[names[i]] = words[i];
    }
    return result;
  }
};

void check(const Values& row, const std::string& name, double expected)
{
  BOOST_TEST_REQUIRE(row.count(name) == 1u, name);
  BOOST_TEST(std::abs(std::stod(row.at(name)) - expected) < 1e-9 * (1 + std::abs(expected)),
             name << " is " << row.at(name) << ", expected " << expected);
}

//! A trunk of radius 0.2 and length 4. It has a branch of radius 0.1 along (1, 0, 1) at its middle,
//! and a branch of radius 0.05 along y at its tip, whose first edge has the length 0.
Tree make_fork()
{
  return pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.2},
                                      {0, 0, 0, 0, 2, 0.2},
                                      {1, 0, 0, 0, 4, 0.2},
                                      {1, 1, 0, 0, 2, 0.1},
                                      {3, 1, 1, 0, 3, 0.1},
                                      {4, 2, 1, 0, 3, 0.05},
                                      {5, 2, 1, 0, 3, 0.05},
                                      {6, 2, 1, 3, 3, 0.05}});
}

void check_fork(const std::vector<Values>& rows)
{
  BOOST_TEST_REQUIRE(rows.size() == 3u);
  const double expected[3][10] = {
      {0, 0, 1000 * pi * 0.04 * 4, 2 * pi * 0.2 * 4, 4, 0, 0, 0, 0, 0.4},
      {1,
       1,
       1000 * pi * 0.01 * std::sqrt(2),
       2 * pi * 0.1 * std::sqrt(2),
       std::sqrt(2),
       45,
       2,
       0,
       45,
       0.2},
      {2, 2, 1000 * pi * 0.0025 * 3, 2 * pi * 0.05 * 3, 3, 90, 3, 90, 90, 0.1}};
  const char* const names[10] = {"order",
                                 "parent",
                                 "volume",
                                 "area",
                                 "length",
                                 "angle",
                                 "height",
                                 "azimuth",
                                 "zenith",
                                 "diameter"};
  for (std::size_t b = 0; b < 3; ++b)
    for (std::size_t k = 0; k < 10; ++k)
      check(rows[b], names[k], expected[b][k]);
}

} // namespace

BOOST_FIXTURE_TEST_SUITE(tree_tables, Table_files)

BOOST_AUTO_TEST_CASE(branches_have_the_sizes_and_angles_of_the_tree)
{
  pcs::IO::write_branches(path("a.csv"), make_fork());
  check_fork(rows("a.csv"));
  BOOST_TEST(number_of_files() == 1u);
}

BOOST_AUTO_TEST_CASE(the_up_direction_turns_heights_and_azimuths)
{
  Tree tree = make_fork();
  for (std::size_t v = 0; v < num_vertices(tree); ++v) // z becomes x, x becomes y, y becomes z
    tree[v].point = Point_3(tree[v].point.z(), tree[v].point.x(), tree[v].point.y());
  pcs::IO::write_branches(path("a.csv"), tree, Vector_3(7, 0, 0));
  check_fork(rows("a.csv"));
  pcs::IO::write_tree_table(path("b.csv"), tree, Vector_3(7, 0, 0));
  check(rows("b.csv")[0], "TreeHeight", 4);
}

BOOST_AUTO_TEST_CASE(sizes_of_the_tree_are_sums_of_the_branches)
{
  const Tree tree = make_fork();
  pcs::IO::write_branches(path("a.csv"), tree);
  pcs::IO::write_tree_table(path("b.csv"), tree);
  const std::vector<Values> branches = rows("a.csv"), sizes = rows("b.csv");
  BOOST_TEST_REQUIRE(sizes.size() == 1u);
  const auto sum = [&](const std::string& name, std::size_t first, std::size_t last) {
    double total = 0;
    for (std::size_t b = first; b < last; ++b)
      total += std::stod(branches[b].at(name));
    return total;
  };
  check(sizes[0], "TotalVolume", sum("volume", 0, 3));
  check(sizes[0], "TrunkVolume", sum("volume", 0, 1));
  check(sizes[0], "BranchVolume", sum("volume", 1, 3));
  check(sizes[0], "TrunkLength", 4);
  check(sizes[0], "BranchLength", sum("length", 1, 3));
  check(sizes[0], "TotalLength", sum("length", 0, 3));
  check(sizes[0], "TrunkArea", sum("area", 0, 1));
  check(sizes[0], "BranchArea", sum("area", 1, 3));
  check(sizes[0], "TotalArea", sum("area", 0, 3));
  check(sizes[0], "NumberBranches", 2);
  check(sizes[0], "MaxBranchOrder", 2);
  check(sizes[0], "TreeHeight", 4);
  check(sizes[0], "DBHqsm", 0.4);
}

BOOST_AUTO_TEST_CASE(the_diameter_at_breast_height_is_interpolated)
{
  // 0.3 at the root, 0.1 at the tip
  const Tree tree =
      pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 5, 0.3}, {0, 0, 4, 0, 5, 0.1}});
  pcs::IO::write_tree_table(path("a.csv"), tree);
  check(rows("a.csv")[0], "DBHqsm", 2 * (0.3 - 0.2 * 1.3 / 4));
  check(rows("a.csv")[0], "TotalVolume", 1000 * pi / 3 * 4 * (0.09 + 0.03 + 0.01));
  check(rows("a.csv")[0], "TreeHeight", 0);
  pcs::IO::write_tree_table(path("a.csv"), tree, Vector_3(0, 0, 1), 3);
  check(rows("a.csv")[0], "DBHqsm", 2 * 0.15);
  pcs::IO::write_tree_table(path("a.csv"), tree, Vector_3(0, 0, 1), 4.5);
  BOOST_TEST(rows("a.csv")[0].at("DBHqsm") == "NA");
}

BOOST_AUTO_TEST_CASE(standard_errors_have_the_units_of_their_values)
{
  const Tree tree = make_fork();
  pcs::Tree_values errors;
  errors.height = 0.1;
  errors.diameter_at_breast_height = 0.02;
  errors.trunk_length = 0.3;
  errors.length = 0.4;
  errors.volume = 0.05;
  pcs::IO::write_tree_table(path("a.csv"), tree, Vector_3(0, 0, 1), 1.3, errors);
  const Values row = rows("a.csv")[0];
  check(row, "TreeHeight_error", 0.1);
  check(row, "DBHqsm_error", 0.02);
  check(row, "TrunkLength_error", 0.3);
  check(row, "TotalLength_error", 0.4);
  check(row, "TotalVolume_error", 50);
  BOOST_TEST(row.at("TrunkVolume_error") == "NA");
}

BOOST_AUTO_TEST_CASE(branches_without_length_are_rows_of_zeros)
{
  const Tree tree = pcs_test::make_tree<Kernel>(
      {{pcs::npos, 0, 0, 0, 0, 0.3}, {0, 0, 0, 0, 4, 0.1}, {1, 1, 0, 0, 4, 0.05}});
  pcs::IO::write_branches(path("a.csv"), tree);
  BOOST_TEST_REQUIRE(rows("a.csv").size() == 2u);
  for (const std::string name : {"volume", "length", "angle", "azimuth", "zenith"})
    check(rows("a.csv")[1], name, 0);
  check(rows("a.csv")[1], "diameter", 0.1);
  const Tree dot = pcs_test::make_tree<Kernel>({{pcs::npos, 0, 0, 0, 0, 0.3}});
  pcs::IO::write_tree_table(path("b.csv"), dot);
  BOOST_TEST(rows("b.csv")[0].at("DBHqsm") == "NA");
}

BOOST_AUTO_TEST_CASE(what_cannot_be_written_leaves_no_file)
{
  const auto refuses = [&](const Tree& tree, const Vector_3& up, double breast_height) {
    BOOST_CHECK_THROW(pcs::IO::write_tree_table(path("a.csv"), tree, up, breast_height),
                      pcs::Invalid_input);
    if (breast_height > 0)
      BOOST_CHECK_THROW(pcs::IO::write_branches(path("a.csv"), tree, up), pcs::Invalid_input);
  };
  const Vector_3 up(0, 0, 1);
  refuses(make_fork(), Vector_3(0, 0, 0), 1);
  refuses(make_fork(), up, 0);
  refuses(Tree(), up, 1);
  Tree tree = make_fork();
  tree[7].point = Point_3(0, std::numeric_limits<double>::quiet_NaN(), 0);
  refuses(tree, up, 1);
  tree = make_fork();
  tree[7].branch = 9;
  refuses(tree, up, 1);
  tree = make_fork();
  remove_edge(1, 3, tree);
  refuses(tree, up, 1);
  BOOST_CHECK_THROW(pcs::IO::write_branches(path("no/a.csv"), make_fork()), pcs::IO_error);
  BOOST_TEST(number_of_files() == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_tree_tables
