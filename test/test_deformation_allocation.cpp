// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Memory that runs out at any allocation leaves the points untouched.

#include <pcs/deform_point_set.h>
#include <support/allocations.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <new>

namespace {

/// Lets one allocation fail, from the first to the last. Returns how many failures were tried. Sequential: TBB itself does
/// not survive them.
int fail_everywhere(int number_of_samples)
{
  const auto rest = pcs_test::box(4, 4, 10, 0.25);
  const std::vector<int> fixed{0, 1, 2, 3, 4};
  const std::size_t last = rest.size() - 1;
  const std::vector<std::size_t> moved{last - 2, last - 1, last};
  auto points = rest;
  int failures = 0;
  for (long i = 0;; ++i) {
    points = rest;
    pcs_test::has_failed = false;
    pcs_test::allocations_left = i;
    bool has_thrown = false;
    try {
      pcs::deform_point_set<CGAL::Sequential_tag>(
          points,
          fixed,
          moved,
          pcs::translation(pcs_test::Vec3(.1, 0, .2)),
          pcs::parameters::number_of_samples(number_of_samples));
    } catch (const std::bad_alloc&) {
      has_thrown = true;
    }
    pcs_test::allocations_left = -1;
    if (!pcs_test::has_failed)
      return failures;
    ++failures;
    if (has_thrown)
      BOOST_REQUIRE((points == rest));
    // else somebody could do without; the result must then be whole
    else
      BOOST_REQUIRE((points[last] - rest[last] - pcs_test::Vec3(.1, 0, .2)).norm() < 1e-12);
  }
}

} // namespace

BOOST_AUTO_TEST_SUITE(deformation_allocation)

BOOST_AUTO_TEST_CASE(a_failing_allocation_leaves_the_points_untouched)
{
  for (const int samples : {20, 1000}) {
    const int failures = fail_everywhere(samples);
    BOOST_TEST_MESSAGE(failures << " allocations failed");
    BOOST_TEST(failures > 50);
  }
}

BOOST_AUTO_TEST_SUITE_END()
