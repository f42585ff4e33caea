// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: writes random points of a mesh with a least distance (Poisson-disk sampling).

#include "common/Distinct_files.h"
#include "common/check_output.h"
#include "common/is_seed.h"
#include "common/run_program.h"
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/write_points.h>
#include <pcs/core/errors.h>
#include <pcs/generators/sample_mesh.h>

#include <boost/range/iterator_range.hpp>

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace {

using Table = pcs::IO::Point_table;

struct Options
{
  std::string input, output;
  double spacing = 0;
  std::int64_t seed = 0;
  bool is_quiet = false;
};

void declare(CLI::App& app, Options& o)
{
  app.footer(
      R"(Points are distributed uniformly by area, and none is nearer to another one than --spacing,
in the unit of the mesh. A flat surface has about 0.61 points for each square of this side:
for one point per square centimetre, the spacing is 0.78 cm. Points have the normals of
their faces. Properties of the vertices are not kept.

Exit codes: 0 success, 1 bad input or usage, 2 internal error.)");
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--input", o.input, "the mesh: PLY, OFF or OBJ with faces")->required();
  app.add_option("--output", o.output, "the points, with normals")->required();
  app.add_option("--spacing", o.spacing, "least distance of two points, more than 0")->required();
  app.add_option("--seed", o.seed, "other seeds give other points")
      ->check(program::is_seed)
      ->capture_default_str();
  app.add_flag("--quiet", o.is_quiet, "print nothing but errors");
}

/// Returns the corners of each face.
auto corners_of(const pcs::IO::Mesh_faces& faces)
{
  using Corners = boost::iterator_range<std::vector<std::uint32_t>::const_iterator>;
  std::vector<Corners> result;
  auto begin = faces.vertices.begin();
  for (const std::uint64_t end : faces.ends) {
    const auto next = faces.vertices.begin() + static_cast<std::ptrdiff_t>(end);
    result.emplace_back(begin, next);
    begin = next;
  }
  return result;
}

bool work(const Options& o)
{
  if (!(o.spacing > 0 && std::isfinite(o.spacing)))
    throw pcs::Invalid_input("--spacing must be a finite number, more than 0");
  program::Distinct_files files;
  files.add_input(o.input);
  files.add_output(o.output);
  Table empty;
  empty.set_normals({});
  program::check_output(o.output, empty.schema());
  std::shared_ptr<pcs::IO::Mesh_faces> faces;
  const Table mesh = pcs::IO::read_points(o.input, faces);
  if (!faces || faces->ends.empty())
    throw pcs::IO_error(o.input, "has no faces, expected a mesh");
  std::vector<std::pair<Table::Point_3, Table::Vector_3>> samples;
  try {
    pcs::sample_mesh(mesh.points(),
                     corners_of(*faces),
                     o.spacing,
                     std::back_inserter(samples),
                     pcs::parameters::random_seed(o.seed));
  } catch (const pcs::Invalid_input& refusal) {
    throw pcs::Invalid_input(o.input + ": " + refusal.what());
  }
  std::vector<Table::Point_3> points;
  std::vector<Table::Vector_3> normals;
  for (const auto& [p, n] : samples) {
    points.push_back(p);
    normals.push_back(n);
  }
  Table result(std::move(points));
  result.set_normals(normals);
  pcs::IO::write_points(o.output, result);
  if (!o.is_quiet)
    std::cout << "points " << result.number_of_points() << '\n';
  return true;
}

} // namespace

int main(int argc, char** argv)
{
  Options options;
  CLI::App app("Writes random points of a mesh with a least distance (Poisson-disk sampling).",
               "sample_mesh");
  declare(app, options);
  return program::run_program(app,
                              argc,
                              argv,
                              "--input tree.obj --spacing 0.01 --output tree.ply",
                              [&] { return work(options); });
}
