// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests options of the program deform_point_set: number of samples, region, material, solver, and
// published variants.

#include <pcs/deform_point_set.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <examples/Program_run.h>
#include <functional>
#include <string>
#include <vector>

namespace test_program_options {

namespace {

using Vec3 = Eigen::Vector3d;
using Points = std::vector<Table::Point_3>;

const std::string arguments = "--input in.ply --edit edit.json --output out.ply";
const std::string fixed_foot = R"({"select": {"property": "status", "equals": 0}, "fixed": true})";
const Vec3 axis(1000.1, -20.3, 0); // of the pillar

Json edit_with_head(const std::string& motion)
{
  return parse(R"({"handles": [)" + fixed_foot +
               R"(, {"select": {"property": "status", "equals": 9}, )" + motion + "}]}");
}

const std::string twist = R"("rotate": {"axis": [0, 0, 1], "degrees": 200})";
const std::string bend = R"("rotate": {"axis": [0, 1, 0], "degrees": 70}, "translate": [3, 0, -1])";

std::vector<std::size_t> with_status(const Table& table, int status)
{
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < table.number_of_points(); ++i)
    if (table.property<std::uint8_t>("status")[i] == status)
      result.push_back(i);
  return result;
}

/// Mean distance of the points in the middle of the pillar from its axis at rest. [L]
double middle_radius(const Table& table)
{
  double sum = 0;
  const std::vector<std::size_t> middle = with_status(table, 5);
  for (const std::size_t i : middle) {
    const auto& p = table.points()[i];
    sum += std::hypot(p.x() - axis.x(), p.y() - axis.y());
  }
  return sum / double(middle.size());
}

double largest_distance(const Points& a, const Points& b)
{
  double result = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    result = std::max(result, std::sqrt((a[i] - b[i]).squared_length()));
  return result;
}

/// A pillar of `n` points without properties.
void write_pillar(const Deform_run& program, std::size_t n)
{
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.399963229728653 * double(i);
    points.emplace_back(std::cos(angle), std::sin(angle), 10 * double(i) / double(n));
  }
  pcs::IO::write_points(program.path("pillar.ply"), points);
}

/// A run on pillar.ply, with the bytes of its output.
std::string pillar_output(Deform_run& program, const std::string& more)
{
  BOOST_TEST_REQUIRE(program.run("--input pillar.ply --default-edit --output out.ply --report "
                                 "report.json " +
                                 more) == 0,
                     program.err);
  program.report = Json::parse(program.content("report.json"));
  return program.content("out.ply");
}

/// The bend of the head by the library, with the defaults of the program.
template <class NamedParameters>
Points by_library(const Table& input, const NamedParameters& np)
{
  Points points = input.points();
  const std::vector<std::size_t> head = with_status(input, 9);
  Vec3 c = Vec3::Zero();
  for (const std::size_t i : head)
    c += Vec3(points[i].x(), points[i].y(), points[i].z()) / double(head.size());
  const pcs::Similarity motion = pcs::translation(Vec3(3, 0, -1)) *
                                 pcs::rotation(Vec3(0, 1, 0), 70 * std::acos(-1.0) / 180, c);
  pcs::deform_point_set(points, with_status(input, 0), head, motion, np);
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(default_samples)

BOOST_FIXTURE_TEST_CASE(small_clouds_are_solved_whole_and_large_ones_on_samples, Deform_run)
{
  write_pillar(*this, pcs::largest_unsampled_size);
  const std::string whole = pillar_output(*this, "");
  BOOST_TEST(report["samples"] == 20000);
  BOOST_TEST(report["samples_reason"] == "all points, there are at most 20000");
  BOOST_TEST(out.find("samples     20000 (all points") != std::string::npos, out);
  BOOST_TEST((pillar_output(*this, "--samples 20000") == whole));
  BOOST_TEST(report["samples_reason"] == "--samples");
  BOOST_TEST((pillar_output(*this, "--stream") == whole));
  BOOST_TEST(report["samples_reason"] == "all points, there are at most 20000");

  write_pillar(*this, pcs::largest_unsampled_size + 1);
  const std::string sampled = pillar_output(*this, "");
  BOOST_TEST(report["samples"] == 2000);
  BOOST_TEST(report["samples_reason"] == "default for more than 20000 points");
  BOOST_TEST((pillar_output(*this, "--samples 2000") == sampled));
  BOOST_TEST((pillar_output(*this, "--stream") == sampled));
}

BOOST_FIXTURE_TEST_CASE(a_stream_that_keeps_a_part_uses_samples, Deform_run)
{
  write_pillar(*this, 3000);
  pillar_output(*this, "--stream --stream-points 2500");
  BOOST_TEST(report["samples"] == 2000);
  BOOST_TEST(report["samples_reason"] == "default, --stream keeps a part of the points");
  pillar_output(*this, "--stream --stream-points 2500 --samples 700");
  BOOST_TEST(report["samples"] == 700);
  BOOST_TEST(report["samples_reason"] == "--samples");
}

BOOST_FIXTURE_TEST_CASE(published_weights_and_hops_need_samples, Deform_run)
{
  write_pillar(*this, 3000);
  const std::string whole = pillar_output(*this, "");
  for (const std::string names : {"weights", "hops", "", "rotations weights"}) {
    pillar_output(*this, "--as-published " + names);
    BOOST_TEST(report["samples"] == 2000, names);
    BOOST_TEST(report["samples_reason"] == "default of --as-published weights and hops");
    BOOST_TEST(report["warnings"].empty());
  }
  pillar_output(*this, "--as-published rotations");
  BOOST_TEST(report["samples"] == 3000);
  BOOST_TEST((pillar_output(*this, "--as-published weights hops --samples 3000") == whole));
  BOOST_TEST(err.find("have no effect") != std::string::npos, err);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(model_options)

BOOST_FIXTURE_TEST_CASE(a_stretched_pillar_narrows_by_poissons_ratio, Deform_run)
{
  const Json edit = edit_with_head(R"("translate": [0, 0, 4])"); // the middle is stretched by 1.5
  const std::pair<const char*, double> materials[] = {{"", 0}, {"0.5", 0.5}, {"-0.5", -0.5}};
  for (const auto& [text, ratio] : materials) {
    const std::string option = *text ? std::string("--poisson-ratio ") + text : "";
    const double radius = middle_radius(deform(edit, option));
    BOOST_TEST_MESSAGE("Poisson's ratio " << ratio << ": radius " << radius);
    BOOST_TEST(std::abs(radius - std::pow(1.5, -ratio)) < 0.05, option << ": " << radius);
    BOOST_TEST(report["material"]["poisson_ratio"] == ratio);
  }
}

BOOST_FIXTURE_TEST_CASE(a_stiffer_pillar_bends_more_evenly, Deform_run)
{
  // The head is pushed down: the pillar buckles, less so if it is stiff.
  const Json edit = edit_with_head(R"("translate": [1, 0, -2])");
  double before = 1e9;
  for (const char* stiffness : {"1", "10", "100"}) {
    const Table result =
        deform(edit, std::string("--iterations 200 --tolerance 1e-5 --stiffness ") + stiffness);
    double bulge = 0; // mean distance of the slices from the line between foot and head
    for (int status = 1; status < 9; ++status) {
      Vec3 c = Vec3::Zero();
      const std::vector<std::size_t> slice = with_status(result, status);
      for (const std::size_t i : slice)
        c += Vec3(result.points()[i].x(), result.points()[i].y(), result.points()[i].z()) /
             double(slice.size());
      bulge += std::abs(c.x() - axis.x() - (status - 0.5) / 8) / 8;
    }
    BOOST_TEST_MESSAGE("stiffness " << stiffness << ": bulge " << bulge);
    BOOST_TEST(bulge < before, stiffness << ": " << bulge);
    BOOST_TEST(report["material"]["stiffness"] == std::stod(stiffness));
    before = bulge;
  }
}

BOOST_FIXTURE_TEST_CASE(without_springs_a_twisted_pillar_becomes_thinner, Deform_run)
{
  const Json edit = edit_with_head(twist);
  const double kept = middle_radius(deform(edit));
  BOOST_TEST(report["interior_links"] > 0);
  BOOST_TEST(report["material"]["keeps_volume"] == true);
  const double thin = middle_radius(deform(edit, "--no-volume"));
  BOOST_TEST_MESSAGE("radius with springs " << kept << ", without " << thin);
  BOOST_TEST(report["interior_links"] == 0);
  BOOST_TEST(report["material"]["keeps_volume"] == false);
  BOOST_TEST(thin < kept - 0.01);
}

BOOST_FIXTURE_TEST_CASE(iterations_end_by_number_or_by_tolerance, Deform_run)
{
  const Json edit = edit_with_head(bend);
  deform(edit, "--iterations 0");
  BOOST_TEST(report["iterations"] == 0);
  deform(edit, "--iterations 2 --tolerance 0");
  BOOST_TEST(report["iterations"] == 2);
  BOOST_TEST(report["status"] == "iteration_limit");
  deform(edit, "--iterations 1000 --tolerance 1e-6");
  BOOST_TEST(report["status"] == "converged");
  const double least = report["energy"];
  const int iterations = report["iterations"];
  BOOST_TEST(iterations > 2);
  deform(edit, "--tolerance 0.5");
  BOOST_TEST(report["iterations"].get<int>() < iterations);
  BOOST_TEST(report["energy"].get<double>() > least);
}

BOOST_FIXTURE_TEST_CASE(published_variants_are_those_of_the_library, Deform_run)
{
  const auto np = pcs::parameters::number_of_samples(300);
  const auto weights = np.sample_weights(pcs::Sample_weights::inverse_square);
  const auto hops = np.sample_search(pcs::Sample_search::breadth_first_hops);
  const auto rotations = np.rotation_field(pcs::Rotation_field::quaternion);
  const auto all = weights.sample_search(pcs::Sample_search::breadth_first_hops)
                       .rotation_field(pcs::Rotation_field::quaternion);
  const std::vector<std::pair<std::string, Points>> variants = {
      {"", by_library(input, np)},
      {"--as-published weights", by_library(input, weights)},
      {"--as-published hops", by_library(input, hops)},
      {"--as-published rotations", by_library(input, rotations)},
      {"--as-published weights hops rotations", by_library(input, all)},
      {"--as-published", by_library(input, all)}};
  for (std::size_t k = 0; k < variants.size(); ++k) {
    const Table result = deform(edit_with_head(bend), "--samples 300 " + variants[k].first);
    BOOST_TEST(largest_distance(result.points(), variants[k].second) < 1e-9, variants[k].first);
    if (k > 0)
      BOOST_TEST(largest_distance(result.points(), variants[0].second) > 1e-3, variants[k].first);
  }
  BOOST_TEST(report["as_published"] == Json({"weights", "hops", "rotations"}));
}

BOOST_FIXTURE_TEST_CASE(published_rotations_do_not_see_full_turns, Deform_run)
{
  const Json edit = edit_with_head(R"("rotate": {"axis": [0, 0, 1], "degrees": 720})");
  const auto motion_of_middle = [&](const Table& result) {
    double largest = 0;
    for (const std::size_t i : with_status(input, 3))
      largest =
          std::max(largest, std::sqrt((result.points()[i] - input.points()[i]).squared_length()));
    return largest;
  };
  BOOST_TEST(motion_of_middle(deform(edit)) > 1.5);
  BOOST_TEST(err.find("full turns") == std::string::npos, err);
  BOOST_TEST(motion_of_middle(deform(edit, "--as-published rotations")) < 0.1);
  BOOST_TEST(err.find("loses full turns") != std::string::npos, err);
}

BOOST_FIXTURE_TEST_CASE(values_are_checked, Deform_run)
{
  write("edit.json", edit_with_head(bend).dump());
  write("out.ply", "an old file");
  const auto refuses = [&](const std::string& option, const std::string& words) {
    BOOST_TEST(run(arguments + " " + option) == 1, option);
    BOOST_TEST(err.find(words) != std::string::npos, option << ": " << err);
    BOOST_TEST(content("out.ply") == "an old file", option);
  };
  for (const char* bad : {"0.51", "-1.01", "nan", "much", "\"\""})
    refuses(std::string("--poisson-ratio ") + bad, "--poisson-ratio");
  refuses("--poisson-ratio 0.6", "expected a number from -1 to 0.5, found 0.6");
  for (const char* bad : {"0", "0.0009", "1001", "inf", "-1"})
    refuses(std::string("--stiffness ") + bad, "expected a number from 0.001 to 1000");
  for (const char* bad : {"-1", "1000001", "1.5", "99999999999999999999"})
    refuses(std::string("--iterations ") + bad, "--iterations");
  for (const char* bad : {"-0.1", "nan", "inf"})
    refuses(std::string("--tolerance ") + bad, "expected a number from 0 on");
  refuses("--as-published weight", "weight not in {weights,hops,rotations");
  refuses("--as-published weights hops rotations rotations", "--as-published");
  refuses("--no-volume 3", "3");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(region_option)

namespace {

const std::string upper_half = R"({"select": {"box": [[999, -22, 10.7], [1002, -19, 16]]}})";

} // namespace

BOOST_FIXTURE_TEST_CASE(points_outside_the_region_keep_every_bit, Deform_run)
{
  const Json edit = parse(
      R"({"handles": [{"select": {"property": "status", "equals": 9}, "translate": [1, 0, 0]}]})");
  write("region.json", upper_half);
  const Table whole = deform(edit);
  const Table result = deform(edit, "--region region.json");
  std::size_t number_of_inside_points = 0;
  double largest_motion = 0;
  for (std::size_t i = 0; i < number_of_pillar_points; ++i)
    if (input.points()[i].z() >= 10.7) {
      ++number_of_inside_points;
      largest_motion = std::max(largest_motion, result.points()[i].x() - input.points()[i].x());
    } else
      BOOST_REQUIRE(result.points()[i] == input.points()[i]);
  BOOST_TEST(largest_motion > 0.99);
  BOOST_TEST(report["points_of_region"] == number_of_inside_points);
  BOOST_TEST((whole.points()[500] != input.points()[500])); // without the region, the foot moves

  // the same bytes as a stream, and close to it if only a part of the points is kept
  const std::string bytes = content("out.ply");
  deform(edit, "--region region.json --stream --chunk-points 333");
  BOOST_TEST((content("out.ply") == bytes));
  BOOST_TEST(report["points_of_region"] == number_of_inside_points);
  const Table part = deform(edit, "--region region.json --stream --stream-points 1500");
  for (std::size_t i = 0; i < number_of_pillar_points; ++i)
    if (input.points()[i].z() < 10.7)
      BOOST_REQUIRE(part.points()[i] == input.points()[i]);
  BOOST_TEST(largest_distance(part.points(), result.points()) < 0.3);
}

BOOST_FIXTURE_TEST_CASE(a_region_is_checked, Deform_run)
{
  write("edit.json", edit_with_head(bend).dump());
  write("out.ply", "an old file");
  for (const char* mode : {"", " --stream", " --stream --stream-points 1000"}) {
    const auto refuses = [&](const std::string& region, const std::string& words) {
      write("region.json", region);
      BOOST_TEST(run(arguments + " --region region.json" + mode) == 1, region << mode);
      BOOST_TEST(err.find(words) != std::string::npos, region << mode << ": " << err);
      BOOST_TEST(content("out.ply") == "an old file", region);
    };
    refuses("", "region.json");
    refuses("{}", "region.json: top level: the key select is missing");
    refuses(R"({"select": {}})", "/select: expected exactly one of box, sphere");
    refuses(R"({"handles": []})", "region.json");
    refuses(R"({"select": {"property": "class", "equals": 2}})", "there is no property \"class\"");
    refuses(upper_half, "edit.json: /handles/0/select: point 0 is not in the --region");
    refuses(R"({"select": {"indices": [0, 2100]}})", "");
  }
  write("region.json", R"({"select": {"property": "status", "equals": 77}})");
  write("edit.json", R"({"handles": [{"select": {"indices": [2100]}, "fixed": true}]})");
  BOOST_TEST(run(arguments + " --region no.json") == 1);
  BOOST_TEST(err.find("no.json: cannot be opened") != std::string::npos, err);
  BOOST_TEST(run(arguments + " --region region.json --report region.json") == 1);
  BOOST_TEST(err.find("--report and --region are the same file") != std::string::npos, err);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_program_options
