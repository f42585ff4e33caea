// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Growth paths: smooth, through all trees, and monotone when asked.

#include <pcs/Orl_shape_space.h>
#include <pcs/fit_growth_path.h>
#include <support/orl_families.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_fit_growth_path {

using namespace orl_test;
using namespace pcs::shape_space;
namespace np = pcs::parameters;

BOOST_AUTO_TEST_SUITE(orl_growth)

BOOST_AUTO_TEST_CASE(the_path_goes_through_all_trees_smoothly)
{
  const Family space(4);
  const std::vector<double> times{0, 1, 3, 4};
  const auto path = pcs::fit_growth_path(space, {2, 0, 1, 3}, times);
  const std::size_t order[] = {2, 0, 1, 3};
  for (std::size_t i = 0; i < 4; ++i) {
    Tree a, b;
    space.skeleton(pcs::tree_at_time(space, path, times[i]), a);
    space.skeleton(space.tree(order[i]), b);
    BOOST_REQUIRE(num_vertices(a) == num_vertices(b));
    for (std::size_t v = 0; v < num_vertices(a); ++v)
      BOOST_TEST(CGAL::squared_distance(a[v].point, b[v].point) < 1e-16);
  }
  // The speed is continuous at an inner tree.
  const double h = 1e-5;
  const auto at = [&](double t) { return pcs::tree_at_time(space, path, t); };
  const Orl_coordinates l = at(1 - h).coordinates(), m = at(1).coordinates(),
                        r = at(1 + h).coordinates();
  double worst = 0;
  for (std::size_t e = 0; e < m.length.size(); ++e) {
    worst =
        std::max(worst, std::abs((r.length[e] - m.length[e]) - (m.length[e] - l.length[e])) / h);
    const Vec3 before = pcs::rotation_log(l.orientation[e].conjugate() * m.orientation[e]);
    const Vec3 after = pcs::rotation_log(m.orientation[e].conjugate() * r.orientation[e]);
    worst = std::max(worst, (after - before).norm() / h);
  }
  BOOST_TEST(worst < 1e-3);
  BOOST_TEST(
      space.distance(pcs::tree_at_time(space, path, -5), pcs::tree_at_time(space, path, 0)) == 0);
}

BOOST_AUTO_TEST_CASE(nothing_shrinks_when_asked)
{
  const Family space(5);
  const auto path =
      pcs::fit_growth_path(space, {0, 1, 2, 3, 4}, {0, 1, 2, 3, 4}, np::is_monotone(true));
  const auto free = pcs::fit_growth_path(space, {0, 1, 2, 3, 4}, {0, 1, 2, 3, 4});
  Orl_coordinates last = pcs::tree_at_time(space, path, 0).coordinates();
  Orl_coordinates last_free = pcs::tree_at_time(space, free, 0).coordinates();
  std::size_t number_shrunk = 0, number_shrunk_free = 0;
  for (int k = 1; k <= 80; ++k) {
    const Orl_coordinates x = pcs::tree_at_time(space, path, 0.05 * k).coordinates();
    const Orl_coordinates y = pcs::tree_at_time(space, free, 0.05 * k).coordinates();
    for (std::size_t e = 0; e < x.length.size(); ++e) {
      number_shrunk +=
          x.length[e] < last.length[e] * (1 - 1e-12) || x.radius[e] < last.radius[e] * (1 - 1e-12);
      number_shrunk_free += y.length[e] < last_free.length[e] * (1 - 1e-12);
      BOOST_TEST(y.length[e] >= 0);
    }
    last = x;
    last_free = y;
  }
  BOOST_TEST(number_shrunk == 0u);
  BOOST_TEST(number_shrunk_free > 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fit_growth_path
