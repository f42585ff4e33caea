// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Skeleton of a tube and a twig by slices.

#include <pcs/Tree_skeletonization.h>
#include <support/sections.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace test_section_skeleton {

using pcs::skeleton::Vec3;
using pcs_test::tube;

BOOST_AUTO_TEST_SUITE(section_skeleton)

BOOST_AUTO_TEST_CASE(the_way_of_the_dissertation_runs_from_end_to_end)
{
  using Kernel = CGAL::Simple_cartesian<double>;
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : tube(0.1, 2, 8000))
    points.emplace_back(p.x(), p.y(), p.z());
  for (int i = 0; i < 40; ++i) // a twig that is too thin for slices
    points.emplace_back(0.11 + 0.015 * i, 0, 1 + 0.015 * i);
  pcs::Tree_skeleton<Kernel> tree;
  pcs::Tree_skeletonization stages(
      points,
      pcs::parameters::skeleton_method(pcs::Skeleton_method::sections));
  const auto report = stages.extract(tree);
  BOOST_CHECK_EQUAL(report.status, pcs::Status::converged);
  BOOST_CHECK_CLOSE(report.diameter_at_breast_height, 0.2, 5.0);
  BOOST_CHECK_EQUAL(num_edges(tree) + 1, num_vertices(tree));
  double farthest = 0, thinnest = 1;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    farthest = std::max(farthest, tree[v].point.x());
    thinnest = std::min(thinnest, tree[v].radius);
  }
  BOOST_CHECK_GT(farthest, 0.5); // the sparse part is included
  BOOST_CHECK_LT(thinnest, 0.05);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_section_skeleton
