// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of the command line that choose the material, the solver and published variants.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_MODEL_OPTIONS_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_MODEL_OPTIONS_H

#include <pcs/core/Deformation_options.h>
#include <pcs/deformation/model/Elastic_options.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace program {

struct Model_options
{
  double poisson_ratio = 0, stiffness = 1; // [-]
  double tolerance = pcs::deformation::default_tolerance;
  std::int64_t number_of_iterations = pcs::deformation::default_maximal_number_of_passes;
  bool is_volume_ignored = false;
  std::vector<std::string> published; ///< names of variants, or "all"

  bool is_published(const std::string& variant) const
  {
    return std::any_of(published.begin(), published.end(), [&](const std::string& name) {
      return name == variant || name == "all";
    });
  }
  pcs::Sample_weights sample_weights() const
  {
    return is_published("weights") ? pcs::Sample_weights::inverse_square
                                   : pcs::Sample_weights::compact;
  }
  pcs::Sample_search sample_search() const
  {
    return is_published("hops") ? pcs::Sample_search::breadth_first_hops
                                : pcs::Sample_search::regions;
  }
  pcs::Rotation_field rotation_field() const
  {
    return is_published("rotations") ? pcs::Rotation_field::quaternion
                                     : pcs::Rotation_field::geodesic;
  }
};

/// Accepts a finite number in `[low, high]`.
inline CLI::Validator number_between(double low, double high)
{
  std::ostringstream range;
  range.precision(15);
  range << "a number from " << low;
  if (std::isfinite(high))
    range << " to " << high;
  else
    range << " on";
  const std::string expected = range.str();
  const auto check = [=](std::string& text) -> std::string {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= low &&
        value <= high)
      return "";
    return "expected " + expected + ", found " + text;
  };
  return CLI::Validator(check, "");
}

inline void declare(CLI::App& app, Model_options& options)
{
  app.add_option("--poisson-ratio",
                 options.poisson_ratio,
                 "transverse contraction relative to extension, -1 to 0.5 (keeps the volume)")
      ->check(number_between(-1, 0.5))
      ->group("Material")
      ->capture_default_str();
  app.add_option("--stiffness",
                 options.stiffness,
                 "bending stiffness relative to stretching stiffness, 0.001 to 1000")
      ->check(number_between(1e-3, 1e3))
      ->group("Material")
      ->capture_default_str();
  app.add_flag("--no-volume",
               options.is_volume_ignored,
               "no springs through the interior of closed surfaces, which keep their volume")
      ->group("Material");
  app.add_option("--iterations", options.number_of_iterations, "largest number of iterations")
      ->check(number_between(0, 1e6))
      ->group("Solver")
      ->capture_default_str();
  app.add_option("--tolerance",
                 options.tolerance,
                 "iterations end when the energy decreases by less than this fraction")
      ->check(number_between(0, INFINITY))
      ->group("Solver")
      ->capture_default_str();
  app.add_option(
         "--as-published",
         options.published,
         "variants of the dissertation instead of those of pcs, by names; without names "
         "all: weights (inverse squares of distances, equation 2.6), hops (samples with the "
         "fewest hops, algorithm 1), rotations (blended quaternions, up to 360 degrees)")
      ->check(CLI::IsMember({"weights", "hops", "rotations", "all"}))
      ->expected(0, 3)
      ->default_str("all") // the value without names
      ->group("Solver");
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_MODEL_OPTIONS_H
