// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of files of correspondences between two trees.

#include "temporary_files.h"
#include <pcs/IO/read_correspondences.h>
#include <pcs/IO/write_correspondences.h>
#include <support/exceptions.h>

#include <boost/test/unit_test.hpp>

#include <string>

namespace test_correspondences {

namespace {

const std::string trees = "trees 1 2 3 4\nturn 1 0 0 0\n";
const std::string head = "pcs_correspondences 4\nnote 2 by night\n" + trees;
const std::string branch = "branches 1\n- 0.5 0 1 0 0 2 0 1 - - 0.5 1 0\n";
const std::string pairs = "pairs 1\n0 5 -\n";

struct Correspondence_files : Temporary_files
{
  void refuses(const std::string& content, const std::string& expected) const
  {
    BOOST_CHECK_EXCEPTION(pcs::IO::read_correspondences(file("a.txt", content)),
                          pcs::IO_error,
                          pcs_test::message_has(expected));
  }
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(correspondences, Correspondence_files)

BOOST_AUTO_TEST_CASE(values_are_read_and_survive_a_file)
{
  const auto is_as_written = [](const pcs::Orl_correspondences& c) {
    BOOST_TEST(c.note == "by night");
    BOOST_TEST(c.fingerprint_of_points[1] == 4u);
    BOOST_TEST_REQUIRE(c.branches.size() == 1u);
    const pcs::Orl_correspondences::Branch& b = c.branches[0];
    BOOST_TEST(b.parent == c.none);
    BOOST_TEST(b.confidence == 0.5);
    BOOST_TEST((b.nodes[0].size() == 2 && b.nodes[0][1] == 1));
    BOOST_TEST(b.tip[1] == c.none);
    BOOST_TEST((!b.is_continued[0] && b.is_continued[1]));
    BOOST_TEST_REQUIRE(c.pairs.size() == 1u);
    BOOST_TEST((c.pairs[0].point[0] == 5u && c.pairs[0].point[1] == c.no_point));
  };
  const auto read = pcs::IO::read_correspondences(file("a.txt", head + branch + pairs));
  is_as_written(read);
  pcs::IO::write_correspondences(path("b.txt"), read);
  is_as_written(pcs::IO::read_correspondences(path("b.txt")));
}

BOOST_AUTO_TEST_CASE(malformed_files_are_refused_with_their_line)
{
  refuses("", "expected 'pcs_correspondences', found the end of the file");
  refuses("pcs_correspondences 2\n", "line 1: expected '3' or '4'");
  refuses("pcs_correspondences 4\nnote 2 by", "expected a word, found the end of the file");
  refuses("pcs_correspondences 4\nnote 10000 by\n", "line 2: expected the number of words");
  refuses(head + "branches 1000\n", "line 5: expected the number of branches");
  refuses(head + "branches 1\n- x", "line 6: expected confidence, found 'x'");
  refuses(head + "branches 1\n- 0.5 0 1 0 2", "line 6: expected '0', found '2'");
  refuses(head + branch + "pairs 1\n0 5", "expected the number of a point");
  refuses(head + branch + pairs + "more\n", "line 9: expected the end of the file");
  refuses(head + branch + "pairs 1\n0 5 -", "the last line has no end");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_correspondences
