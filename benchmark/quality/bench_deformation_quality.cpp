// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Bends, twists and drags with known results, on grids and on irregular samplings, compared with
// mesh methods of CGAL.

#include <pcs/deform_point_set.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/drop_short_cuts.h>
#include <support/Table.h>
#include <support/deformation_cases.h>
#include <support/measuring.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstddef>
#include <functional>
#include <iostream>
#include <map>
#include <quality/irregular_cases.h>
#include <quality/mesh_peer.h>
#include <quality/quality_measures.h>
#include <quality/reference_field.h>
#include <quality/survey_cases.h>
#include <string>
#include <utility>
#include <vector>

namespace {

using pcs_bench::Deformation_case;
using pcs_bench::Edges;
using pcs_bench::no_value;
using pcs_bench::number;
using pcs_bench::Sampling_kind;
using pcs_bench::Vec3;
using Point = CGAL::Simple_cartesian<double>::Point_3;

struct Result
{
  std::vector<Vec3> points;
  std::size_t iterations = 0;
  double seconds = no_value;
  double solving = no_value; ///< part of `seconds`: passes without neighbours, samples and factors
  std::string status;
};

/// Time from input points to output points, on one thread; the minimum of three runs.
Result deform(const Deformation_case& c, std::size_t number_of_samples)
{
  std::vector<Point> rest;
  for (const Vec3& p : c.points)
    rest.emplace_back(p.x(), p.y(), p.z());
  std::vector<pcs::Deformation_handle> handles(c.handles.size());
  for (std::size_t h = 0; h < handles.size(); ++h) {
    handles[h].indices.assign(c.handles[h].begin(), c.handles[h].end());
    handles[h].transformation = c.transforms[h];
  }
  std::vector<Point> points;
  Result result;
  pcs_bench::Timings solving;
  const auto timings = pcs_bench::repeat(3, [&] {
    points = rest;
    const pcs::Deformation_report report = pcs::deform_point_set<CGAL::Sequential_tag>(
        points,
        handles,
        pcs::parameters::number_of_samples(number_of_samples));
    result.iterations = report.number_of_iterations;
    result.status = to_string(report.status);
    solving.add(report.seconds.solving);
  });
  result.seconds = timings.best();
  result.solving = solving.best();
  for (const Point& p : points)
    result.points.emplace_back(p.x(), p.y(), p.z());
  return result;
}

class Report
{
public:
  Report()
    : m_table({"case",
               "sampling",
               "method",
               "points",
               "iterations",
               "seconds",
               "solving",
               "RMS edge",
               "max edge",
               "rotation smoothness deg",
               "frame error deg",
               "position error / L",
               "max position error / L",
               "volume",
               "smallest section",
               "position / grid"})
  {
  }

  void add(const Deformation_case& c,
           const std::string& sampling,
           const std::string& method,
           const Edges& edges,
           const Result& result)
  {
    const auto m = pcs_bench::measure(c, edges, result.points);
    // Reference for irregular samplings: the same method on the grid.
    double& on_grid = m_position_on_grid.emplace(c.name + method, m.position_error).first->second;
    m_table.add({c.name,
                 sampling,
                 method,
                 std::to_string(c.points.size()),
                 result.iterations == 0 ? "-" : std::to_string(result.iterations),
                 number(result.seconds),
                 number(result.solving),
                 number(m.rms_edge),
                 number(m.largest_edge),
                 number(m.rotation_smoothness),
                 number(m.frame_error),
                 number(m.position_error),
                 number(m.largest_position_error),
                 number(m.volume_ratio),
                 number(pcs_bench::smallest_section(c, result.points)),
                 number(m.position_error / on_grid, 2)});
  }

  const pcs_bench::Table& table() const { return m_table; }

private:
  pcs_bench::Table m_table;
  std::map<std::string, double> m_position_on_grid;
};

template <CGAL::Deformation_algorithm_tag algorithm>
void add_peer(Report& report,
              const Deformation_case& c,
              const Edges& edges,
              const std::string& name,
              double seconds)
{
  const auto run = [&](std::size_t iterations, double limit, const std::string& method) {
    pcs_bench::Peer_result peer = pcs_bench::deform_mesh<algorithm>(c, iterations, limit);
    report.add(c,
               "mesh",
               method,
               edges,
               {std::move(peer.points), peer.iterations, peer.seconds, no_value, ""});
  };
  run(500, seconds, name + ", same time");
  run(500, 1e9, name + ", 500");
}

struct Options
{
  std::string only;
  bool has_peers = false;
};

void run_case(Report& report,
              const Deformation_case& grid,
              const std::vector<Sampling_kind>& kinds,
              const Options& options)
{
  if (grid.name.find(options.only) == std::string::npos)
    return;
  for (const Sampling_kind kind : kinds) {
    const Deformation_case c = pcs_bench::resample(grid, kind);
    std::cerr << c.name << ", " << name_of(kind) << '\n';
    const Edges edges = c.triangles.empty() ? pcs_bench::neighbor_edges(c.points)
                                            : pcs_test::mesh_edges(c.triangles);
    if (c.exact) {
      Result exact;
      for (const Vec3& p : c.points)
        exact.points.push_back(c.exact(p));
      report.add(c, name_of(kind), "exact", edges, exact);
    }
    double seconds = 0;
    for (const std::size_t samples : {std::size_t(0),
                                      std::size_t(200),
                                      std::size_t(1000),
                                      std::size_t(2000),
                                      std::size_t(5000)}) {
      if (samples >= c.points.size())
        continue;
      const Result result = deform(c, samples == 0 ? c.points.size() : samples);
      if (samples == 0)
        seconds = result.seconds;
      report.add(c,
                 name_of(kind),
                 samples == 0 ? "pcs" : "pcs, " + std::to_string(samples),
                 edges,
                 result);
    }
    if (kind == Sampling_kind::grid && options.has_peers && !c.triangles.empty()) {
      add_peer<CGAL::ORIGINAL_ARAP>(report, c, edges, "CGAL ORIGINAL_ARAP", seconds);
      add_peer<CGAL::SRE_ARAP>(report, c, edges, "CGAL SRE_ARAP", seconds);
    }
  }
}

/// Counts links between the two sheets, except near the end where they are joined.
std::size_t count_crossing_links(const pcs_bench::Sheets_case& c,
                                 const pcs::neighborhood::Proximity_graph& graph)
{
  std::size_t result = 0;
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (const auto* j = graph.begin(i); j != graph.end(i); ++j)
      if (c.is_lower[i] != c.is_lower[*j] && c.points[i].x() > 0.01 && c.points[*j].x() > 0.01)
        ++result;
  return result / 2;
}

/// Two sheets without interaction: measures the motion of the lower sheet relative to its length.
pcs_bench::Table compare_sheets()
{
  pcs_bench::Table table({"jitter / h",
                          "samples",
                          "status",
                          "nearest neighbours between sheets",
                          "links kept between sheets",
                          "largest motion of the lower sheet / L"});
  for (const double jitter : {0.0, 0.15, 0.3}) {
    const pcs_bench::Sheets_case c = pcs_bench::two_sheets(jitter);
    auto graph = pcs::neighborhood::nearest_neighbor_graph<CGAL::Sequential_tag>(
        c.points,
        pcs::default_number_of_neighbors);
    const std::size_t crossing = count_crossing_links(c, graph);
    pcs::neighborhood::drop_short_cuts<CGAL::Sequential_tag>(c.points, graph);
    const std::size_t kept = count_crossing_links(c, graph);
    for (const std::size_t samples : {std::size_t(200), std::size_t(1000), c.points.size()}) {
      const Result result = deform(c, samples);
      double largest = 0;
      for (std::size_t i = 0; i < c.points.size(); ++i)
        if (c.is_lower[i])
          largest = std::max(largest, (result.points[i] - c.points[i]).norm() / c.length);
      table.add({number(jitter, 2),
                 std::to_string(samples),
                 result.status,
                 std::to_string(crossing),
                 std::to_string(kept),
                 number(largest)});
    }
  }
  return table;
}

/// Compares the rotation fields alone, on the neighbour graph of T2's bar.
pcs_bench::Table compare_fields()
{
  pcs_bench::Table table({"turns", "reference", "field", "RMS difference deg"});
  const auto add = [&](const Deformation_case& c, bool is_harmonic) {
    const pcs_bench::Field_comparison fields(c);
    const auto reference = is_harmonic ? fields.harmonic_map() : fields.many_small_turns();
    for (const auto kind : {pcs::Rotation_field::geodesic, pcs::Rotation_field::quaternion})
      table.add({c.name,
                 is_harmonic ? "harmonic map" : "steps of 1 degree",
                 kind == pcs::Rotation_field::geodesic ? "geodesic" : "quaternion",
                 number(fields.difference(fields.solve(kind), reference))});
  };
  add(pcs_test::bar_bend_120(), true);
  add(pcs_test::bar_bend_120(), false);
  add(pcs_bench::bar_two_axes(), true);
  add(pcs_bench::bar_400_then_90(), false);
  return table;
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Quality of deformations with known answers.");
  Options options;
  std::string csv;
  app.add_option("--only", options.only, "only cases whose name contains this, for example T3");
  app.add_flag("--peers",
               options.has_peers,
               "compare with CGAL::Surface_mesh_deformation as well; takes minutes");
  app.add_option("--csv", csv, "write the first table to this file"); // passed by ./run bench
  CLI11_PARSE(app, argc, argv);

  try {
    Report report;
    const std::vector<Sampling_kind> grid = {Sampling_kind::grid};
    const std::vector<Sampling_kind> all = {Sampling_kind::grid,
                                            Sampling_kind::random,
                                            Sampling_kind::blue_noise,
                                            Sampling_kind::gradient,
                                            Sampling_kind::scan_noise,
                                            Sampling_kind::shuffled};
    run_case(report, pcs_test::bar_135(), all, options);
    run_case(report, pcs_test::bar_bend_120(), all, options);
    run_case(report, pcs_test::tube_120(), all, options);
    run_case(report, pcs_test::plate_drag(), grid, options);
    run_case(report, pcs_test::bar_720(), all, options);
    run_case(report, pcs_bench::rough_bar_bend_120(), grid, options);
    run_case(report, pcs_bench::bar_two_axes(), grid, options);
    run_case(report, pcs_bench::bar_400_then_90(), grid, options);
    const std::vector<Sampling_kind> measured = {Sampling_kind::grid,
                                                 Sampling_kind::random,
                                                 Sampling_kind::blue_noise,
                                                 Sampling_kind::gradient,
                                                 Sampling_kind::scan_noise};
    run_case(report, pcs_bench::survey_bar(), measured, options);
    run_case(report, pcs_bench::survey_cylinder(), measured, options);
    run_case(report, pcs_bench::survey_cactus(), measured, options);
    report.table().print(std::cout);
    if (options.only.empty() || options.only == "T6") {
      std::cout << "T6: two sheets joined along one end, 1.5 spacings apart; exact: no motion\n\n";
      compare_sheets().print(std::cout);
    }
    if (options.only.empty() || options.only == "fields") {
      std::cout << "Rotation fields on the bar of T2\n\n";
      compare_fields().print(std::cout);
    }
    if (!csv.empty())
      report.table().write_csv(csv);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
  return 0;
}
