// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees that are rotated about the vertical, and frames that are robust to noise of single edges.

#include <pcs/IO/read_correspondences.h>
#include <pcs/IO/write_correspondences.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/core/rotations.h>
#include <support/drawn.h>
#include <support/exceptions.h>
#include <support/orl_spaces.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <unistd.h>

namespace test_orl_alignment {

using namespace orl_test;
using pcs::Orl_alignment;
namespace np = pcs::parameters;
using pcs_test::message_has;

namespace {

const auto turns = np::alignment(Orl_alignment::rotate_about_up);

Eigen::Matrix3d about(const Vec3& axis, double angle)
{
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// The tree after some growth: branches are cut and rotated.
Tree grown(const std::vector<Branch>& branches, double turn, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  Turns own(branches.size(), Eigen::Matrix3d::Identity());
  std::vector<char> kept(branches.size(), 1);
  for (std::size_t b = 1; b < branches.size(); ++b) {
    const double angle = turn * normal(random);
    own[b] = about(pcs_test::drawn<Vec3>([&] { return normal(random); }).normalized(), angle);
    kept[b] = uniform(random) > 0.3;
  }
  std::vector<std::size_t> tip;
  return make_tree(branches, own, kept, tip);
}

struct Nodes
{
  std::vector<Vec3> of(const Space& space, double lambda) const
  {
    Tree tree;
    space.skeleton(space.geodesic(0, 1, lambda), tree);
    std::vector<Vec3> result;
    for (const auto v : boost::make_iterator_range(vertices(tree)))
      result.push_back(to_eigen(tree[v].point));
    return result;
  }
};

double worst_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
  double result = a.size() == b.size() ? 0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    result = std::max(result, (a[i] - b[i]).norm());
  return result;
}

/// Adds a short edge at the beginning of a branch, tilted by `tilt` relative to the rest.
void tilt_base(std::vector<Branch>& branches,
               std::size_t b,
               double length,
               double tilt,
               std::mt19937& random)
{
  std::uniform_real_distribution<double> azimuth(0, 2 * CGAL_PI);
  Branch& branch = branches[b];
  const Vec3 along = (branch.points[1] - branch.points[0]).normalized();
  const Vec3 side = about(along, azimuth(random)) * along.unitOrthogonal();
  const Vec3 step = length * (std::cos(tilt) * along + std::sin(tilt) * side);
  for (std::size_t k = 1; k < branch.points.size(); ++k)
    branch.points[k] += step;
  branch.points.insert(branch.points.begin() + 1, branch.points[0] + step);
  branch.radii.insert(branch.radii.begin() + 1, branch.radii[0]);
  for (Branch& child : branches)
    if (child.parent == b)
      ++child.at;
}

} // namespace

BOOST_AUTO_TEST_SUITE(orl_alignment)

BOOST_FIXTURE_TEST_CASE(a_tree_that_was_turned_is_itself, Nodes)
{
  for (const unsigned seed : {21u, 22u, 23u})
    for (const double degrees : {50., 170., -95.})
      for (const Vec3& up : {Vec3(0, 0, 1), Vec3(0, 3, 0)}) {
        const double angle = degrees * CGAL_PI / 180;
        const Vec3 axis = up.normalized();
        const Eigen::Matrix3d upright =
            pcs::rotation_between(Vec3::UnitZ(), axis).toRotationMatrix();
        const Tree a = moved(random_tree(seed), upright, Vec3::Zero());
        const Tree b = moved(a, about(axis, angle), Vec3::Zero());
        Space space;
        space.add_skeleton(a);
        space.add_skeleton(b);
        const auto report =
            space.build(np::alignment(Orl_alignment::rotate_about_up)
                            .up_direction(Kernel::Vector_3(up.x(), up.y(), up.z())));
        BOOST_TEST_CONTEXT("seed " << seed << ", " << degrees << " degrees about " << axis)
        {
          BOOST_TEST(std::abs(report.yaw + angle) < 1e-6);
          BOOST_TEST(report.unexplained_fraction < 1e-6);
          for (const pcs::Branch_match& m : space.matches())
            BOOST_TEST(m.tip[0] == m.tip[1]);
          // Half-way, the tree is equal, rotated by half of the angle.
          const std::vector<Vec3> first = of(space, 0);
          for (const double lambda : {0.5, 1.0}) {
            std::vector<Vec3> turned = first;
            for (Vec3& p : turned)
              p = about(axis, lambda * angle) * p;
            BOOST_TEST(worst_distance(of(space, lambda), turned) < 1e-5);
          }
        }
      }
}

BOOST_AUTO_TEST_CASE(a_grown_tree_is_found_however_it_stands)
{
  double right = 0, all = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    const std::vector<Branch> branches = random_branches(200 + seed);
    const Tree a = make_tree(branches), b = grown(branches, 0.2, seed);
    for (const double degrees : {50., 170.}) {
      const double angle = degrees * CGAL_PI / 180;
      Space still, turned;
      still.add_skeleton(a);
      still.add_skeleton(b);
      still.build();
      turned.add_skeleton(a);
      turned.add_skeleton(moved(b, about(Vec3::UnitZ(), angle), Vec3::Zero()));
      const auto report = turned.build(turns);
      BOOST_TEST(std::abs(std::remainder(report.yaw + angle, 2 * CGAL_PI)) <
                 0.3); // trunks and branches were rotated, too
      const auto expected = still.matches(), found = turned.matches();
      for (const pcs::Branch_match& m : expected) {
        all += 1;
        right += std::any_of(found.begin(), found.end(), [&](const pcs::Branch_match& f) {
          return f.tip == m.tip;
        });
      }
    }
  }
  BOOST_TEST_MESSAGE("as without a turn: " << right / all);
  BOOST_TEST(right > 0.95 * all);
}

BOOST_AUTO_TEST_CASE(trees_that_stand_right_are_not_turned)
{
  for (unsigned seed = 0; seed < 6; ++seed) {
    const std::vector<Branch> branches = random_branches(300 + seed);
    const Tree a = make_tree(branches),
               b = seed == 0 ? a : grown(branches, 0.1 * static_cast<double>(seed), seed);
    const std::vector<Point> scan_a = tube_points(a, 1000, 1), scan_b = tube_points(b, 1000, 2);
    std::vector<Point> points[2];
    for (const int k : {0, 1}) {
      Space space;
      space.add(a, scan_a);
      space.add(b, scan_b);
      const auto report = k == 0 ? space.build() : space.build(turns);
      BOOST_TEST(report.yaw == 0);
      space.points(space.geodesic(0, 1, 0.5), points[k]);
    }
    BOOST_TEST((points[0] == points[1]));
  }
}

BOOST_AUTO_TEST_CASE(the_ends_of_a_path_with_a_turn_are_the_inputs)
{
  const Tree a = random_tree(31),
             b = moved(grown(random_branches(31), 0.1, 5), about(Vec3::UnitZ(), 2), {10, 20, 30});
  const std::vector<Point> scans[2] = {tube_points(a, 3000, 1), tube_points(b, 3000, 2)};
  Space space;
  space.add(a, scans[0]);
  space.add(b, scans[1]);
  BOOST_TEST(std::abs(space.build(turns).yaw + 2) < 0.2);
  for (const std::size_t end : {0u, 1u}) {
    const pcs::Orl_tree tree = space.tree(end);
    std::vector<Point> points;
    space.points(tree, points);
    std::vector<double> error(points.size(), 0); // separate: points may be visited concurrently
    space.for_each_point(tree, [&](std::size_t i, std::size_t k, std::size_t l, double) {
      if (const std::size_t own = end == 0 ? k : l; own != pcs::npos)
        error[i] = std::sqrt(CGAL::squared_distance(points[i], scans[end][own]));
    });
    BOOST_TEST(*std::max_element(error.begin(), error.end()) < 1e-12 * 50);
  }
  // The alignment is preserved in a file.
  const std::string path =
      (std::filesystem::temp_directory_path() / ("pcs_turn_" + std::to_string(::getpid()) + ".txt"))
          .string();
  pcs::IO::write_correspondences(path, space.correspondences());
  Space again;
  again.add(a, scans[0]);
  again.add(b, scans[1]);
  auto kept = pcs::IO::read_correspondences(path);
  std::filesystem::remove(path);
  const pcs::Orl_report report = again.build_from(kept);
  BOOST_TEST(std::abs(report.yaw - space.build(turns).yaw) < 1e-12);
  BOOST_TEST(std::isnan(report.unexplained_fraction)); // not stored in the file
  std::vector<Point> one, two;
  space.points(space.geodesic(0, 1, 0.7), one);
  again.points(again.geodesic(0, 1, 0.7), two);
  BOOST_TEST((one == two));
  kept.rotation[0] += 1;
  BOOST_CHECK_EXCEPTION(again.build_from(kept), pcs::Invalid_input, message_has("no rotation"));
}

BOOST_AUTO_TEST_CASE(turns_do_not_depend_on_the_number_of_threads)
{
  const Tree a = random_tree(41),
             b = moved(grown(random_branches(41), 0.3, 7), about(Vec3::UnitZ(), 1), Vec3::Zero());
  pcs::Orl_shape_space<Kernel, CGAL::Sequential_tag> expected;
  expected.add_skeleton(a);
  expected.add_skeleton(b);
  const double turn = expected.build(turns).yaw;
  BOOST_TEST(turn != 0);
  for (const int n : pcs_test::thread_counts)
    pcs_test::with_threads(n, [&] {
      Space space;
      space.add_skeleton(a);
      space.add_skeleton(b);
      BOOST_TEST(space.build(turns).yaw == turn);
      BOOST_TEST(space.distance(0, 1) == expected.distance(0, 1));
    });
}

BOOST_AUTO_TEST_CASE(looking_for_turns_can_be_stopped)
{
  const Tree a = random_tree(31),
             b = moved(grown(random_branches(31), 0.1, 5), about(Vec3::UnitZ(), 2), {10, 20, 30});
  const auto count = [&](int stop, auto alignment) {
    Space space;
    space.add_skeleton(a);
    space.add_skeleton(b);
    int calls = 0;
    const auto report =
        space.build(np::alignment(alignment).callback([&](double) { return ++calls != stop; }));
    BOOST_TEST((report.status == pcs::Status::cancelled) == (stop > 0));
    return calls;
  };
  const int as_given = count(0, Orl_alignment::as_given),
            all = count(0, Orl_alignment::rotate_about_up);
  BOOST_TEST(all > as_given + 10); // initial angles, evaluations, and the best matchings
  for (const int stop : {as_given, as_given + 4, as_given + 8})
    BOOST_TEST(count(stop, Orl_alignment::rotate_about_up) == stop);
}

BOOST_AUTO_TEST_CASE(bad_verticals_and_more_trees_are_refused)
{
  Space space;
  space.add_skeleton(random_tree(1, 2, 2));
  space.add_skeleton(random_tree(2, 2, 2));
  const double bad = std::numeric_limits<double>::quiet_NaN();
  for (const Kernel::Vector_3& up : {Kernel::Vector_3(0, 0, 0), Kernel::Vector_3(0, bad, 1)})
    BOOST_CHECK_EXCEPTION(
        space.build(np::alignment(Orl_alignment::rotate_about_up).up_direction(up)),
        pcs::Invalid_input,
        message_has("up_direction"));
  space.add_skeleton(random_tree(3, 2, 2));
  BOOST_CHECK_EXCEPTION(space.build(turns), pcs::Invalid_input, message_has("two trees"));
  space.build();
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(orl_frames)

BOOST_FIXTURE_TEST_CASE(short_edges_at_bases_turn_nothing, Nodes)
{
  // Both trees are equal, except for short edges with random directions at bases, and noise of all
  // nodes.
  for (const bool is_trunk : {true, false}) {
    double turn = 0, residual = 0;
    const unsigned number = 20;
    for (unsigned seed = 0; seed < number; ++seed) {
      std::mt19937 random(seed);
      const auto make = [&] {
        std::normal_distribution<double> normal(0, 0.01);
        std::vector<Branch> branches = random_branches(500 + seed, 5, 3);
        for (std::size_t b = 0; b < (is_trunk ? 1 : branches.size()); ++b)
          tilt_base(branches, b, 0.02 * branches[b].points.back().norm(), 0.6, random);
        for (Branch& b : branches) {
          const double length = b.points.back().norm();
          for (std::size_t k = 1; k < b.points.size(); ++k)
            b.points[k] += length * pcs_test::drawn<Vec3>([&] { return normal(random); });
        }
        return make_tree(branches);
      };
      const Tree a = make(), b = make();
      const Space space = make_space(a, b);
      const std::vector<Vec3> first = of(space, 0), middle = of(space, 0.5), last = of(space, 1);
      Eigen::Matrix3Xd expected(3, static_cast<Eigen::Index>(first.size())), found = expected;
      for (std::size_t i = 0; i < first.size(); ++i) {
        expected.col(static_cast<Eigen::Index>(i)) = 0.5 * (first[i] + last[i]);
        found.col(static_cast<Eigen::Index>(i)) = middle[i];
      }
      const Eigen::Matrix4d fit = Eigen::umeyama(expected, found, false);
      const double cosine = 0.5 * (fit.topLeftCorner<3, 3>().trace() - 1);
      turn = std::max(turn, std::acos(std::min(1.0, cosine)));
      const Eigen::Matrix3Xd off =
          found - ((fit.topLeftCorner<3, 3>() * expected).colwise() + fit.topRightCorner<3, 1>());
      residual += off.norm() / (expected.colwise() - expected.rowwise().mean()).norm() / number;
    }
    BOOST_TEST_MESSAGE("turn " << turn << ", residual " << residual);
    BOOST_TEST(turn < 0.12);     // 0.4 with an independent twist of each edge
    BOOST_TEST(residual < 0.12); // 0.09 then, 0.26 with short edges at all bases
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_orl_alignment
