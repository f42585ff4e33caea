// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Largest jumps of displacement between neighbouring points: compact weights compared with the
// published ones [Aiteanu 2022].

#include <pcs/Point_set_deformation.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <support/Table.h>
#include <support/measuring.h>
#include <support/models.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using pcs_bench::number;
using pcs_bench::Vec3;
using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

struct Variant
{
  const char* name;
  pcs::Sample_search search;
  pcs::Sample_weights weights;
};
constexpr Variant variants[] = {
    {"regions, compact (default)", pcs::Sample_search::regions, pcs::Sample_weights::compact},
    {"regions, inverse square", pcs::Sample_search::regions, pcs::Sample_weights::inverse_square},
    {"hops, compact", pcs::Sample_search::breadth_first_hops, pcs::Sample_weights::compact},
    {"hops, inverse square (published)",
     pcs::Sample_search::breadth_first_hops,
     pcs::Sample_weights::inverse_square}};

/// Turns the head of the model.
std::vector<Vec3> turn_head(const std::vector<Vec3>& rest,
                            const pcs_bench::Ends& ends,
                            std::size_t samples,
                            const Variant& variant)
{
  std::vector<Point> points;
  for (const Vec3& p : rest)
    points.emplace_back(p.x(), p.y(), p.z());
  const auto np =
      pcs::parameters::number_of_samples(samples)
          .sample_search(variant.search)
          .sample_weights(variant.weights)
          .do_preserve_volume(false); // equal for all variants; the full solve remains short
  pcs::Point_set_deformation session(points, np);
  session.add_handle(ends.low);
  const auto head = session.add_handle(ends.high);
  session.set_rotation(head, Kernel::Vector_3(0, 1, 0), 75 * 3.14159265358979323846 / 180);
  const auto report = session.deform();
  if (report.status != pcs::Status::converged && report.status != pcs::Status::iteration_limit)
    throw std::runtime_error(std::string("the deformation failed: ") + to_string(report.status));
  std::vector<Vec3> result;
  for (const Point& p : points)
    result.emplace_back(p.x(), p.y(), p.z());
  return result;
}

/// Jumps |u_i - u_j| / |x_i - x_j| over the edges of the neighbour graph. [-]
struct Jumps
{
  double largest = 0, permille = 0,
         rms = 0;        ///< over free points; one edge in 1000 exceeds `permille`
  double at_handles = 0; ///< largest jump between a free point and a point of a handle

  Jumps(const std::vector<Vec3>& rest,
        const std::vector<Vec3>& deformed,
        const pcs::neighborhood::Proximity_graph& graph,
        const pcs_bench::Ends& ends)
  {
    std::vector<char> is_handle(rest.size(), 0);
    for (const auto* handle : {&ends.low, &ends.high})
      for (const auto i : *handle)
        is_handle[i] = 1;
    std::vector<double> jumps;
    for (std::size_t i = 0; i < graph.size(); ++i)
      for (auto j = graph.begin(i); j != graph.end(i); ++j) {
        const double d = (rest[*j] - rest[i]).norm();
        if (*j < i || !(d > 0) || (is_handle[i] && is_handle[*j]))
          continue;
        const double jump = ((deformed[*j] - rest[*j]) - (deformed[i] - rest[i])).norm() / d;
        if (is_handle[i] || is_handle[*j])
          at_handles = std::max(at_handles, jump);
        else
          jumps.push_back(jump);
      }
    for (const double jump : jumps) {
      largest = std::max(largest, jump);
      rms += jump * jump / double(jumps.size());
    }
    rms = std::sqrt(rms);
    const auto at = jumps.begin() + static_cast<std::ptrdiff_t>(0.999 * double(jumps.size()));
    std::nth_element(jumps.begin(), at, jumps.end());
    permille = *at;
  }
};

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Jumps of the displacement between neighbouring points.");
  std::string folder = pcs_bench::default_data_folder(), csv;
  std::vector<std::string> only;
  app.add_option("--data",
                 folder,
                 "folder with the scans (default: build/data); those missing are generated")
      ->check(CLI::ExistingDirectory);
  app.add_option("--only", only, "only these models")->check(CLI::IsMember({"bunny", "dragon"}));
  app.add_option("--csv", csv, "write the table to this file"); // passed by ./run bench
  CLI11_PARSE(app, argc, argv);

  pcs_bench::Table table({"model",
                          "samples",
                          "links and weights",
                          "largest jump",
                          "99.9 % below",
                          "RMS jump",
                          "largest / unsampled",
                          "largest at handles",
                          "RMS difference / diagonal"});
  try {
    for (const std::string name : {"bunny", "dragon"}) {
      if (!only.empty() && std::find(only.begin(), only.end(), name) == only.end())
        continue;
      const pcs_bench::Model model = pcs_bench::load_model(name, folder);
      const auto& rest = model.points;
      const pcs_bench::Ends ends(rest, 0.3, 0.2);
      const auto graph = pcs::neighborhood::nearest_neighbor_graph<CGAL::Sequential_tag>(rest, 6);
      Vec3 low = rest.front(), high = low;
      for (const Vec3& p : rest) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
      // Jumps of the same deformation solved at every point, which result from the shape alone.
      const std::vector<Vec3> full = turn_head(rest, ends, rest.size(), variants[0]);
      const Jumps of_full(rest, full, graph, ends);
      const std::string label = name + (model.is_generated ? "*" : "");
      const auto add =
          [&](const std::string& samples, const char* variant, const std::vector<Vec3>& deformed) {
            const Jumps jumps(rest, deformed, graph, ends);
            double error = 0;
            for (std::size_t i = 0; i < rest.size(); ++i)
              error += (deformed[i] - full[i]).squaredNorm() / double(rest.size());
            table.add({label,
                       samples,
                       variant,
                       number(jumps.largest),
                       number(jumps.permille),
                       number(jumps.rms),
                       number(jumps.largest / of_full.largest),
                       number(jumps.at_handles),
                       number(std::sqrt(error) / (high - low).norm())});
          };
      add("none", "every point solved", full);
      for (const std::size_t samples : {50u, 200u, 1000u})
        for (const Variant& variant : variants)
          add(std::to_string(samples), variant.name, turn_head(rest, ends, samples, variant));
    }
    table.print(std::cout);
    if (!csv.empty())
      table.write_csv(csv);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
  return 0;
}
