// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the times of all stages of the deformation with the published ones [Aiteanu 2022, table
// 2.1]. Also measures ratios to reference computations and the peak memory.

#include <pcs/Point_set_deformation.h>
#include <support/Table.h>
#include <support/measuring.h>
#include <support/models.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <type_traits>
#include <unistd.h>
#include <utility>
#include <vector>

namespace {

using pcs_bench::number;
using pcs_bench::Vec3;
using Kernel = CGAL::Simple_cartesian<double>;
using Point_with_normal = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using Point_map = CGAL::First_of_pair_property_map<Point_with_normal>;
using Normal_map = CGAL::Second_of_pair_property_map<Point_with_normal>;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Row of the table; `samples` 0 means "no sampling".
struct Row
{
  const char* model;
  std::size_t samples;
  bool do_preserve_volume;
  double text_sampling, text_precomputation, text_solving, text_upsampling; ///< published [s]
};

constexpr Row rows[] = {{"bunny", 100, true, 4.0, .1, .001, .003},
                        {"bunny", 1000, true, .5, 2.0, .019, .004},
                        {"armadillo", 200, true, 101.3, .1, .002, .016},
                        {"armadillo", 5000, true, 3.2, 18.3, .098, .018},
                        {"dragon", 200, true, 390.2, .1, .002, .037},
                        {"dragon", 5000, true, 13.7, 23.3, .116, .040},
                        {"plain", 200, true, 1923.0, .1, .002, .083},
                        {"plain", 1000, true, none, none, none, none},
                        {"dragon", 0, false, none, none, none, none},
                        {"dragon", 0, true, none, none, none, none}};

struct Time
{
  double best = none, median = none;
  Time() = default;
  Time(const pcs_bench::Timings& t) : best(t.best()), median(t.median()) {}
};

/// Values that the process of one row returns.
struct Measured
{
  bool is_generated = true;
  std::size_t points = 0, samples = 0, links = 0, iterations = 0;
  Time neighbors, sampling, construction, factorization, solving, pass, upsampling, frame, drag;
  Time knn, triad, triad_of_vectors;
  double input_megabytes = none, peak_megabytes = none;
};
static_assert(std::is_trivially_copyable_v<Measured>);

std::vector<Point_with_normal> with_normals(const std::vector<Vec3>& points)
{
  Vec3 center = Vec3::Zero();
  for (const Vec3& p : points)
    center += p / static_cast<double>(points.size());
  std::vector<Point_with_normal> result;
  result.reserve(points.size());
  for (const Vec3& p : points) { // arbitrary vectors: the time does not depend on them
    const Vec3 n = (p - center + Vec3(0, 0, 1e-3)).normalized();
    result.emplace_back(Kernel::Point_3(p.x(), p.y(), p.z()),
                        Kernel::Vector_3(n.x(), n.y(), n.z()));
  }
  return result;
}

template <class ConcurrencyTag>
Measured measure(const Row& row, const std::string& folder, int repetitions)
{
  Measured m;
  const pcs_bench::Model model = pcs_bench::load_model(row.model, folder);
  const pcs_bench::Ends ends(model.points, 0.05, 0.08);
  const std::vector<Point_with_normal> rest = with_normals(model.points);
  std::vector<Point_with_normal> points = rest;
  m.is_generated = model.is_generated;
  m.points = points.size();
  m.input_megabytes = pcs_bench::peak_megabytes();

  const bool is_flat = std::string(row.model) == "plain";
  const Kernel::Vector_3 axis = is_flat ? Kernel::Vector_3(1, 0, 0) : Kernel::Vector_3(0, 0, 1);
  const Vec3 extent = ends.high_centroid - model.points[ends.low.front()];
  const double pi = 3.14159265358979323846;
  const auto np = pcs::parameters::point_map(Point_map())
                      .normal_map(Normal_map())
                      .number_of_samples(row.samples == 0 ? points.size() : row.samples)
                      .do_preserve_volume(row.do_preserve_volume);
  using Session =
      pcs::Point_set_deformation<std::vector<Point_with_normal>, decltype(np), ConcurrencyTag>;

  pcs_bench::Timings neighbors, sampling, construction, factorization, solving, pass, upsampling,
      frame, drag;
  // Without sampling, one drag takes seconds.
  const int number_of_constructions = row.samples == 0 ? 1 : repetitions;
  const int number_of_factorizations = row.samples == 0 ? 1 : 3;
  const int number_of_drags = row.samples == 0 ? 2 : 4;
  for (int r = 0; r < number_of_constructions; ++r) {
    points = rest;
    const pcs_bench::Timer timer;
    Session session(points, np);
    construction.add(timer.seconds());
    session.add_handle(ends.low);
    auto handle = session.add_handle(ends.high);
    for (int again = 0; again < number_of_factorizations; ++again) {
      session.set_rotation(handle, axis, pi / 3);
      session.set_translation(handle, Kernel::Vector_3(0.1 * extent.norm(), 0, 0));
      for (int repeat = 0; repeat < number_of_drags; ++repeat) {
        const pcs_bench::Timer frame_timer;
        const pcs::Deformation_report report = session.deform();
        const double frame_seconds = frame_timer.seconds();
        if (report.status != pcs::Status::converged &&
            report.status != pcs::Status::iteration_limit)
          throw std::runtime_error(std::string(row.model) + ": " + to_string(report.status));
        m.samples = report.number_of_samples;
        m.links = report.number_of_interior_links;
        m.iterations = report.number_of_iterations;
        if (again == 0 && repeat == 0) {
          neighbors.add(report.seconds.neighbors);
          sampling.add(report.seconds.sampling);
        }
        if (repeat == 0)
          factorization.add(report.seconds.factorization);
        else
          frame.add(frame_seconds); // without factorization
        solving.add(report.seconds.solving);
        // The first positions are computed before any pass and cost as much as a pass.
        pass.add((report.seconds.solving - report.seconds.coarse_levels) /
                 static_cast<double>(report.number_of_iterations + 1));
        upsampling.add(report.seconds.upsampling);
      }
      // Frames of a drag by one degree each, each starting from the previous result.
      constexpr int number_of_frames = 4;
      for (int step = 1; step <= number_of_frames; ++step) {
        session.set_rotation(handle, axis, pi / 3 + step * pi / 180);
        const pcs_bench::Timer frame_timer;
        session.deform(pcs::Solver_start::warm);
        drag.add(frame_timer.seconds());
      }
      session.remove_handle(handle);
      handle = session.add_handle(ends.high);
    }
    if (r == 0)
      m.peak_megabytes = pcs_bench::peak_megabytes();
  }
  m.neighbors = neighbors;
  m.sampling = sampling;
  m.construction = construction;
  m.factorization = factorization;
  m.solving = solving;
  m.pass = pass;
  m.upsampling = upsampling;
  m.frame = frame;
  m.drag = drag;
  // The point itself is one of the seven neighbours.
  m.knn = pcs_bench::repeat(repetitions, [&] { pcs_bench::query_neighbors(model.points, 7); });
  for (const bool has_links : {true, false}) {
    pcs_bench::Triad triad(points.size(), has_links);
    (has_links ? m.triad : m.triad_of_vectors) =
        pcs_bench::repeat(5 * repetitions, [&] { triad(); });
  }
  return m;
}

/// Time limit of a row; an exceeded limit is a result, not a failure of the program.
struct Time_limit_exceeded : std::runtime_error
{
  using std::runtime_error::runtime_error;
};

std::string label(const Row& row)
{
  const std::string samples = row.samples == 0 ? "without sampling" : std::to_string(row.samples);
  return std::string(row.model) + ", " + samples +
         (row.do_preserve_volume ? "" : ", without interior links");
}

/// Runs `measure()` in a separate process, so that the peak memory is that of this row.
Measured measure_apart(const Row& row,
                       bool is_parallel,
                       const std::string& folder,
                       int repetitions,
                       unsigned time_limit)
{
  int ends[2];
  if (pipe(ends) != 0)
    throw std::runtime_error("no pipe");
  std::cout.flush();
  const pid_t child = fork();
  if (child < 0)
    throw std::runtime_error("no child process");
  if (child == 0) {
    alarm(time_limit);
    int status = 1;
    try {
      const Measured m = is_parallel
                             ? measure<CGAL::Parallel_if_available_tag>(row, folder, repetitions)
                             : measure<CGAL::Sequential_tag>(row, folder, repetitions);
      status = write(ends[1], &m, sizeof m) == ssize_t(sizeof m) ? 0 : 1;
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s\n", e.what());
    }
    _exit(status);
  }
  close(ends[1]);
  Measured m;
  const ssize_t received = read(ends[0], &m, sizeof m);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    throw Time_limit_exceeded(label(row) + ": longer than " + std::to_string(time_limit) + " s");
  if (received != ssize_t(sizeof m) || status != 0)
    throw std::runtime_error(label(row) + ": failed");
  return m;
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Compares the times of all stages of the deformation with the published ones "
               "[Aiteanu 2022, table 2.1].");
  std::string folder = pcs_bench::default_data_folder(), csv;
  std::vector<std::string> only;
  int repetitions = 3;
  unsigned time_limit = 120;
  app.add_option("--data",
                 folder,
                 "folder with the scans (default: build/data); those missing are generated")
      ->check(CLI::ExistingDirectory);
  app.add_option("--only", only, "only rows of these models")
      ->check(CLI::IsMember({"bunny", "armadillo", "dragon", "plain"}));
  app.add_option("--csv", csv, "write all values to this file");
  app.add_option("--repetitions", repetitions, "constructions of each row; the best time is listed")
      ->check(CLI::Range(1, 1000));
  app.add_option("--limit", time_limit,
                 "time limit of a row [s]"); // passed by ./run bench
  CLI11_PARSE(app, argc, argv);

  pcs_bench::Table seconds({"model",
                            "points",
                            "samples",
                            "threads",
                            "sampling 2022",
                            "pcs",
                            "precomputation 2022",
                            "pcs",
                            "solving, one pass 2022",
                            "pcs, pass",
                            "pcs, all",
                            "upsampling 2022",
                            "pcs"});
  pcs_bench::Table ratios({"model",
                           "samples",
                           "threads",
                           "neighbors s",
                           "regions, links s",
                           "bare kNN s",
                           "sampling / kNN",
                           "triad s",
                           "upsampling / triad",
                           "/ triad of vectors",
                           "passes",
                           "frame s",
                           "drag s",
                           "drags / s",
                           "interior links",
                           "input MB",
                           "peak MB",
                           "peak - input MB"});
  pcs_bench::Table all({"model",
                        "is_generated",
                        "points",
                        "samples",
                        "do_preserve_volume",
                        "threads",
                        "interior_links",
                        "passes",
                        "text_sampling",
                        "text_precomputation",
                        "text_solving",
                        "text_upsampling",
                        "neighbors",
                        "neighbors_median",
                        "sampling",
                        "sampling_median",
                        "construction",
                        "construction_median",
                        "factorization",
                        "factorization_median",
                        "solving",
                        "solving_median",
                        "upsampling",
                        "upsampling_median",
                        "frame",
                        "frame_median",
                        "drag",
                        "drag_median",
                        "knn",
                        "knn_median",
                        "triad",
                        "triad_median",
                        "triad_of_vectors",
                        "triad_of_vectors_median",
                        "input_megabytes",
                        "peak_megabytes"});
  bool any_generated = false;
  std::vector<std::string> given_up;
  int status = 0;
  for (const Row& row : rows) {
    if (!only.empty() && std::find(only.begin(), only.end(), row.model) == only.end())
      continue;
    for (const bool is_parallel : {false, true})
      try {
        std::cerr << label(row) << (is_parallel ? ", all threads\n" : ", 1 thread\n");
        const Measured m = measure_apart(row, is_parallel, folder, repetitions, time_limit);
        const bool is_stand_in = m.is_generated && std::string(row.model) != "plain";
        any_generated = any_generated || is_stand_in;
        const std::string model = std::string(row.model) + (is_stand_in ? "*" : "");
        std::string samples = row.samples == 0 ? "none" : std::to_string(m.samples);
        if (!row.do_preserve_volume)
          samples += ", no links";
        const std::string threads = is_parallel ? "all" : "1";
        const double whole_sampling = m.neighbors.best + m.sampling.best;
        seconds.add({model,
                     std::to_string(m.points),
                     samples,
                     threads,
                     number(row.text_sampling),
                     number(whole_sampling),
                     number(row.text_precomputation),
                     number(m.factorization.best),
                     number(row.text_solving),
                     number(m.pass.best),
                     number(m.solving.best),
                     number(row.text_upsampling),
                     number(m.upsampling.best)});
        ratios.add({model,
                    samples,
                    threads,
                    number(m.neighbors.best),
                    number(m.sampling.best),
                    number(m.knn.best),
                    number(whole_sampling / m.knn.best),
                    number(m.triad.best),
                    number(m.upsampling.best / m.triad.best),
                    number(m.upsampling.best / m.triad_of_vectors.best),
                    std::to_string(m.iterations),
                    number(m.frame.best),
                    number(m.drag.best),
                    number(1 / m.drag.best),
                    std::to_string(m.links),
                    number(m.input_megabytes),
                    number(m.peak_megabytes),
                    number(m.peak_megabytes - m.input_megabytes)});
        std::vector<std::string> line = {row.model,
                                         is_stand_in ? "1" : "0",
                                         std::to_string(m.points),
                                         std::to_string(m.samples),
                                         row.do_preserve_volume ? "1" : "0",
                                         threads,
                                         std::to_string(m.links),
                                         std::to_string(m.iterations)};
        for (const double v :
             {row.text_sampling, row.text_precomputation, row.text_solving, row.text_upsampling})
          line.push_back(number(v, 4));
        for (const Time& t : {m.neighbors,
                              m.sampling,
                              m.construction,
                              m.factorization,
                              m.solving,
                              m.upsampling,
                              m.frame,
                              m.drag,
                              m.knn,
                              m.triad,
                              m.triad_of_vectors}) {
          line.push_back(number(t.best, 4));
          line.push_back(number(t.median, 4));
        }
        line.push_back(number(m.input_megabytes, 4));
        line.push_back(number(m.peak_megabytes, 4));
        all.add(std::move(line));
      } catch (const Time_limit_exceeded& e) {
        given_up.push_back(std::string(e.what()) + (is_parallel ? ", all threads" : ", 1 thread"));
      } catch (const std::exception& e) { // the other rows are still measured
        std::cerr << e.what() << '\n';
        status = 1;
      }
  }
  try {
    std::cout << "Seconds (best of several); 2022: as published [Aiteanu 2022, table 2.1]\n\n";
    seconds.print(std::cout);
    std::cout << "Ratios to reference computations on one thread in the same process\n\n";
    ratios.print(std::cout);
    for (const std::string& line : given_up)
      std::cout << "given up: " << line << '\n';
    if (any_generated)
      std::cout << "* a generated surface with as many points\n";
    if (!csv.empty())
      all.write_csv(csv);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
  return status;
}
