// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of the program for the steps of the method, each of which can be chosen as published.

#ifndef PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_METHOD_OPTIONS_H
#define PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_METHOD_OPTIONS_H

#include <pcs/core/Orl_options.h>

#include <CLI/CLI.hpp>

#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace orl_program {

/// Names and numbers of the command line; the defaults are those of the library.
struct Method_options
{
  // matching of branches and points
  std::string assignment = "combined", transport = "exact", masses = "area", cost = "squared";
  double reach = pcs::Transport_options().reach;
  double epsilon = pcs::Sinkhorn_options().regularization;
  bool is_published = false; ///< energy of a matching of branches
  // coordinates and the metric
  std::string orientation = "gauge-fixed", direction = "of-partner", metric = "sum";
  // trees on the path
  std::string extrapolation = "bounded", point_path = "cylindrical", normals = "scans-or-across";
};

inline void add_choice(CLI::App& app,
                       const char* name,
                       std::string& value,
                       const std::vector<std::string>& names,
                       const std::string& what)
{
  app.add_option(name, value, what)
      ->check(CLI::IsMember(names))
      ->capture_default_str()
      ->group("Steps of the method; as published [Aiteanu 2022] in brackets");
}

inline void declare_method(CLI::App& app, Method_options& m)
{
  const char* const group = "Steps of the method; as published [Aiteanu 2022] in brackets";
  app.add_flag("--published-energy",
               m.is_published,
               "match branches with the energy as published [given]")
      ->group(group);
  add_choice(
      app,
      "--point-assignment",
      m.assignment,
      {"combined", "by-normal"},
      "branch of a point at a fork: by distance and normal, or by the normal alone among the "
      "branches within 1.1 radii [by-normal]");
  add_choice(app,
             "--transport",
             m.transport,
             {"exact", "sinkhorn"},
             "how points are matched "
             "[sinkhorn]");
  app.add_option("--sinkhorn-epsilon",
                 m.epsilon,
                 "entropic regularization, as a fraction of the largest cost, in (0, 1]")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str()
      ->group(group);
  add_choice(app,
             "--point-weights",
             m.masses,
             {"area", "equal"},
             "mass of a point: area of the surface around it, or the same for all [equal]");
  add_choice(app,
             "--transport-cost",
             m.cost,
             {"squared", "distance"},
             "cost of transport: the squared distance, or the distance [distance]");
  app.add_option("--reach",
                 m.reach,
                 "largest transport distance, in median distances of nearest points of both trees; "
                 "inf: all mass is transported [inf]")
      ->check(CLI::Range(1e-6, std::numeric_limits<double>::infinity()))
      ->capture_default_str()
      ->group(group);
  add_choice(app,
             "--orientation",
             m.orientation,
             {"gauge-fixed", "transported", "world-axes"},
             "how orientations are measured [world-axes]");
  add_choice(app,
             "--virtual-direction",
             m.direction,
             {"of-partner", "along-parent"},
             "direction of a branch in the tree that lacks it [along-parent]");
  add_choice(app,
             "--metric",
             m.metric,
             {"sum", "square", "cone", "published"},
             "distance of --distances [published: equation (4.7)]");
  add_choice(app,
             "--extrapolation",
             m.extrapolation,
             {"bounded", "linear"},
             "how lengths and radii continue beyond the ends of the path [linear, with "
             "--max-extrapolation-degrees 180]");
  add_choice(app,
             "--point-path",
             m.point_path,
             {"cylindrical", "virtual-edges"},
             "how points of two trees move [virtual-edges]");
  add_choice(app,
             "--normals",
             m.normals,
             {"scans-or-across", "scans", "across"},
             "normals of points: of the scans, if all have them, otherwise orthogonal to the "
             "branches; of the scans or none; or orthogonal in any case [across]");
}

inline pcs::Point_assignment_options assignment_options(const Method_options& m)
{
  pcs::Point_assignment_options options;
  if (m.assignment == "by-normal")
    options.rule = pcs::Point_assignment::by_normal;
  return options;
}

inline pcs::Transport_options transport_options(const Method_options& m)
{
  pcs::Transport_options options;
  if (m.transport == "sinkhorn")
    options.method = pcs::Point_transport::sinkhorn;
  options.sinkhorn.regularization = m.epsilon;
  if (m.masses == "equal")
    options.weights = pcs::Point_weights::equal;
  options.is_squared = m.cost == "squared";
  options.reach = m.reach;
  return options;
}

inline pcs::Orl_orientation orientation(const Method_options& m)
{
  return m.orientation == "world-axes"    ? pcs::Orl_orientation::world_axes
         : m.orientation == "transported" ? pcs::Orl_orientation::transported
                                          : pcs::Orl_orientation::gauge_fixed;
}

inline pcs::Virtual_direction virtual_direction(const Method_options& m)
{
  return m.direction == "along-parent" ? pcs::Virtual_direction::along_parent
                                       : pcs::Virtual_direction::of_partner;
}

inline pcs::Orl_metric metric(const Method_options& m)
{
  return m.metric == "square"      ? pcs::Orl_metric::square
         : m.metric == "cone"      ? pcs::Orl_metric::cone
         : m.metric == "published" ? pcs::Orl_metric::published
                                   : pcs::Orl_metric::sum;
}

inline pcs::Orl_extrapolation extrapolation(const Method_options& m)
{
  return m.extrapolation == "linear" ? pcs::Orl_extrapolation::linear
                                     : pcs::Orl_extrapolation::bounded;
}

inline pcs::Point_path point_path(const Method_options& m)
{
  return m.point_path == "virtual-edges" ? pcs::Point_path::virtual_edges
                                         : pcs::Point_path::cylindrical;
}

/// Returns the options that define the matching of points, with their values.
inline std::vector<std::pair<std::string, std::string>> point_method(const Method_options& m)
{
  const auto text = [](double x) {
    std::ostringstream out;
    out << x;
    return out.str();
  };
  return {{"--transport", m.transport},
          {"--point-assignment", m.assignment},
          {"--point-weights", m.masses},
          {"--transport-cost", m.cost},
          {"--reach", text(m.reach)},
          {"--sinkhorn-epsilon", text(m.epsilon)}};
}

} // namespace orl_program

#endif // PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_METHOD_OPTIONS_H
