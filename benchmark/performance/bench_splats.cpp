// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Seconds per frame while a scene of Gaussian splats is edited.

#include <pcs/Point_set_deformation.h>
#include <pcs/splats/transform_splats.h>
#include <support/Table.h>
#include <support/measuring.h>

#include <CGAL/number_type_config.h>
#include <CGAL/tags.h>

#include <boost/property_map/property_map.hpp>

#include <CLI/CLI.hpp>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace {

using pcs_bench::number;
using pcs_bench::Vec3;
using Gradients = std::vector<Eigen::Matrix3d>;

/// Accesses `(*values)[i]` for the point number `i`.
template <class Value>
struct Index_map
{
  using key_type = std::size_t;
  using value_type = Value;
  using reference = const Value&;
  using category = boost::read_write_property_map_tag;
  std::vector<Value>* values;
  friend const Value& get(const Index_map& map, std::size_t i) { return (*map.values)[i]; }
  friend void put(const Index_map& map, std::size_t i, const Value& v) { (*map.values)[i] = v; }
};

/// Splats by columns, as in files.
struct Scene
{
  std::vector<Vec3> points;
  std::vector<std::vector<float>> columns; // rotation, scales, colours

  pcs::splats::Splat_columns<float> splats()
  {
    pcs::splats::Splat_columns<float> result;
    for (std::size_t k = 0; k < 4; ++k)
      result.rotation[k] = columns[k].data();
    for (std::size_t k = 0; k < 3; ++k)
      result.log_scale[k] = columns[4 + k].data();
    for (std::size_t k = 7; k < columns.size(); ++k)
      result.harmonics.push_back(columns[k].data());
    return result;
  }
};

/// Splats on a pillar of radius 1 and height 10, from the foot to the head or in random order.
Scene make_scene(std::size_t n, int degree, bool is_shuffled)
{
  Scene scene;
  std::mt19937 engine(1);
  const auto draw = [&] {
    return static_cast<float>(static_cast<double>(engine()) / 2147483648.0 - 1);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.399963229728653 * double(i);
    scene.points.emplace_back(std::cos(angle), std::sin(angle), 10 * double(i) / double(n));
  }
  if (is_shuffled)
    std::shuffle(scene.points.begin(), scene.points.end(), engine);
  scene.columns.resize(7 + pcs::splats::number_of_rest_coefficients(degree));
  for (std::size_t k = 0; k < scene.columns.size(); ++k)
    for (std::size_t i = 0; i < n; ++i)
      scene.columns[k].push_back((k >= 4 && k < 7 ? -5 : 0) + draw());
  return scene;
}

struct Seconds
{
  pcs_bench::Timings construction, deformation, transformation, frame;
};

/// Turns the head by one degree more in each frame.
template <class ConcurrencyTag>
Seconds measure(const Scene& scene, int number_of_samples, int number_of_frames)
{
  Seconds seconds;
  Scene rest = scene, moved = scene;
  const std::size_t n = scene.points.size();
  Gradients gradients(n, Eigen::Matrix3d::Identity());
  std::vector<std::size_t> numbers(n), feet, head;
  std::iota(numbers.begin(), numbers.end(), std::size_t(0));
  for (const std::size_t i : numbers)
    if (scene.points[i].z() < 1 || scene.points[i].z() > 9)
      (scene.points[i].z() < 1 ? feet : head).push_back(i);
  const auto np = pcs::parameters::point_map(Index_map<Vec3>{&moved.points})
                      .gradient_map(Index_map<Eigen::Matrix3d>{&gradients})
                      .number_of_samples(number_of_samples);
  using Session =
      pcs::Point_set_deformation<std::vector<std::size_t>, decltype(np), ConcurrencyTag>;
  const pcs_bench::Timer construction;
  Session session(numbers, np);
  session.add_handle(feet);
  const auto handle = session.add_handle(head);
  session.preprocess();
  seconds.construction.add(construction.seconds());
  const pcs::splats::Splat_columns<const float> from = rest.splats();
  const pcs::splats::Splat_columns<float> to = moved.splats();
  for (int frame = 1; frame <= number_of_frames; ++frame) {
    session.set_rotation(handle, Vec3(1, 1, 1), frame * CGAL_PI / 180, Vec3(2, 0, 8));
    const pcs_bench::Timer whole;
    session.deform(pcs::Solver_start::warm);
    const double deformation = whole.seconds();
    const pcs_bench::Timer splats;
    pcs::splats::transform_splats<ConcurrencyTag, float>(gradients, from, to);
    const double transformation = splats.seconds(), total = whole.seconds();
    if (frame == 1) // also allocates memory
      continue;
    seconds.deformation.add(deformation);
    seconds.transformation.add(transformation);
    seconds.frame.add(total);
  }
  return seconds;
}

void add_row(pcs_bench::Table& table,
             const std::string& order,
             int degree,
             const std::string& threads,
             const Seconds& s)
{
  table.add({order,
             std::to_string(degree),
             threads,
             number(s.construction.best()),
             number(s.deformation.median()),
             number(s.transformation.median()),
             number(s.frame.median()),
             number(s.frame.best())});
}

} // namespace

int main(int argc, char** argv)
{
  std::size_t number_of_splats = 1000000;
  int number_of_samples = 2000, number_of_frames = 12;
  std::string csv;
  CLI::App app("Seconds per frame while a scene of Gaussian splats is edited.", "bench_splats");
  app.add_option("--splats", number_of_splats, "number of splats")->capture_default_str();
  app.add_option("--samples", number_of_samples, "samples of the deformation")
      ->capture_default_str();
  app.add_option("--frames", number_of_frames, "frames, at least 2")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  app.add_option("--csv", csv, "write the table here");
  CLI11_PARSE(app, argc, argv);

  pcs_bench::Table table({"order of the splats",
                          "degree",
                          "threads",
                          "construction [s]",
                          "deform() [s]",
                          "splats [s]",
                          "frame [s]",
                          "fastest frame [s]"});
  for (const bool is_shuffled : {false, true})
    for (const int degree : {0, 3}) {
      const Scene scene = make_scene(number_of_splats, degree, is_shuffled);
      const std::string order = is_shuffled ? "random" : "along the pillar";
      add_row(table,
              order,
              degree,
              "1",
              measure<CGAL::Sequential_tag>(scene, number_of_samples, number_of_frames));
      add_row(table,
              order,
              degree,
              "all",
              measure<CGAL::Parallel_if_available_tag>(scene, number_of_samples, number_of_frames));
    }
  table.print(std::cout);
  std::cout << "peak memory " << number(pcs_bench::peak_megabytes()) << " MB\n";
  if (!csv.empty())
    table.write_csv(csv);
  return 0;
}
