// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: writes a closed bumpy surface as a point file of any size, in chunks.

#include "common/run_program.h"
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Write_options.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

using Table = pcs::IO::Point_table;

/// Returns point `i` of `n` on an upright ellipsoid of height 6 with bumps, along a spiral of
/// uniform density.
Table::Point_3 surface_point(std::uint64_t i, std::uint64_t n)
{
  constexpr double golden_ratio = 1.618033988749895, pi = 3.141592653589793;
  const double turns = static_cast<double>(i) / golden_ratio;
  const double angle = 2 * pi * (turns - std::floor(turns));
  const double z = (2 * static_cast<double>(i) + 1) / static_cast<double>(n) - 1;
  const double radius = std::sqrt(1 - z * z) * (1 + 0.05 * std::sin(7 * angle) * std::cos(20 * z));
  return {radius * std::cos(angle), radius * std::sin(angle), 3 * z};
}

void generate(const std::string& path, std::uint64_t n, bool is_float)
{
  constexpr std::uint64_t chunk_size = 262144;
  pcs::IO::Point_schema schema;
  if (is_float)
    for (auto& property : schema.properties)
      property.type = pcs::IO::Scalar_type::float32;
  pcs::IO::Write_options options;
  options.number_of_points = n;
  options.keep_coordinate_types = true;
  options.las_scale = {1e-7, 1e-7, 1e-7}; // the surface is 6 high
  options.las_offset = {0, 0, 0};
  pcs::IO::Point_writer writer(path, schema, options);
  Table chunk(schema);
  for (std::uint64_t first = 0; first < n; first += chunk_size) {
    chunk.clear();
    for (std::uint64_t i = first; i < std::min(first + chunk_size, n); ++i)
      chunk.points().push_back(surface_point(i, n));
    writer.append(chunk);
  }
  writer.commit();
}

int main(int argc, char** argv)
{
  std::string path;
  std::uint64_t number_of_points = 0;
  bool is_float = false;
  CLI::App app("Writes a closed bumpy surface as a point file of any size.", "generate_points");
  app.footer("The surface is upright, 6 high and 2 wide.\n\n"
             "Exit codes: 0 success, 1 bad input or usage, 2 internal error.");
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("file", path, "the points, in any format that can be written")->required();
  app.add_option("number", number_of_points, "number of points")
      ->required()
      ->check(CLI::Range(std::uint64_t(1), std::uint64_t(4294967295U)));
  app.add_flag("--float", is_float, "coordinates with 32 bits");
  return program::run_program(app, argc, argv, "points.ply 1000000", [&] {
    generate(path, number_of_points, is_float);
    return true;
  });
}
