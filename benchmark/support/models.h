// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the models of table 2.1 [Aiteanu 2022] from a folder, or replaces them by shapes of the
// same size.

#ifndef PCS_BENCHMARK_SUPPORT_MODELS_H
#define PCS_BENCHMARK_SUPPORT_MODELS_H

#include <pcs/IO/read_points.h>

#include <CGAL/Simple_cartesian.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcs_bench {

using Vec3 = Eigen::Vector3d;

struct Model
{
  std::vector<Vec3> points;
  bool is_generated = true;
};

/// A closed surface with bumps, a neck and a head, longest along y: `n` points on a spiral from
/// pole to pole.
inline std::vector<Vec3> make_bumpy_figure(std::size_t n)
{
  constexpr double pi = 3.14159265358979323846, golden_angle = 2.399963229728653;
  std::vector<Vec3> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double height = 1 - (2 * double(i) + 1) / double(n), angle = golden_angle * double(i);
    const double ring = std::sqrt(1 - height * height);
    const double neck = 1 - 0.5 * std::exp(-40 * (height - 0.45) * (height - 0.45));
    const double bump = 1 + 0.05 * ring * std::sin(7 * angle) * std::sin(3 * pi * height);
    const double r = neck * bump * ring;
    points[i] = Vec3(r * std::cos(angle), 1.6 * height, r * std::sin(angle));
  }
  return points;
}

/// Model "plain" [Aiteanu 2022]: a wavy square of `side * side` points with jitter.
inline std::vector<Vec3> make_plain(std::size_t side)
{
  constexpr double spacing = 0.001;
  std::mt19937_64 random(1);
  // Not std::uniform_real_distribution: its values differ between standard libraries.
  const auto jitter = [&] { return 0.6 * spacing * (double(random() >> 11) * 0x1p-53 - 0.5); };
  std::vector<Vec3> points;
  points.reserve(side * side);
  for (std::size_t i = 0; i < side; ++i)
    for (std::size_t j = 0; j < side; ++j) {
      const double x = spacing * double(i) + jitter(), y = spacing * double(j) + jitter();
      points.emplace_back(x, y, 0.02 * std::sin(0.02 * double(i)) * std::sin(0.02 * double(j)));
    }
  return points;
}

/// Folder of the files downloaded by ./run, empty if it does not exist.
inline std::string default_data_folder()
{
  return std::filesystem::is_directory("build/data") ? "build/data" : "";
}

/// `name` is bunny, armadillo, dragon or plain.
inline Model load_model(const std::string& name, const std::string& folder)
{
  struct Entry
  {
    const char *name, *file, *other_file; ///< of a manual download, and of ./run
    std::size_t size;
  };
  constexpr Entry entries[] = {
      {"bunny", "bunny_35947.ply", "bunny.ply", 35947},
      {"armadillo", "armadillo_172966_points.ply", "armadillo.ply", 172966},
      {"dragon", "dragon_437645.ply", "dragon.ply", 437645}};
  Model model;
  if (name == "plain") {
    model.points = make_plain(1000);
    return model;
  }
  for (const Entry& entry : entries) {
    if (name != entry.name)
      continue;
    std::filesystem::path path = std::filesystem::path(folder) / entry.file;
    if (!std::filesystem::exists(path))
      path = std::filesystem::path(folder) / entry.other_file;
    if (folder.empty() || !std::filesystem::exists(path)) {
      model.points = make_bumpy_figure(entry.size);
      return model;
    }
    std::vector<CGAL::Simple_cartesian<double>::Point_3> points;
    pcs::IO::read_points(path.string(), points);
    model.points.reserve(points.size());
    for (const auto& p : points)
      model.points.emplace_back(p.x(), p.y(), p.z());
    model.is_generated = false;
    return model;
  }
  throw std::invalid_argument("there is no model " + name);
}

/// The lowest and the highest points along y, as fractions of all points: the fixed and the moved
/// end.
struct Ends
{
  std::vector<std::uint32_t> low, high;
  Vec3 high_centroid = Vec3::Zero();

  Ends(const std::vector<Vec3>& points, double low_share, double high_share)
  {
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return points[a].y() != points[b].y() ? points[a].y() < points[b].y() : a < b;
    });
    const auto n = static_cast<double>(points.size());
    low.assign(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(low_share * n));
    high.assign(order.end() - static_cast<std::ptrdiff_t>(high_share * n), order.end());
    for (const auto i : high)
      high_centroid += points[i] / static_cast<double>(high.size());
  }
};

} // namespace pcs_bench

#endif // PCS_BENCHMARK_SUPPORT_MODELS_H
