// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Curvatures of the surface of a tube.

#include <pcs/skeleton/scan/prepare_scan.h>
#include <pcs/skeleton/slices/principal_curvatures.h>
#include <support/sections.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>

namespace test_principal_curvatures {

using pcs::skeleton::Vec3;
using pcs_test::tube;

BOOST_AUTO_TEST_SUITE(principal_curvatures)

BOOST_AUTO_TEST_CASE(the_center_candidates_of_a_tube_lie_on_its_axis)
{
  pcs::skeleton::Scan scan;
  pcs::skeleton::prepare_scan<CGAL::Sequential_tag>(tube(0.1, 1, 6000), Vec3::UnitZ(), scan);
  const auto frames = pcs::skeleton::principal_curvatures<CGAL::Sequential_tag>(scan);
  std::size_t good = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Vec3 center = scan.frame.to_input(scan.points[i] + frames[i].normal / frames[i].k1);
    good += std::hypot(center.x(), center.y()) < 0.01 && std::abs(frames[i].e2.z()) > 0.98;
  }
  BOOST_CHECK_GT(good, scan.size() * 9 / 10);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_principal_curvatures
