// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A failed allocation leaves the points unchanged, and frames of a drag do not allocate memory.

#include <pcs/Point_set_deformation.h>
#include <pcs/deform_point_set.h>
#include <support/allocations.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <new>
#include <vector>

namespace {

/// Fails one allocation at a time, from the first to the last. Returns the number of failures.
/// Sequential, since TBB does not survive failures.
int fail_everywhere(int number_of_samples)
{
  const auto rest = pcs_test::box(4, 4, 10, 0.25);
  const std::vector<int> fixed{0, 1, 2, 3, 4};
  const std::size_t last = rest.size() - 1;
  const auto motion = pcs::translation(pcs_test::Vec3(.1, 0, .2)) * pcs::scaling(1.1, rest.back());
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
          motion,
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
    // Otherwise the allocation was optional, and the result must be complete.
    else
      BOOST_REQUIRE((points[last] - motion(rest[last])).norm() < 1e-12);
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

BOOST_AUTO_TEST_CASE(frames_allocate_nothing)
{
  const auto rest = pcs_test::box(6, 6, 24, 0.125);
  for (const int samples : {100, 100000}) {
    auto points = rest;
    // With a tolerance of zero, all frames have the same number of passes, whose memory is
    // allocated by the first frame.
    const auto np =
        pcs::parameters::number_of_samples(samples).tolerance(0).number_of_iterations(8);
    pcs::Point_set_deformation<decltype(points), decltype(np), CGAL::Sequential_tag> session(points,
                                                                                             np);
    std::vector<std::size_t> low, high, soft;
    for (std::size_t i = 0; i < points.size(); ++i)
      (points[i].z() < .2 ? low : points[i].z() > 2.8 ? high : soft).push_back(i);
    soft.resize(20);
    session.add_handle(low);
    const auto handle = session.add_handle(high);
    const auto drawn = session.add_handle(soft, 2.0);
    long frames_with_allocations = 0;
    for (int frame = 0; frame < 12; ++frame) {
      const long before = pcs_test::number_of_allocations;
      session.set_rotation(handle, pcs_test::Vec3(1, 0, 1), .1 * frame);
      session.set_scale(handle, 1 + .02 * frame);
      session.set_translation(drawn, pcs_test::Vec3(.01 * frame, 0, 0));
      session.deform(frame % 3 == 2 ? pcs::Solver_start::warm : pcs::Solver_start::cold);
      if (frame >= 3 && pcs_test::number_of_allocations != before)
        ++frames_with_allocations;
    }
    BOOST_TEST(frames_with_allocations == 0);
    BOOST_TEST((points.back() - rest.back()).norm() > .1);
  }
}

BOOST_AUTO_TEST_SUITE_END()
