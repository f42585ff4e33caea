// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program deform_point_set with files of Gaussian splats.

#include <support/splats.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <examples/Program_run.h>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace test_program_splats {

namespace {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// A file of splats as trainers write it: properties of type float in the usual order, followed by
/// an integer of another tool.
struct Splat_file
{
  int degree = 3;
  std::size_t n = 1500;
  std::vector<std::string> names;
  std::vector<std::vector<float>> values; // by property

  explicit Splat_file(int degree_of_colors = 3) : degree(degree_of_colors)
  {
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"})
      names.push_back(name);
    for (int k = 0; k < 3 * ((degree + 1) * (degree + 1) - 1); ++k)
      names.push_back("f_rest_" + std::to_string(k));
    names.push_back("opacity");
    for (int k = 0; k < 3; ++k)
      names.push_back("scale_" + std::to_string(k));
    for (int k = 0; k < 4; ++k)
      names.push_back("rot_" + std::to_string(k));
    values.resize(names.size());
    pcs_test::Splat_drawer draw(1);
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2.399963229728653 * double(i);
      const double height = 10 * double(i) / double(n);
      for (std::size_t k = 0; k < names.size(); ++k)
        values[k].push_back(float(draw.number()));
      at("x", i) = float(std::cos(angle));
      at("y", i) = float(std::sin(angle));
      at("z", i) = float(height);
      for (const char* normal : {"nx", "ny", "nz"})
        at(normal, i) = 0;
      for (int k = 0; k < 3; ++k)
        at("scale_" + std::to_string(k), i) -= 3;
    }
  }

  std::size_t index(const std::string& name) const
  {
    const auto found = std::find(names.begin(), names.end(), name);
    BOOST_TEST_REQUIRE((found != names.end()), name);
    return std::size_t(found - names.begin());
  }
  float& at(const std::string& name, std::size_t i) { return values[index(name)][i]; }
  float at(const std::string& name, std::size_t i) const { return values[index(name)][i]; }

  void remove(const std::string& name)
  {
    const std::size_t k = index(name);
    names.erase(names.begin() + std::ptrdiff_t(k));
    values.erase(values.begin() + std::ptrdiff_t(k));
  }

  /// The bytes of the file.
  std::string bytes() const
  {
    std::string text =
        "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(n) + "\n";
    for (const std::string& name : names)
      text += "property float " + name + "\n";
    text += "property uint id\nend_header\n";
    for (std::size_t i = 0; i < n; ++i) {
      for (const auto& column : values)
        text.append(reinterpret_cast<const char*>(&column[i]), sizeof(float));
      const auto id = std::uint32_t(7 * i);
      text.append(reinterpret_cast<const char*>(&id), sizeof(id));
    }
    return text;
  }

  /// The same file with the values of a result.
  Splat_file with(const Table& table, bool is_splats) const
  {
    Splat_file result = *this;
    BOOST_TEST_REQUIRE(table.number_of_points() == n);
    BOOST_TEST_REQUIRE(table.schema().properties.size() == names.size() + 1);
    for (std::size_t k = 0; k < names.size(); ++k) {
      BOOST_TEST(table.schema().properties[k].name == names[k]);
      const std::string type = k < 3 && !is_splats ? "float64" : "float32";
      BOOST_TEST(name_of(table.schema().properties[k].type) == type);
      for (std::size_t i = 0; i < n; ++i)
        result.values[k][i] =
            k < 3 ? float(table.points()[i][int(k)]) : table.property<float>(names[k])[i];
    }
    for (std::size_t i = 0; i < n; ++i)
      BOOST_TEST(table.property<std::uint32_t>("id")[i] == 7 * i);
    return result;
  }

  Vec3 position(std::size_t i) const { return {at("x", i), at("y", i), at("z", i)}; }

  Mat3 covariance(std::size_t i) const
  {
    const Eigen::Quaterniond q(at("rot_0", i), at("rot_1", i), at("rot_2", i), at("rot_3", i));
    const Mat3 r = q.normalized().toRotationMatrix();
    Vec3 squares = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (std::find(names.begin(), names.end(), "scale_" + std::to_string(k)) != names.end())
        squares[k] = std::exp(2 * double(at("scale_" + std::to_string(k), i)));
    return r * squares.asDiagonal() * r.transpose();
  }

  /// The colour of a channel in a direction, without the constant.
  double color(std::size_t i, int channel, const Vec3& direction) const
  {
    const int count = (degree + 1) * (degree + 1) - 1;
    std::vector<float> coefficients;
    for (int k = 0; k < count; ++k)
      coefficients.push_back(at("f_rest_" + std::to_string(channel * count + k), i));
    return pcs_test::color(degree, coefficients.data(), direction);
  }
};

/// Holds the lowest tenth, and turns the highest tenth about an axis through (2, 0, 10).
const std::string bend = R"({"handles": [
  {"select": {"box": [[-2, -2, -1], [2, 2, 1]]}, "fixed": true},
  {"select": {"box": [[-2, -2, 9], [2, 2, 11]]},
   "rotate": {"axis": [1, 3, 2], "degrees": 70, "center": [2, 0, 10]}}]})";

Mat3 turn_of_bend()
{
  return Eigen::AngleAxisd(70 * std::acos(-1.0) / 180, Vec3(1, 3, 2).normalized())
      .toRotationMatrix();
}

/// Runs an edit on a file of splats. Returns the result.
Splat_file deform_splats(Deform_run& run,
                         const Splat_file& file,
                         const std::string& edit,
                         const std::string& more = "")
{
  run.write("in.ply", file.bytes());
  const Table table = run.deform(parse(edit), more);
  return file.with(table, run.report["splats"] == "deformed");
}

void refuses(Deform_run& run, const Splat_file& file, const std::string& message)
{
  run.write("in.ply", file.bytes());
  run.write("edit.json", bend);
  for (const char* more : {"", " --stream"}) {
    BOOST_TEST(run.run("--input in.ply --edit edit.json --output out.ply" + std::string(more)) ==
               1);
    BOOST_TEST(run.err.find(message) != std::string::npos, run.err);
    BOOST_TEST(run.err.find("in.ply") != std::string::npos, run.err);
    BOOST_TEST(!run.exists("out.ply"));
  }
}

} // namespace

BOOST_AUTO_TEST_SUITE(splats)

BOOST_FIXTURE_TEST_CASE(shapes_and_colors_follow_the_handles, Deform_run)
{
  const Mat3 r = turn_of_bend();
  const Vec3 center(2, 0, 10), d = Vec3(1, -2, 2) / 3;
  for (int degree = 0; degree <= 4; ++degree) {
    const Splat_file file(degree);
    const Splat_file result = deform_splats(*this, file, bend);
    std::size_t turned = 0, changed = 0;
    for (std::size_t i = 0; i < file.n; ++i) {
      const double z = file.at("z", i);
      for (const char* name : {"f_dc_0", "f_dc_1", "f_dc_2", "opacity", "nx", "ny", "nz"})
        BOOST_TEST(result.at(name, i) == file.at(name, i));
      if (z <= 1) // fixed: the same bits
        for (std::size_t k = 0; k < file.names.size(); ++k)
          BOOST_TEST(result.values[k][i] == file.values[k][i]);
      else if (z >= 9) {
        ++turned;
        BOOST_TEST((result.position(i) - (r * (file.position(i) - center) + center)).norm() < 2e-6);
        const Mat3 expected = r * file.covariance(i) * r.transpose();
        BOOST_TEST((result.covariance(i) - expected).norm() < 1e-6 * expected.norm());
        for (int channel = 0; channel < 3; ++channel)
          BOOST_TEST(std::abs(result.color(i, channel, r * d) - file.color(i, channel, d)) < 2e-6);
      } else if (result.at("rot_1", i) != file.at("rot_1", i))
        ++changed;
    }
    BOOST_TEST(turned > 100u);
    BOOST_TEST(changed > 1100u);
    BOOST_TEST(report["splats"] == "deformed");
    BOOST_TEST(report["splat_degree"] == degree);
    BOOST_TEST(report["invalid_splats"] == 0);
    BOOST_TEST(report["warnings"].empty());
    BOOST_TEST(out.find("splats      of degree " + std::to_string(degree)) != std::string::npos,
               out);
  }
}

BOOST_FIXTURE_TEST_CASE(between_the_handles_splats_turn_gradually, Deform_run)
{
  const Splat_file file;
  const Splat_file result = deform_splats(*this, file, bend);
  double last = 0;
  for (const double height : {2.0, 5.0, 8.0}) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < file.n; ++i)
      if (std::abs(file.at("z", i) - height) < 0.5) {
        // The angle between the quaternions: the scales of the splats differ.
        Eigen::Vector4d a, b;
        for (int k = 0; k < 4; ++k) {
          a[k] = file.at("rot_" + std::to_string(k), i);
          b[k] = result.at("rot_" + std::to_string(k), i);
        }
        BOOST_TEST(std::abs(a.norm() - b.norm()) < 1e-6);
        sum += 2 * std::acos(std::min(1.0, std::abs(a.normalized().dot(b.normalized()))));
        ++count;
      }
    BOOST_TEST(sum / count > last + 0.1);
    last = sum / count;
  }
  BOOST_TEST(last < 1.3);
}

BOOST_FIXTURE_TEST_CASE(without_motion_the_output_has_the_same_bytes, Deform_run)
{
  Splat_file file;
  file.at("x", 700) = 0; // rounding would change these coordinates
  file.at("y", 800) = 1e-20f;
  file.at("z", 900) = -0.0f;
  write("in.ply", file.bytes());
  for (const char* motion : {R"("fixed": true)", R"("translate": [0, 0, 0])"})
    for (const char* more : {"", " --samples 300", " --stream", " --stream --stream-points 700"}) {
      write("edit.json",
            std::string(R"({"handles": [
  {"select": {"box": [[-2, -2, -1], [2, 2, 1]]}, "fixed": true},
  {"select": {"box": [[-2, -2, 9], [2, 2, 11]]}, )") +
                motion + "}]}");
      BOOST_TEST_REQUIRE(
          run(std::string("--input in.ply --edit edit.json --output out.ply") + more) == 0,
          err);
      BOOST_TEST((content("out.ply") == content("in.ply")), motion << more);
    }
}

BOOST_FIXTURE_TEST_CASE(a_stream_gives_the_same_file, Deform_run)
{
  const Splat_file file;
  const std::string arguments = "--input in.ply --edit edit.json --quiet --output ";
  write("in.ply", file.bytes());
  write("edit.json", bend);
  BOOST_TEST_REQUIRE(run(arguments + "memory.ply") == 0, err);
  for (const char* chunk : {"", " --chunk-points 1", " --chunk-points 777"}) {
    BOOST_TEST_REQUIRE(run(arguments + "out.ply --stream" + chunk) == 0, err);
    BOOST_TEST((content("out.ply") == content("memory.ply")), chunk);
  }
  // With fewer kept points, handles move exactly and the others follow.
  const Splat_file result = deform_splats(*this, file, bend, "--stream --stream-points 700");
  const Mat3 r = turn_of_bend();
  double worst = 0;
  for (std::size_t i = 0; i < file.n; ++i)
    if (file.at("z", i) >= 9) {
      const Mat3 expected = r * file.covariance(i) * r.transpose();
      worst = std::max(worst, (result.covariance(i) - expected).norm() / expected.norm());
    } else if (file.at("z", i) > 2)
      BOOST_TEST(result.at("f_rest_0", i) != file.at("f_rest_0", i));
  BOOST_TEST(worst < 1e-6);
  BOOST_TEST(report["splats"] == "deformed");
}

BOOST_FIXTURE_TEST_CASE(flat_splats_have_two_scales, Deform_run)
{
  Splat_file file(1);
  file.remove("scale_2");
  const Splat_file result = deform_splats(*this, file, bend);
  BOOST_TEST(report["splats"] == "deformed");
  const Mat3 r = turn_of_bend();
  for (std::size_t i = 0; i < file.n; ++i)
    if (file.at("z", i) >= 9) {
      const Mat3 expected = r * file.covariance(i) * r.transpose();
      BOOST_TEST((result.covariance(i) - expected).norm() < 1e-6 * expected.norm());
    }
}

BOOST_FIXTURE_TEST_CASE(malformed_colors_are_refused, Deform_run)
{
  Splat_file fewer;
  fewer.remove("f_rest_44");
  refuses(*this, fewer, "0, 9, 24, 45 or 72 for the degrees 0 to 4; there are 44");
  Splat_file gap;
  gap.names[gap.index("f_rest_7")] = "f_rest_45";
  refuses(*this, gap, "there is no property f_rest_7");
  Splat_file more(4);
  for (int k = 72; k < 105; ++k) {
    more.names.push_back("f_rest_" + std::to_string(k));
    more.values.push_back(more.values.back());
  }
  refuses(*this, more, "there are 105");
}

BOOST_FIXTURE_TEST_CASE(properties_of_other_types_are_refused, Deform_run)
{
  const Splat_file file(1);
  write("in.ply", file.bytes());
  Table table = pcs::IO::read_points(path("in.ply"));
  table.replace_property("scale_1", std::vector<std::int16_t>(file.n, 1));
  pcs::IO::write_points(path("in.ply"), table);
  write("edit.json", bend);
  BOOST_TEST(run("--input in.ply --edit edit.json --output out.ply") == 1);
  BOOST_TEST(err.find("must all be float or all be double") != std::string::npos, err);
  BOOST_TEST(err.find("'scale_1' is of type int16") != std::string::npos, err);
}

BOOST_FIXTURE_TEST_CASE(points_with_a_part_of_the_properties_are_points, Deform_run)
{
  Splat_file file(1);
  file.remove("rot_3");
  const Splat_file result = deform_splats(*this, file, bend);
  BOOST_TEST(report["splats"] == "none");
  BOOST_TEST(!report.contains("splat_degree"));
  BOOST_TEST(err.find("no property rot_3") != std::string::npos, err);
  BOOST_TEST((result.position(1490) - file.position(1490)).norm() > 0.5);
  for (std::size_t k = 3; k < file.names.size(); ++k)
    BOOST_TEST((result.values[k] == file.values[k]), file.names[k]);
}

BOOST_FIXTURE_TEST_CASE(invalid_splats_are_counted_and_kept, Deform_run)
{
  Splat_file file(1);
  file.at("rot_2", 1490) = std::numeric_limits<float>::quiet_NaN();
  file.at("scale_0", 1480) = std::numeric_limits<float>::infinity();
  for (int k = 0; k < 4; ++k) // the identity
    file.at("rot_" + std::to_string(k), 1470) = 0;
  for (const char* more : {"", "--stream --stream-points 700"}) {
    const Splat_file result = deform_splats(*this, file, bend, more);
    BOOST_TEST(report["invalid_splats"] == 2);
    BOOST_TEST(err.find("2 splats have rotations or scales that are not finite") !=
                   std::string::npos,
               err);
    for (const std::size_t i : std::initializer_list<std::size_t>{1490, 1480})
      for (const char* name : {"scale_1", "rot_0", "f_rest_3"})
        BOOST_TEST(result.at(name, i) == file.at(name, i));
    const Eigen::Quaterniond q(turn_of_bend());
    BOOST_TEST(std::abs(result.at("rot_0", 1470) - q.w()) < 1e-6);
    BOOST_TEST(std::abs(result.at("rot_2", 1470) - q.y()) < 1e-6);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_program_splats
