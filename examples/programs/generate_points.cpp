// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: writes a closed bumpy surface as a point file of any size, in chunks.

#include <pcs/IO/Point_writer.h>
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Write_options.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
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

/// Reads a number of points. Throws if it is invalid.
std::uint64_t read_count(const std::string& text)
{
  std::uint64_t n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size() || n == 0 || n > 4294967295U)
    throw std::invalid_argument("\"" + text +
                                "\" is not a number of points between 1 and 4294967295");
  return n;
}

int main(int argc, char** argv)
try {
  const bool is_float = argc == 4 && std::string(argv[3]) == "--float";
  if (argc != 3 && !is_float) {
    std::cerr << "usage: generate_points FILE NUMBER_OF_POINTS [--float]\n";
    return 1;
  }
  const std::uint64_t n = read_count(argv[2]);
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
  pcs::IO::Point_writer writer(argv[1], schema, options);
  Table chunk(schema);
  for (std::uint64_t first = 0; first < n; first += chunk_size) {
    chunk.clear();
    for (std::uint64_t i = first; i < std::min(first + chunk_size, n); ++i)
      chunk.points().push_back(surface_point(i, n));
    writer.append(chunk);
  }
  writer.commit();
  return 0;
} catch (const std::exception& e) {
  std::cerr << "generate_points: " << e.what() << '\n';
  return 1;
}
