// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Nonrigid registration of pairs of clouds with known correspondences, and of a sequence, compared
// with rigid iterative closest points and coherent point drift.

#include <pcs/internal/Random_stream.h>
#include <pcs/registration/Fit_target.h>
#include <pcs/registration/Point_set_fitting.h>
#include <support/Table.h>
#include <support/measuring.h>
#include <support/models.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <iostream>
#include <quality/coherent_point_drift.h>
#include <random>
#include <string>
#include <vector>

namespace {

using pcs_bench::number;
using pcs_bench::Points;
using pcs_bench::Vec3;
using Tag = CGAL::Parallel_if_available_tag;
constexpr double degree = 3.14159265358979323846 / 180;

/// Bends about the z axis, by `angle` [rad] over the length `length` along y.
Vec3 bend(const Vec3& p, double angle, double length)
{
  if (angle == 0)
    return p;
  const double k = angle / length, r = 1 / k - p.x();
  return Vec3(1 / k - r * std::cos(k * p.y()), r * std::sin(k * p.y()), p.z());
}

/// Twists about the y axis, by `angle` [rad] over the length `length`.
Vec3 twist(const Vec3& p, double angle, double length)
{
  const double a = angle * p.y() / length, c = std::cos(a), s = std::sin(a);
  return Vec3(c * p.x() + s * p.z(), p.y(), c * p.z() - s * p.x());
}

/// Adds waves that change the shape: swellings and dents.
Vec3 swell(const Vec3& p, double amount)
{
  return p + amount * Vec3(std::sin(5 * p.y() + 1) + std::sin(7 * p.z()),
                           std::sin(6 * p.x() + 2) + std::sin(4 * p.z() + 1),
                           std::sin(6 * p.y()) + std::sin(5 * p.x()));
}

struct Case
{
  std::string name, model;
  std::function<Vec3(const Vec3&)> motion;
  double kept = 1;          ///< fraction of the target along a direction [-]
  double noise = 0;         ///< standard deviation [extents]
  double outliers = 0;      ///< relative to the target points [-]
  double target_share = .5; ///< of the points of the model; the source has another half
};

std::vector<Case> make_cases()
{
  const double length = 0.6; // of the Armadillo, in extents
  const auto bent = [=](double angle) {
    return [=](const Vec3& p) { return bend(p, angle * degree, length); };
  };
  const auto twisted = [=](double angle) {
    return [=](const Vec3& p) { return twist(p, angle * degree, length); };
  };
  const std::string a = "armadillo", b = "bunny";
  return {{"bend 40", a, bent(40)},
          {"bend 60", a, bent(60)},
          {"twist 60", a, twisted(60)},
          {"swell", b, [](const Vec3& p) { return swell(p, 0.03); }},
          {"60 % of the target", a, bent(40), 0.6},
          {"noise 0.3 %", a, bent(40), 1, 0.003},
          {"5 % outliers", a, bent(40), 1, 0, 0.05},
          {"a tenth of the points", a, bent(40), 1, 0, 0, 0.05},
          {"all of these",
           a,
           [=](const Vec3& p) { return swell(bend(p, 40 * degree, length), 0.01); },
           0.6,
           0.002,
           0.05,
           0.15},
          {"bend 120", a, bent(120)},
          {"twist 120", a, twisted(120)}};
}

struct Pair
{
  Points source, truth, target;
};

/// Reads at most 43,242 points of a model, with extent 1 and its foot at the origin.
Points read_model(const std::string& folder, const std::string& name)
{
  constexpr std::size_t most_points = 43242; // a quarter of the Armadillo
  const Points all = pcs_bench::load_model(name, folder).points;
  const std::size_t step = std::max<std::size_t>(1, all.size() / most_points);
  Points points;
  for (std::size_t i = 0; i < all.size(); i += step)
    points.push_back(all[i]);
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3 foot(0.5 * (low.x() + high.x()), low.y(), 0.5 * (low.z() + high.z()));
  for (Vec3& p : points)
    p = (p - foot) / (high - low).norm();
  return points;
}

/// A number in [0, 1).
double uniform(std::mt19937_64& random)
{
  return double(random() >> 11) * 0x1p-53;
}

/// Approximately a normal deviate: the sum of twelve uniform ones.
double deviate(std::mt19937_64& random)
{
  double sum = -6;
  for (int k = 0; k < 12; ++k)
    sum += uniform(random);
  return sum;
}

void add_outliers(double share, std::mt19937_64& random, Points& target)
{
  Vec3 low = target.front(), high = low;
  for (const Vec3& p : target) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const auto count = static_cast<std::size_t>(share * double(target.size()));
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 u(uniform(random), uniform(random), uniform(random));
    target.push_back(low + (high - low).cwiseProduct(u));
  }
}

/// Splits a model into a source and a target without common points.
Pair split_model(const Case& c, const Points& model)
{
  std::mt19937_64 random(1);
  Pair pair;
  Points others;
  for (const Vec3& p : model) {
    const double u = uniform(random);
    if (u < 0.5) {
      pair.source.push_back(p);
      pair.truth.push_back(c.motion(p));
    } else if (u < 0.5 + c.target_share)
      others.push_back(p);
  }
  const auto height = [](const Vec3& p) { return p.y() + 0.5 * p.x(); };
  std::sort(others.begin(), others.end(), [&](const Vec3& p, const Vec3& q) {
    return height(p) < height(q);
  });
  others.resize(static_cast<std::size_t>(c.kept * double(others.size())));
  for (const Vec3& p : others) {
    const Vec3 e(deviate(random), deviate(random), deviate(random));
    pair.target.push_back(c.motion(p) + c.noise * e);
  }
  add_outliers(c.outliers, random, pair.target);
  return pair;
}

/// RMS distance from the truth in percent of the extent, which is 1.
double percent(const Points& a, const Points& b)
{
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += (a[i] - b[i]).squaredNorm();
  return 100 * std::sqrt(sum / double(a.size()));
}

Points subset(const Points& points, std::size_t count)
{
  Points result;
  for (const auto i : pcs::registration::spread_points<Tag>(points, count))
    result.push_back(points[i]);
  return result;
}

struct Options
{
  std::string data = pcs_bench::default_data_folder(), only, csv;
  std::size_t drift_points = 1000;
};

void add_pair(const Case& c, const Options& options, pcs_bench::Table& table)
{
  const Pair pair = split_model(c, read_model(options.data, c.model));
  const pcs_bench::Timer icp_timer;
  const double icp = percent(pcs_bench::rigid_icp(pair.source, pair.target, 0.8), pair.truth);
  const double icp_seconds = icp_timer.seconds();
  const pcs_bench::Timer drift_timer;
  const double drift =
      percent(pcs_bench::coherent_point_drift(pair.source,
                                              subset(pair.source, options.drift_points),
                                              subset(pair.target, options.drift_points),
                                              0.1),
              pair.truth);
  const double drift_seconds = drift_timer.seconds();
  Points fitted = pair.source;
  const pcs_bench::Timer timer;
  pcs::Point_set_fitting<Points> session(fitted);
  const pcs::Fit_report report = session.fit(pair.target);
  const double seconds = timer.seconds();
  table.add({c.name,
             std::to_string(pair.source.size()),
             std::to_string(pair.target.size()),
             number(percent(pair.source, pair.truth)),
             number(icp),
             number(drift),
             number(percent(fitted, pair.truth)),
             number(100 * report.matched_share()),
             number(icp_seconds),
             number(drift_seconds),
             number(seconds)});
}

/// Tracks the model over 20 frames that bend and twist it, each with another half of its points,
/// from the last shape or from scratch.
void print_sequence(const Options& options)
{
  const Points model = read_model(options.data, "armadillo");
  std::mt19937_64 random(2);
  Points rest;
  for (const Vec3& p : model)
    if (uniform(random) < 0.3)
      rest.push_back(p);
  const auto motion = [](const Vec3& p, int frame) {
    return bend(twist(p, 3 * frame * degree, 0.6), 3 * frame * degree, 0.6);
  };
  Points tracked = rest, single = rest;
  pcs::Point_set_fitting<Points> tracker(tracked), cold(single);
  pcs_bench::Table table({"frame", "tracked, %", "from rest, %", "s tracked", "s from rest"});
  for (int frame = 1; frame <= 20; ++frame) {
    Points target, truth;
    for (const Vec3& p : model)
      if (uniform(random) < 0.3)
        target.push_back(motion(p, frame));
    for (const Vec3& p : rest)
      truth.push_back(motion(p, frame));
    const pcs_bench::Timer timer;
    tracker.fit(target, pcs::parameters::default_values(), pcs::Solver_start::warm);
    const double seconds = timer.seconds();
    const bool is_printed = frame == 1 || frame % 5 == 0;
    if (!is_printed)
      continue;
    const pcs_bench::Timer cold_timer;
    cold.fit(target);
    table.add({std::to_string(frame),
               number(percent(tracked, truth)),
               number(percent(single, truth)),
               number(seconds),
               number(cold_timer.seconds())});
  }
  table.print(std::cout);
}

void run(const Options& options)
{
  pcs_bench::Table table({"case",
                          "source",
                          "target",
                          "before, %",
                          "rigid ICP, %",
                          "CPD, %",
                          "pcs, %",
                          "matched, %",
                          "s ICP",
                          "s CPD",
                          "s pcs"});
  for (const Case& c : make_cases())
    if (options.only.empty() || c.name.find(options.only) != std::string::npos) {
      std::cerr << c.name << std::endl;
      add_pair(c, options, table);
    }
  table.print(std::cout);
  if (!options.csv.empty())
    table.write_csv(options.csv);
  if (options.only.empty() || options.only == "sequence") {
    std::cout << '\n';
    print_sequence(options);
  }
}

} // namespace

int main(int argc, char** argv)
{
  Options options;
  CLI::App app("Nonrigid registration of clouds with known correspondences. Distances are RMS "
               "distances from the truth, in percent of the extent.");
  app.add_option("--data",
                 options.data,
                 "folder with armadillo_172966_points.ply and bunny_35947.ply");
  app.add_option("--only", options.only, "run the cases whose name contains this, or `sequence`");
  app.add_option("--drift-points", options.drift_points, "points of each cloud for CPD [count]");
  app.add_option("--csv", options.csv, "also write the table of pairs to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
  } catch (const std::exception& error) {
    std::cerr << "bench_fit_point_set: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
