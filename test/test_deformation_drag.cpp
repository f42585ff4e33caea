// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Frames of a drag that start from the previous frame.

#include <pcs/Point_set_deformation.h>
#include <support/deform_cloud.h>

#include <boost/test/unit_test.hpp>

namespace test_deformation_drag {

namespace {

using pcs::Solver_start;
using pcs_test::Points;
using pcs_test::Vec3;

const int both_resolutions[] = {1000000, 150};

template <class ConcurrencyTag>
struct Drag
{
  using Parameters = decltype(pcs::parameters::number_of_samples(0));

  pcs_test::Bar_edit edit;
  Points points = edit.points;
  pcs::Point_set_deformation<Points, Parameters, ConcurrencyTag> session;
  std::size_t number_of_passes = 0;

  explicit Drag(int samples) : session(points, pcs::parameters::number_of_samples(samples))
  {
    session.add_handle(edit.handles[0].indices);
    session.add_handle(edit.handles[1].indices);
  }

  pcs::Deformation_report turn_to(double angle, Solver_start start)
  {
    session.set_rotation(1, Vec3(0, 1, 1), angle);
    const auto report = session.deform(start);
    number_of_passes += report.number_of_iterations;
    return report;
  }
};
using Any_drag = Drag<CGAL::Parallel_if_available_tag>;

constexpr double degree = 3.14159265358979323846 / 180;

} // namespace

BOOST_AUTO_TEST_SUITE(deformation_drag)

BOOST_AUTO_TEST_CASE(warm_frames_follow_the_handle_with_fewer_passes)
{
  for (const int samples : both_resolutions) {
    Any_drag warm(samples), cold(samples);
    for (int frame = 1; frame <= 45; ++frame) {
      const auto a = warm.turn_to(2 * frame * degree, Solver_start::warm);
      const auto b = cold.turn_to(2 * frame * degree, Solver_start::cold);
      BOOST_TEST((a.status == pcs::Status::converged));
      BOOST_TEST(a.energy < 1.2 * b.energy);
      BOOST_TEST(a.initial_energy < b.initial_energy * (1 + 1e-9));
    }
    BOOST_TEST(3 * warm.number_of_passes < 2 * cold.number_of_passes);
  }
}

BOOST_AUTO_TEST_CASE(more_warm_frames_at_rest_go_on_to_the_least_energy)
{
  Points points = pcs_test::Bar_edit().points;
  pcs::Point_set_deformation session(
      points,
      pcs::parameters::number_of_samples(150).tolerance(1e-9).number_of_iterations(2000));
  session.add_handle(pcs_test::Bar_edit().handles[0].indices);
  session.set_rotation(session.add_handle(pcs_test::Bar_edit().handles[1].indices),
                       Vec3(0, 1, 1),
                       80 * degree);
  const double least = session.deform().energy;

  Any_drag s(150);
  double energy = s.turn_to(80 * degree, Solver_start::cold).energy;
  BOOST_TEST(energy > 1.002 * least);
  for (int frame = 0; frame < 100; ++frame) {
    const double next = s.turn_to(80 * degree, Solver_start::warm).energy;
    BOOST_TEST(next <= energy * (1 + 1e-9));
    energy = next;
  }
  BOOST_TEST(energy < 1.002 * least);
  BOOST_TEST(energy > least * (1 - 1e-6));
}

BOOST_AUTO_TEST_CASE(a_large_step_new_handles_and_a_restored_snapshot_begin_cold)
{
  for (const int samples : both_resolutions) {
    Any_drag s(samples), fresh(samples);
    s.turn_to(1 * degree, Solver_start::warm);
    s.turn_to(120 * degree, Solver_start::warm);
    fresh.turn_to(120 * degree, Solver_start::cold);
    BOOST_TEST((s.points == fresh.points));

    const auto snapshot = s.session.snapshot();
    s.turn_to(118 * degree, Solver_start::warm);
    s.session.restore(snapshot);
    s.turn_to(119 * degree, Solver_start::warm);
    fresh.turn_to(119 * degree, Solver_start::cold);
    BOOST_TEST((s.points == fresh.points));

    s.session.add_handle(std::vector<int>{300});
    fresh.session.add_handle(std::vector<int>{300});
    s.turn_to(118 * degree, Solver_start::warm);
    fresh.turn_to(118 * degree, Solver_start::cold);
    BOOST_TEST((s.points == fresh.points));

    s.session.reset();
    s.turn_to(5 * degree, Solver_start::warm);
    fresh.turn_to(5 * degree, Solver_start::cold);
    BOOST_TEST((s.points == fresh.points));
  }
}

BOOST_AUTO_TEST_CASE(every_number_of_threads_gives_the_same_bits)
{
  for (const int samples : both_resolutions) {
    Any_drag parallel(samples);
    Drag<CGAL::Sequential_tag> sequential(samples);
    for (int frame = 1; frame <= 10; ++frame) {
      parallel.turn_to(3 * frame * degree, Solver_start::warm);
      sequential.turn_to(3 * frame * degree, Solver_start::warm);
      BOOST_TEST((parallel.points == sequential.points));
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_deformation_drag
