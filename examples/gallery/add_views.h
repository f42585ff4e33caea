// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The views of the gallery: reads results of the programs, and adds their data to a page.

#ifndef PCS_EXAMPLES_GALLERY_ADD_VIEWS_H
#define PCS_EXAMPLES_GALLERY_ADD_VIEWS_H

#include "Page.h"
#include "reports.h"
#include "tables.h"
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/read_points.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gallery {

/// Views whose files are empty are left out.
struct Options
{
  std::string rest, deformed, edit, model_up = "z";
  std::string scan, cylinders, mesh, scan_report;
  std::string morph, family, stand, stand_report;
  std::string page, editor, output;
  std::size_t most_points = 200000, most_model_points = 500000;
};

inline pcs::IO::Point_table read_table(const std::string& path)
{
  pcs::IO::Point_table table = pcs::IO::read_points(path);
  if (table.number_of_points() == 0)
    throw pcs::IO_error(path, "has no points");
  return table;
}

inline std::vector<double> property_of(const pcs::IO::Point_table& table,
                                       const std::string& name,
                                       const std::string& path,
                                       const std::string& origin)
{
  if (!table.has_property(name))
    throw pcs::IO_error(path, "has no property `" + name + "`; expected the output of " + origin);
  return table.property_as_double(name);
}

/// The model at rest and deformed. Its points at rest are also the first input of the live editor.
inline void add_deformation(const Options& o, Page& page)
{
  const pcs::IO::Point_table rest = read_table(o.rest), deformed = read_table(o.deformed);
  if (rest.number_of_points() != deformed.number_of_points())
    throw pcs::IO_error(o.deformed,
                        "has " + std::to_string(deformed.number_of_points()) + " points, " +
                            o.rest + " has " + std::to_string(rest.number_of_points()) +
                            "; expected as many");
  const auto kept = random_subset(rest.number_of_points(), o.most_model_points);
  const std::vector<Json> frames =
      page.add_points({select(rest.points(), kept), select(deformed.points(), kept)});
  Json view = {{"id", "deformation"},
               {"up", o.model_up},
               {"name", std::filesystem::path(o.rest).stem().string()},
               {"number_in_file", rest.number_of_points()},
               {"rest", frames[0]},
               {"deformed", frames[1]}};
  if (!o.edit.empty())
    view["edit"] = read_edit(o.edit);
  page.views.push_back(view);
}

inline Json cylinders_of_page(const std::vector<Cylinder>& cylinders, Page& page)
{
  std::vector<Point> ends;
  std::vector<double> radius;
  std::vector<float> error;
  std::vector<std::size_t> branch;
  std::vector<std::uint8_t> order;
  std::size_t last = 0;
  for (const Cylinder& c : cylinders) {
    ends.push_back(c.start);
    ends.push_back(c.end);
    radius.push_back(c.radius);
    error.push_back(static_cast<float>(c.radius_error));
    branch.push_back(c.branch);
    last = std::max(last, c.branch);
    order.push_back(static_cast<std::uint8_t>(std::clamp(c.order, 0, 255)));
  }
  return {{"ends", page.add_points(ends)},
          {"radius", page.add_lengths(radius)},
          {"radius_error", page.add_numbers(error)},
          {"branch", page.add_indices(branch, last)},
          {"order", page.add_numbers(order)}};
}

inline Json mesh_of_page(const std::string& path, Page& page)
{
  std::shared_ptr<pcs::IO::Mesh_faces> faces;
  const pcs::IO::Point_table vertices = pcs::IO::read_points(path, faces);
  std::vector<std::size_t> corners;
  std::uint64_t first = 0;
  if (faces)
    for (const std::uint64_t end : faces->ends) {
      for (std::uint64_t j = first + 2; j < end; ++j)
        for (const std::uint64_t k : {first, j - 1, j})
          corners.push_back(faces->vertices[k]);
      first = end;
    }
  if (corners.empty())
    throw pcs::IO_error(path, "has no faces, expected a mesh");
  return {{"points", page.add_points(vertices.points())},
          {"corners", page.add_indices(corners, vertices.number_of_points())}};
}

/// The scan by branches, the cylinders with their values, and the closed surface.
inline void add_scan(const Options& o, Page& page)
{
  const pcs::IO::Point_table table = read_table(o.scan);
  const std::vector<double> branch =
      property_of(table, "branch", o.scan, "extract_tree_skeleton --points");
  const auto kept = random_subset(table.number_of_points(), o.most_points);
  const std::vector<Point> points = select(table.points(), kept);
  const std::vector<Cylinder> cylinders = read_cylinders(o.cylinders);
  const std::size_t none = cylinders.size();
  Json view = {
      {"id", "scan"},
      {"up", "z"},
      {"name", std::filesystem::path(o.scan).stem().string()},
      {"number_in_file", table.number_of_points()},
      {"points", page.add_points(points)},
      {"cylinder_of_point",
       page.add_indices(nearest_cylinders(points, select(branch, kept), cylinders, none), none)},
      {"cylinders", cylinders_of_page(cylinders, page)}};
  if (!o.mesh.empty())
    view["mesh"] = mesh_of_page(o.mesh, page);
  if (!o.scan_report.empty())
    view["report"] = read_scan_report(o.scan_report);
  page.views.push_back(view);
}

inline std::vector<std::filesystem::path> files_of_folder(const std::string& folder)
{
  if (!std::filesystem::is_directory(folder))
    throw pcs::IO_error(folder, "is not a folder");
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// Returns the files lambda_*.ply of a folder by their numbers.
inline std::map<double, std::string> files_of_path(const std::string& folder)
{
  std::map<double, std::string> files;
  for (const std::filesystem::path& path : files_of_folder(folder)) {
    double lambda = 0;
    if (path.extension() == ".ply" &&
        std::sscanf(path.filename().string().c_str(), "lambda_%lf", &lambda) == 1)
      files[lambda] = path.string();
  }
  if (files.size() < 2)
    throw pcs::IO_error(folder, "has fewer than two files lambda_*.ply of orl_geodesic");
  return files;
}

/// Trees on the geodesic, whose points correspond.
inline void add_morph(const Options& o, Page& page)
{
  std::vector<std::vector<Point>> frames;
  std::vector<double> lambdas;
  std::vector<std::size_t> kept;
  std::size_t number_of_points = 0;
  for (const auto& [lambda, path] : files_of_path(o.morph)) {
    const pcs::IO::Point_table table = read_table(path);
    if (frames.empty()) {
      number_of_points = table.number_of_points();
      kept = random_subset(number_of_points, o.most_points * 2 / 5);
    } else if (table.number_of_points() != number_of_points)
      throw pcs::IO_error(path,
                          "has " + std::to_string(table.number_of_points()) +
                              " points, the files before it have " +
                              std::to_string(number_of_points) +
                              "; choose --lambda between 0 and 1 without the ends, for example "
                              "0.001 and 0.999, where all branches have their points");
    frames.push_back(select(table.points(), kept));
    lambdas.push_back(lambda);
  }
  page.views.push_back({{"id", "morph"},
                        {"up", "z"},
                        {"number_in_file", number_of_points},
                        {"lambdas", lambdas},
                        {"frames", page.add_points(frames)}});
}

inline constexpr std::size_t nodes_of_branch = 8;

/// Returns the files of a folder with this beginning and the extension .swc, sorted.
inline std::vector<std::string> skeletons_of(const std::string& folder, const std::string& stem)
{
  std::vector<std::string> files;
  for (const std::filesystem::path& path : files_of_folder(folder))
    if (path.filename().string().rfind(stem, 0) == 0 && path.extension() == ".swc")
      files.push_back(path.string());
  return files;
}

inline void check_branches(const Branches& tree, const Branches& first, const std::string& path)
{
  if (tree.order != first.order)
    throw pcs::IO_error(path,
                        "has other branches than the first tree of its folder; make the family "
                        "with --keep-absent-branches of orl_geodesic");
}

/// A grid of trees over two modes of variation, and random trees. The trees of the grid are the
/// files scores_*.swc, the second score fastest, from -2 to 2 standard deviations.
inline void add_family(const Options& o, Page& page)
{
  std::vector<std::vector<Point>> points;
  std::vector<double> radii;
  Branches first;
  const std::vector<std::string> grid = skeletons_of(o.family, "scores_"),
                                 samples = skeletons_of(o.family, "sample_");
  const auto side = static_cast<std::size_t>(std::lround(std::sqrt(double(grid.size()))));
  if (side < 2 || side * side != grid.size())
    throw pcs::IO_error(o.family,
                        "has " + std::to_string(grid.size()) +
                            " files scores_*.swc; expected those of a square grid of scores");
  for (const std::vector<std::string>* const files : {&grid, &samples})
    for (const std::string& path : *files) {
      Branches tree = read_branches(path, nodes_of_branch);
      if (points.empty())
        first = tree;
      check_branches(tree, first, path);
      radii.insert(radii.end(), tree.radius.begin(), tree.radius.end());
      points.push_back(std::move(tree.point));
    }
  const std::vector<Json> frames = page.add_points(points);
  const auto middle = frames.begin() + static_cast<std::ptrdiff_t>(grid.size());
  const std::string modes_path = o.family + "/modes.json";
  const Json modes(program::read_json(modes_path, "the report of orl_geodesic --modes"));
  Json shares = Json::array();
  std::size_t number_of_trees = 0;
  try {
    for (const Json& mode : modes.value("modes", Json::array()))
      shares.push_back(mode.value("share_of_variance", 0.0));
    number_of_trees = modes.value("outlier_scores", Json::array()).size();
  } catch (const nlohmann::json::exception& e) {
    throw pcs::IO_error(modes_path,
                        std::string("is no report of orl_geodesic --modes: ") + e.what());
  }
  page.views.push_back({{"id", "family"},
                        {"up", "z"},
                        {"nodes_of_branch", nodes_of_branch},
                        {"order", page.add_numbers(first.order)},
                        {"side", side},
                        {"shares", shares},
                        {"trees", number_of_trees},
                        {"radius", page.add_lengths(radii)},
                        {"grid", std::vector<Json>(frames.begin(), middle)},
                        {"samples", std::vector<Json>(middle, frames.end())}});
}

/// A stand, by trees. Points of trees are preferred to those of the ground.
inline void add_stand(const Options& o, Page& page)
{
  const pcs::IO::Point_table table = read_table(o.stand);
  const std::vector<double> tree = property_of(table, "tree", o.stand, "segment_trees --points");
  std::vector<std::size_t> inside, outside;
  constexpr double most_labels = 4294967295.0;
  double last = -1;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (!(tree[i] == std::floor(tree[i]) && std::abs(tree[i]) < most_labels))
      throw pcs::IO_error(o.stand,
                          "point " + std::to_string(i) +
                              ": expected a whole number below 4294967295 as `tree`, or -1 for "
                              "points of no tree");
    (tree[i] < 0 ? outside : inside).push_back(i);
    last = std::max(last, tree[i]);
  }
  std::vector<std::size_t> kept =
      select(inside, random_subset(inside.size(), o.most_points * 3 / 4));
  const auto rest = select(outside, random_subset(outside.size(), o.most_points - kept.size()));
  kept.insert(kept.end(), rest.begin(), rest.end());
  const auto none = static_cast<std::size_t>(last + 1);
  std::vector<std::size_t> labels;
  for (const std::size_t i : kept)
    labels.push_back(tree[i] < 0 ? none : static_cast<std::size_t>(tree[i]));
  page.views.push_back(
      {{"id", "stand"},
       {"up", "z"},
       {"number_in_file", table.number_of_points()},
       {"points", page.add_points(select(table.points(), kept))},
       {"tree", page.add_indices(labels, none)},
       {"number_of_trees", none},
       {"report", o.stand_report.empty() ? Json() : read_stand_report(o.stand_report)}});
}

} // namespace gallery

#endif // PCS_EXAMPLES_GALLERY_ADD_VIEWS_H
