// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Radii by point counts, also where another axis hides a part of the section.

#include <pcs/skeleton/axes/section_counts.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <support/sections.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_section_counts {

using pcs::skeleton::Vec3;
using pcs_test::tube;
constexpr double pi = 3.14159265358979323846;

BOOST_AUTO_TEST_SUITE(section_counts)

// A branch of radius 0.03 from the axis of a stem of radius 0.1. Points on the stem belong to the
// stem.
BOOST_AUTO_TEST_CASE(radii_are_counted_where_the_parent_hides_a_part)
{
  namespace sk = pcs::skeleton;
  constexpr double thick = 0.1, thin = 0.03, reach = 0.5;
  std::vector<Vec3> points = tube(thick, 1, 4000);
  const double density = double(points.size()) / (2 * pi * thick);
  std::vector<Vec3> branch;
  for (const Vec3& p : tube(thin, reach, std::size_t(2 * pi * thin * reach * density))) {
    const Vec3 q(p.z(), p.x(), 0.5 + p.y());
    if (std::hypot(q.x(), q.y()) > thick + 0.01)
      branch.push_back(q);
  }
  points.insert(points.end(), branch.begin(), branch.end());
  sk::Scan scan;
  sk::prepare_scan<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
  const double unit = scan.frame.unit;
  for (Vec3& p : branch)
    p = scan.frame.to_local(p);

  sk::Axis_set set;
  set.noise = 0.002 / unit;
  set.density = density * unit * unit;
  set.axis_of_point.assign(scan.size(), sk::none);
  set.segment_of_point.assign(scan.size(), 0);
  sk::Axis stem(2), axis;
  stem[0].point = scan.frame.to_local(Vec3::Zero());
  stem[1].point = scan.frame.to_local(Vec3(0, 0, 1));
  stem[0].radius = stem[1].radius = thick / unit;
  set.axes.push_back({stem, sk::none, 4000, 1});
  for (std::size_t i = 0; i < 4000; ++i)
    set.axis_of_point[scan.point_of_input[i]] = 0;
  for (int k = 0; k <= 25; ++k) {
    sk::Axis_node node;
    node.point = scan.frame.to_local(Vec3(0.02 * k, 0, 0.5));
    node.radius = thin / unit;
    axis.push_back(node);
  }
  const sk::Chain_options rules;
  const sk::Chain_view view{scan, set, rules};
  sk::Axis_fit fit(axis, sk::Fit_model::of(scan.spacing, set.noise));
  fit.set_points(branch, std::vector<sk::Index>(branch.size(), 0));
  fit.project();

  const std::vector<double> visible = sk::visible_shares(view, fit);
  BOOST_CHECK_EQUAL(visible[2], 0);
  BOOST_CHECK_EQUAL(visible[20], 1);
  const sk::Section_counts all = sk::section_counts(view, fit, std::vector<double>(axis.size(), 1));
  const sk::Section_counts outside = sk::section_counts(view, fit, visible);
  constexpr std::size_t base = 6; // 2 cm outside of the stem; the window reaches into it
  BOOST_CHECK_LT(unit * all.radius(base, set.density), 0.8 * thin);
  BOOST_CHECK_CLOSE(unit * outside.radius(base, set.density), thin, 15.0);
  BOOST_CHECK_CLOSE(unit * outside.radius(20, set.density), thin, 10.0);
  BOOST_CHECK_EQUAL(outside.length[base], all.visible_length[base]);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_section_counts
