// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares deformations of bars, tubes, plates and sheets with closed forms.

#include <support/deform_cloud.h>
#include <support/deformation_cases.h>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace test_deformation_shapes {

namespace {

using pcs_test::deform;
using pcs_test::Deformation_case;
using pcs_test::Deformation_measures;
using pcs_test::Deformed;
using pcs_test::Handles;
using pcs_test::measure;
using pcs_test::Options;
using pcs_test::Points;
using pcs_test::Vec3;

Handles handles_of(const Deformation_case& c)
{
  Handles handles;
  for (std::size_t h = 0; h < c.handles.size(); ++h)
    handles.push_back({{c.handles[h].begin(), c.handles[h].end()}, c.transforms[h], 0});
  return handles;
}

/// Deforms a case, prints and returns its measures.
Deformation_measures run(const Deformation_case& c, const Options& options)
{
  const Deformed result = deform(c.points, handles_of(c), options);
  const auto m = measure(c, result.points);
  BOOST_TEST_MESSAGE(
      c.name << ", " << result.report.number_of_samples << " samples: edges rms " << m.rms_edge
             << " max " << m.largest_edge << ", rotation " << m.rotation_smoothness << ", frame "
             << m.frame_error << " deg, position " << m.position_error << " L, volume "
             << m.volume_ratio << ", " << result.report.number_of_iterations << " passes");
  return m;
}

Options at_full_resolution()
{
  Options options;
  options.number_of_samples = 1000000;
  return options;
}

Options at_1000_samples()
{
  Options options;
  options.number_of_samples = 1000;
  return options;
}

} // namespace

// The limits at full resolution are the goals of the project. By the same measures, the analytic
// shapes have 13.9 degrees of frame error in T1 (a best-fit rotation is biased by shear) and 32 in
// T5; all others have nearly none.
BOOST_AUTO_TEST_SUITE(deformation_shapes)

BOOST_AUTO_TEST_CASE(a_bar_twisted_by_135_degrees)
{
  const auto m = run(pcs_test::bar_135(), at_full_resolution());
  BOOST_TEST(m.frame_error <= 14.5);
  BOOST_TEST(m.position_error <= .003);
  BOOST_TEST(m.volume_ratio >= .97);
}

BOOST_AUTO_TEST_CASE(a_bar_bent_by_120_degrees)
{
  const auto m = run(pcs_test::bar_bend_120(), at_full_resolution());
  BOOST_TEST(m.frame_error <= .3);
  BOOST_TEST(m.position_error <= .001);
  BOOST_TEST(m.largest_edge <= .20);
}

BOOST_AUTO_TEST_CASE(a_tube_bent_by_120_degrees)
{
  const auto m = run(pcs_test::tube_120(), at_full_resolution());
  BOOST_TEST(m.frame_error <= .2);
  BOOST_TEST(m.position_error <= .001);
}

BOOST_AUTO_TEST_CASE(a_plate_dragged_without_rotation)
{
  const auto m = run(pcs_test::plate_drag(), at_full_resolution());
  BOOST_TEST(m.rms_edge <= .0076); // CGAL's as-rigid-as-possible after 100 iterations on the mesh
  BOOST_TEST(m.rotation_smoothness <= 1.5);
}

BOOST_AUTO_TEST_CASE(a_bar_twisted_by_720_degrees)
{
  const auto m = run(pcs_test::bar_720(), at_full_resolution());
  BOOST_TEST(m.frame_error <= 33);
  BOOST_TEST(m.position_error <= .006);
  BOOST_TEST(m.volume_ratio >= .90);
}

BOOST_AUTO_TEST_CASE(what_coarse_samples_find_of_a_drag_is_where_the_passes_start)
{
  const Deformation_case drag = pcs_test::plate_drag();
  const auto share_at_start = [&](long long samples) {
    Options options;
    options.number_of_samples = samples;
    const auto report = deform(drag.points, handles_of(drag), options).report;
    return report.initial_energy / report.energy;
  };
  BOOST_TEST(share_at_start(800) > 25); // no coarser levels: starts from the handle field
  BOOST_TEST(share_at_start(2000) < 12);
}

BOOST_AUTO_TEST_CASE(a_thousand_samples_come_near)
{
  // Regression guards, not goals. Measured: T1 14.5 deg, .0048 L, volume .997; T2 2.1 deg, .0035 L;
  // T3 1.3 deg, .0012 L; T4 rms .021; T5 33.6 deg, .0072 L, volume 1.00.
  auto m = run(pcs_test::bar_135(), at_1000_samples());
  BOOST_TEST(m.frame_error <= 15.5);
  BOOST_TEST(m.position_error <= .0055);
  BOOST_TEST(m.volume_ratio >= .97);
  m = run(pcs_test::bar_bend_120(), at_1000_samples());
  BOOST_TEST(m.frame_error <= 2.4);
  BOOST_TEST(m.position_error <= .004);
  m = run(pcs_test::tube_120(), at_1000_samples());
  BOOST_TEST(m.frame_error <= 1.6);
  BOOST_TEST(m.position_error <= .0015);
  m = run(pcs_test::plate_drag(), at_1000_samples());
  BOOST_TEST(m.rms_edge <= .025);
  m = run(pcs_test::bar_720(), at_1000_samples());
  BOOST_TEST(m.frame_error <= 36);
  BOOST_TEST(m.position_error <= .009);
  BOOST_TEST(m.volume_ratio >= .9);
  BOOST_TEST(m.volume_ratio <= 1.1);
}

BOOST_AUTO_TEST_CASE(jitter_outliers_and_random_order_do_not_break_a_bend)
{
  auto c = pcs_test::bar_bend_120();
  const double h = 0.05;
  std::mt19937 random(1);
  for (Vec3& p : c.points)
    p += 0.3 * h * pcs_test::random_vector(random) / std::sqrt(3.0);
  const std::size_t n = c.points.size();
  for (std::size_t i = 0; i < n / 50; ++i)
    c.points.push_back(c.points[random() % n] + 5 * h * pcs_test::random_vector(random));
  const auto result = deform(c.points, handles_of(c), at_full_resolution());
  BOOST_TEST(pcs_test::is_finite(result));
  double squared = 0, largest_of_outliers = 0;
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    const double d = (result.points[i] - c.exact(c.points[i])).norm() / c.length;
    if (i < n)
      squared += d * d;
    else
      largest_of_outliers = std::max(largest_of_outliers, d);
  }
  BOOST_TEST_MESSAGE("jittered bend: rms " << std::sqrt(squared / double(n)) << " L, worst outlier "
                                           << largest_of_outliers << " L");
  BOOST_TEST(std::sqrt(squared / double(n)) < .003);
  BOOST_TEST(largest_of_outliers < .05); // outliers follow
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(deformation_sheets)

namespace {

/// Lifts the far end of the upper sheet, and returns the motion of the far part of the lower sheet.
double
motion_of_the_other_sheet(double gap, bool is_folded, const Options& options, bool& is_upper_moved)
{
  const int nx = 40, ny = 20;
  const Points points = pcs_test::sheets(nx, ny, gap, is_folded);
  const auto is_lower = [=](const Vec3& p) { return p.z() < gap / 2; };
  // Fixes the fold, or one end of each sheet.
  const auto fixed = pcs_test::select(points, [=](const Vec3& p) { return p.x() < 1.5; });
  const auto lifted =
      pcs_test::select(points, [=](const Vec3& p) { return p.x() > nx - 1.5 && !is_lower(p); });
  const auto result =
      deform(points, {{fixed, {}, 0}, {lifted, pcs::translation(Vec3(-5, 0, 15)), 0}}, options);
  double largest = 0, upper = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double d = (result.points[i] - points[i]).norm();
    if (is_lower(points[i])) {
      if (points[i].x() >= 10) // near the fold, few samples may link both sheets
        largest = std::max(largest, d);
    } else
      upper = std::max(upper, d);
  }
  is_upper_moved = upper > 10;
  return largest;
}

} // namespace

BOOST_AUTO_TEST_CASE(a_sheet_near_by_does_not_follow)
{
  for (const double gap : {1.5, 5.0})
    for (const bool is_folded : {false, true})
      for (const long long samples : {1000000, 200}) {
        Options options;
        options.number_of_samples = samples;
        bool is_upper_moved = false;
        const double d = motion_of_the_other_sheet(gap, is_folded, options, is_upper_moved);
        BOOST_TEST_CONTEXT("gap " << gap << (is_folded ? ", folded, " : ", separate, ") << samples
                                  << " samples")
        {
          BOOST_TEST(is_upper_moved);
          // The eight points of a block may belong to both sheets, so the motion has single
          // precision. With samples further apart than the sheets, the fold has an effect over one
          // more sample.
          BOOST_TEST(d < (is_folded && samples == 200 ? 0.03 : 2e-4));
        }
      }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(deformation_materials)

namespace {

/// Width at the middle of a strip stretched by 1.5, relative to rest.
double width_ratio(double poisson_ratio, long long samples)
{
  const int nx = 80, ny = 20;
  const Points points = pcs_test::plate(nx, ny, 1);
  Options options;
  options.number_of_samples = samples;
  options.poisson_ratio = poisson_ratio;
  const auto handles = pcs_test::two_handles(
      points,
      [](const Vec3& p) { return p.x() < 2.5; },
      [=](const Vec3& p) { return p.x() > nx - 2.5; },
      pcs::translation(Vec3(0.5 * (nx - 5), 0, 0)));
  const auto result = deform(points, handles, options);
  double low = 1e9, high = -1e9;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].x() == nx / 2) {
      low = std::min(low, result.points[i].y());
      high = std::max(high, result.points[i].y());
    }
  return (high - low) / ny;
}

} // namespace

BOOST_AUTO_TEST_CASE(a_stretched_strip_narrows_like_its_material)
{
  // 1.5^-nu
  const std::pair<double, double> materials[] = {{0, 1.0}, {0.5, 0.82}, {-0.5, 1.22}};
  for (const auto& [poisson_ratio, expected] : materials)
    for (const long long samples : {1000000, 300}) {
      const double found = width_ratio(poisson_ratio, samples);
      BOOST_TEST_MESSAGE("nu " << poisson_ratio << ", " << samples << " samples: width ratio "
                               << found);
      BOOST_TEST_CONTEXT("nu " << poisson_ratio << ", " << samples << " samples")
      BOOST_TEST(std::abs(found - expected) < 0.03);
    }
}

BOOST_AUTO_TEST_CASE(springs_through_the_interior_follow_the_material)
{
  // A closed bar, stretched by 1.5: its sides narrow by 1.5^-nu.
  const pcs_test::Bar_edit bar(12, 48);
  const auto handles = pcs_test::two_handles(
      bar.points,
      [](const Vec3& p) { return p.z() < .2; },
      [](const Vec3& p) { return p.z() > 3.8; },
      pcs::translation(Vec3(0, 0, .5 * 3.6)));
  const std::pair<double, double> materials[] = {{0, 1.0}, {0.5, 0.82}, {-0.5, 1.22}};
  for (const auto& [poisson_ratio, expected] : materials)
    for (const long long samples : {1000000, 1000}) {
      Options options;
      options.number_of_samples = samples;
      options.poisson_ratio = poisson_ratio;
      const auto result = deform(bar.points, handles, options);
      BOOST_TEST(result.report.number_of_interior_links > 0u);
      Vec3 low = Vec3::Constant(1e9), high = -low;
      for (std::size_t i = 0; i < bar.points.size(); ++i)
        if (std::abs(bar.points[i].z() - 2) < .1) {
          low = low.cwiseMin(result.points[i]);
          high = high.cwiseMax(result.points[i]);
        }
      const double found = (high - low).head<2>().mean();
      BOOST_TEST_MESSAGE("nu " << poisson_ratio << ", " << samples << " samples: width ratio "
                               << found);
      BOOST_TEST_CONTEXT("nu " << poisson_ratio << ", " << samples << " samples")
      BOOST_TEST(std::abs(found - expected) < 0.07);
    }
}

namespace {

/// A closed cylinder of radius 1 along z, from 0 to `height`, on a spiral; caps included.
Points closed_cylinder(int number_of_points, double height)
{
  const double golden = 2.399963229728653;
  Points points;
  const int on_caps = static_cast<int>(number_of_points / (1 + height));
  for (int i = 0; i < number_of_points - on_caps; ++i) {
    const double share = (i + 0.5) / (number_of_points - on_caps);
    points.emplace_back(std::cos(golden * i), std::sin(golden * i), height * share);
  }
  for (int i = 0; i < on_caps; ++i) {
    const double r = std::sqrt((i / 2 + 0.5) / (on_caps / 2));
    points.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), i % 2 * height);
  }
  return points;
}

} // namespace

BOOST_AUTO_TEST_CASE(a_closed_body_follows_its_material_with_any_number_of_samples)
{
  // Stretched by 1.5: the radius becomes 1.5^-nu. Few samples are far apart, and their links are
  // oblique.
  const double height = 10;
  const Points points = closed_cylinder(4000, height);
  const auto handles = pcs_test::two_handles(
      points,
      [](const Vec3& p) { return p.z() < 1; },
      [=](const Vec3& p) { return p.z() > height - 1; },
      pcs::translation(Vec3(0, 0, 0.5 * (height - 2))));
  for (const double poisson_ratio : {0.5, 0.25, -0.25, -0.5, -0.9})
    for (const long long samples : {200, 250, 300, 500, 700, 1000, 1000000}) {
      Options options;
      options.number_of_samples = samples;
      options.poisson_ratio = poisson_ratio;
      const auto result = deform(points, handles, options);
      double sum = 0;
      int count = 0;
      for (std::size_t i = 0; i < points.size(); ++i)
        if (std::abs(points[i].z() - height / 2) < height / 10) {
          sum += result.points[i].head<2>().norm();
          ++count;
        }
      const double radius = sum / count, expected = std::pow(1.5, -poisson_ratio);
      BOOST_TEST_MESSAGE("nu " << poisson_ratio << ", " << samples << " samples, "
                               << result.report.number_of_interior_links << " links: radius "
                               << radius << ", expected " << expected);
      BOOST_TEST_CONTEXT("nu " << poisson_ratio << ", " << samples << " samples")
      {
        BOOST_TEST(std::abs(radius / expected - 1) < 0.07);
        BOOST_TEST(result.report.energy < 0.8 * result.report.initial_energy);
      }
    }
}

BOOST_AUTO_TEST_CASE(a_small_poisson_ratio_changes_little)
{
  // The energy is continuous at zero, where no stretch of the material is computed.
  const pcs_test::Bar_edit bar(12, 48);
  Options options;
  const auto without = deform(bar.points, bar.handles, options);
  options.poisson_ratio = 1e-6;
  const auto with = deform(bar.points, bar.handles, options);
  BOOST_TEST(pcs_test::largest_distance(without.points, with.points) < 1e-4);
  BOOST_TEST(std::abs(with.report.energy / without.report.energy - 1) < 1e-3);
}

BOOST_AUTO_TEST_CASE(a_stiffer_body_bends_less)
{
  // A dragged plate: a larger stiffness reduces bending and increases stretch.
  const Points points = pcs_test::plate(40, 8, 1);
  const auto handles = pcs_test::two_handles(
      points,
      [](const Vec3& p) { return p.x() < 1.5; },
      [](const Vec3& p) { return p.x() > 38.5; },
      pcs::translation(Vec3(-10, 0, 10)));
  double before = 1e9;
  for (const double stiffness : {0.1, 1.0, 10.0}) {
    Options options;
    options.stiffness = stiffness;
    options.number_of_iterations = 200;
    options.tolerance = 1e-4;
    const auto result = deform(points, handles, options);
    BOOST_TEST(pcs_test::is_finite(result));
    std::vector<Vec3> line;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (points[i].y() == 4)
        line.push_back(result.points[i]);
    double bending = 0;
    for (std::size_t i = 1; i + 1 < line.size(); ++i)
      bending += ((line[i + 1] - line[i]).normalized() - (line[i] - line[i - 1]).normalized())
                     .squaredNorm();
    BOOST_TEST_MESSAGE("stiffness " << stiffness << ": bending " << bending << ", "
                                    << result.report.number_of_iterations << " passes");
    BOOST_TEST(bending < before);
    before = bending;
  }
}

BOOST_AUTO_TEST_CASE(denser_points_make_a_plate_no_softer)
{
  // A wavy plate, compressed and lifted. Every third point of one sampling is a point of the other.
  const auto bend = [](int cells) {
    const double pi = 3.14159265358979323846;
    Points points;
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x) {
        const double u = double(x) / cells, v = double(y) / cells;
        points.emplace_back(u, v, 0.01 * std::sin(4 * pi * u) * std::sin(4 * pi * v));
      }
    const auto handles = pcs_test::two_handles(
        points,
        [](const Vec3& p) { return p.x() < 0.1001; },
        [](const Vec3& p) { return p.x() > 0.8999; },
        pcs::translation(Vec3(-0.25, 0, 0.4)));
    Options options = at_full_resolution();
    options.do_preserve_volume = false;
    return deform(points, handles, options).points;
  };
  constexpr int coarse = 50, ratio = 3, fine = ratio * coarse;
  const Points few = bend(coarse), many = bend(fine);
  double squared = 0;
  for (int y = 0; y <= coarse; ++y)
    for (int x = 0; x <= coarse; ++x)
      squared += (few[static_cast<std::size_t>(y * (coarse + 1) + x)] -
                  many[static_cast<std::size_t>(ratio * (y * (fine + 1) + x))])
                     .squaredNorm();
  const double difference = std::sqrt(squared / double(few.size()));
  BOOST_TEST_MESSAGE("root mean square difference " << difference);
  BOOST_TEST(difference < 0.006);
}

// A bottle whose lip is rotated about its center. The field of the handles rotates the whole body,
// the minimum of the energy bends the neck. The springs through the inside must follow, since
// damping them requires a hundred passes.
BOOST_AUTO_TEST_CASE(a_few_passes_come_near_the_least_energy)
{
  Points points;
  const int rings = 120;
  for (int k = 0; k < rings; ++k) {
    const double z = 3.0 * k / (rings - 1), radius = .2 + .4 / (1 + std::exp(12 * (z - 1.5)));
    const int around = static_cast<int>(std::lround(2 * pcs_test::pi * radius * rings / 3));
    for (int j = 0; j < around; ++j) {
      const double angle = 2 * pcs_test::pi * (j + .5 * (k % 2)) / around;
      points.push_back(Vec3(radius * std::cos(angle), radius * std::sin(angle), z));
    }
  }
  for (const double shift : {0.0, 0.6}) {
    const Handles handles = pcs_test::two_handles(
        points,
        [](const Vec3& p) { return p.z() < .15; },
        [](const Vec3& p) { return p.z() > 2.75; },
        pcs::translation(Vec3(shift, 0, -shift / 2)) *
            pcs::rotation(Vec3(1, 0, 0), pcs_test::pi / 2, Vec3(0, 0, 2.9)));
    Options options = at_1000_samples();
    const auto few = deform(points, handles, options).report;
    options.number_of_iterations = 1000;
    options.tolerance = 1e-5;
    const auto many = deform(points, handles, options).report;
    BOOST_TEST_MESSAGE(few.number_of_iterations << " passes " << few.energy << ", "
                                                << many.number_of_iterations << " passes "
                                                << many.energy);
    BOOST_TEST(few.energy < 1.3 * many.energy);
    BOOST_TEST(many.number_of_iterations < 100);
  }
}

BOOST_AUTO_TEST_CASE(interior_springs_keep_volume)
{
  const auto c = pcs_test::bar_135();
  Options options = at_1000_samples();
  const double with = run(c, options).volume_ratio;
  options.do_preserve_volume = false;
  const double without = run(c, options).volume_ratio;
  BOOST_TEST(with > without + 0.02);
}

// Above 20,000 nodes, only the coarser levels have interior springs.
BOOST_AUTO_TEST_CASE(interior_springs_keep_volume_at_full_resolution)
{
  pcs_test::Deformation_case c;
  pcs_test::make_box(Vec3(-.5, -.5, 0), Vec3(1, 1, 4), 40, 40, 160, c);
  pcs_test::twist(c, .2, 4, pcs_test::pi);
  const auto m = run(c, at_full_resolution());
  BOOST_TEST(m.volume_ratio > 0.97);
  BOOST_TEST(m.position_error < 0.008);
  // Without passes, the result depends only on the field of the handles.
  Options options = at_full_resolution();
  options.number_of_iterations = 0;
  const Points with = deform(c.points, handles_of(c), options).points;
  options.do_preserve_volume = false;
  BOOST_TEST((deform(c.points, handles_of(c), options).points == with));
}

BOOST_AUTO_TEST_CASE(few_samples_tear_nothing_between_handles)
{
  const int nx = 80, ny = 40;
  const Points points = pcs_test::plate(nx, ny, 1);
  Options options;
  options.number_of_samples = 60; // 7 to 8 apart
  for (const double gap : {3.0, 8.0, 20.0})
    for (const bool is_turned : {false, true}) {
      Handles handles(2);
      for (std::size_t i = 0; i < points.size(); ++i)
        if (std::abs(points[i].x() - 40) >= gap / 2)
          handles[points[i].x() < 40 ? 0 : 1].indices.push_back(i);
      handles[1].transformation =
          is_turned ? pcs::Similarity::about(pcs::Similarity::from_turn(Vec3(0, 1, 0)),
                                             Vec3(40 + gap / 2, ny / 2, 0))
                    : pcs::Similarity::from_translation(Vec3(0, 0, gap));
      const Points moved = deform(points, handles, options).points;
      double steepest = 0;
      for (std::size_t i = 0; i < points.size(); ++i)
        for (const std::size_t j : {i + 1, i + std::size_t(ny) + 1})
          if (j < points.size() && (points[j] - points[i]).norm() < 1.5)
            steepest = std::max(steepest, ((moved[j] - points[j]) - (moved[i] - points[i])).norm());
      BOOST_TEST_MESSAGE("gap " << gap << (is_turned ? ", turned" : ", lifted") << ": steepest "
                                << steepest);
      // The gradient of a straight plate is 1 everywhere.
      BOOST_TEST(steepest < 2.5);
    }
}

BOOST_AUTO_TEST_CASE(the_variants_of_the_dissertation_run_and_differ)
{
  const pcs_test::Bar_edit edit(10, 40);
  Options options;
  options.number_of_samples = 300;
  const auto standard = deform(edit.points, edit.handles, options);
  Options inverse = options, hops = options, quaternion = options;
  inverse.sample_weights = pcs::Sample_weights::inverse_square;
  hops.sample_search = pcs::Sample_search::breadth_first_hops;
  quaternion.rotation_field = pcs::Rotation_field::quaternion;
  for (const auto& variant : {inverse, hops, quaternion}) {
    const auto result = deform(edit.points, edit.handles, variant);
    BOOST_TEST(pcs_test::is_finite(result));
    const double d = pcs_test::largest_distance(result.points, standard.points);
    BOOST_TEST(d > 1e-6);
    BOOST_TEST(d < 0.2); // a variant of the same shape
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_deformation_shapes
