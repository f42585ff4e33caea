// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: trees between two scanned trees, and beyond them.

#include "orl_program/Tree_file.h"
#include "orl_program/blend_properties.h"
#include "program/Progress_line.h"
#include "program/Report_file.h"
#include <pcs/IO/read_correspondences.h>
#include <pcs/IO/write_correspondences.h>
#include <pcs/IO/write_points.h>
#include <pcs/IO/write_swc.h>
#include <pcs/Orl_shape_space.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace orl_program {

namespace np = pcs::parameters;
using Space = pcs::Orl_shape_space<Kernel>;

struct Options
{
  std::vector<std::string> trees, skeletons;
  std::vector<double> lambda = {0, 0.25, 0.5, 0.75, 1};
  std::string output, matches, report, correspondences;
  std::string transport = "exact", orientation = "gauge-fixed";
  double maximal_turn = 45;
  bool do_limit_radii = false, is_published = false, is_quiet = false;
};

void declare(CLI::App& app, Options& o)
{
  app.footer(
      R"(Give --tree and --skeleton twice each: for the first and for the second tree. Points: PLY, LAS,
OFF or text. Skeletons: SWC, or .txtskl with layers of branches. Without --skeleton, skeletons
are extracted from the points; without --tree, only skeletons are made.

DIR gets lambda_0.250.ply and lambda_0.250.swc for each place on the path: 0 is the first tree,
1 the second; places beyond are allowed. Properties that both point files have are mixed.

Exit codes: 0 success, 1 bad input or usage, 2 internal error.)");
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--tree", o.trees, "points of a tree, twice")->allow_extra_args(false);
  app.add_option("--skeleton", o.skeletons, "skeleton of a tree, twice")->allow_extra_args(false);
  app.add_option("--lambda", o.lambda, "places on the path, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--output", o.output, "folder for the results; it is made")->required();
  app.add_option("--matches",
                 o.matches,
                 "write the ids of the tips of matched branches here (CSV)");
  app.add_option("--report", o.report, "write distances, counts and seconds here (JSON)");
  app.add_option("--correspondences",
                 o.correspondences,
                 "read what was computed before from this file, or write it if there is none");
  app.add_option("--transport", o.transport, "how points are matched")
      ->check(CLI::IsMember({"exact", "sinkhorn"}))
      ->capture_default_str();
  app.add_option("--orientation", o.orientation, "how orientations are measured")
      ->check(CLI::IsMember({"gauge-fixed", "transported", "world-axes"}))
      ->capture_default_str();
  app.add_option("--maximal-turn", o.maximal_turn, "of an edge beyond the ends [degrees]")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  app.add_flag("--limit-radii", o.do_limit_radii, "no branch thicker than where it grows from");
  app.add_flag("--published-energy", o.is_published, "match branches with the energy of the text");
  app.add_flag("--quiet", o.is_quiet, "print nothing but errors");
}

void check(const Options& o)
{
  if (o.trees.empty() && o.skeletons.empty())
    throw pcs::Invalid_input("expected --tree or --skeleton, twice");
  for (const auto& [name, files] :
       {std::make_pair("--tree", &o.trees), std::make_pair("--skeleton", &o.skeletons)})
    if (!files->empty() && files->size() != 2)
      throw pcs::Invalid_input(std::string(name) + " is given " + std::to_string(files->size()) +
                               " times, expected 2");
  for (const double l : o.lambda)
    if (!std::isfinite(l) || std::abs(l) > 1000)
      throw pcs::Invalid_input("--lambda must be finite numbers between -1000 and 1000");
}

std::string file_name(const Options& o, double lambda, const char* extension)
{
  char text[64];
  std::snprintf(text, sizeof(text), "lambda_%.3f%s", lambda == 0 ? 0.0 : lambda, extension);
  return (std::filesystem::path(o.output) / text).string();
}

void add(Space& space, const Tree_file& file)
{
  if (!file.has_valid_normals) {
    space.add(file.skeleton, file.points.points());
    return;
  }
  const std::vector<Table::Vector_3> normals = file.points.normals();
  std::vector<std::size_t> index(normals.size());
  for (std::size_t i = 0; i < index.size(); ++i)
    index[i] = i;
  space.add(file.skeleton,
            index,
            np::point_map(CGAL::make_property_map(file.points.points()))
                .normal_map(CGAL::make_property_map(normals)));
}

pcs::Orl_report build(Space& space, const Options& o)
{
  using namespace pcs::shape_space;
  program::Progress_line line(!o.is_quiet);
  Matching_weights weights;
  weights.is_published = o.is_published;
  Transport_options transport;
  if (o.transport == "sinkhorn")
    transport.method = Point_transport::sinkhorn;
  const Orientation orientation = o.orientation == "world-axes"    ? Orientation::world_axes
                                  : o.orientation == "transported" ? Orientation::transported
                                                                   : Orientation::gauge_fixed;
  const std::function<bool(double)> callback = [&](double f) {
    line.show("correspondences", f);
    return true;
  };
  const auto form = np::orientation(orientation);
  std::error_code error;
  if (!o.correspondences.empty() && std::filesystem::exists(o.correspondences, error))
    return space.build_from(pcs::IO::read_correspondences(o.correspondences), form);
  pcs::Orl_report report =
      space.build(form.matching_weights(weights).transport_options(transport).callback(callback));
  if (!o.correspondences.empty())
    pcs::IO::write_correspondences(o.correspondences, space.correspondences());
  return report;
}

void write_instance(const Space& space,
                    const Options& o,
                    double lambda,
                    const Tree_file& one,
                    const Tree_file& two,
                    bool has_points)
{
  const pcs::Orl_tree tree = space.geodesic(
      0,
      1,
      lambda,
      np::maximal_turn(o.maximal_turn * CGAL_PI / 180).do_limit_radii(o.do_limit_radii));
  Skeleton skeleton;
  space.skeleton(tree, skeleton);
  pcs::IO::write_swc(file_name(o, lambda, ".swc"), skeleton);
  if (!has_points)
    return;
  const std::size_t n = tree.number_of_points();
  std::vector<Table::Point_3> points(n);
  std::vector<Table::Vector_3> normals;
  if (one.has_valid_normals && two.has_valid_normals) {
    normals.resize(n);
    std::vector<std::size_t> index(n);
    for (std::size_t i = 0; i < n; ++i)
      index[i] = i;
    space.points(tree,
                 index,
                 np::point_map(CGAL::make_property_map(points))
                     .normal_map(CGAL::make_property_map(normals)));
  } else
    space.points(tree, points);
  Table out(std::move(points));
  if (!normals.empty())
    out.set_normals(normals);
  blend_properties(space, tree, one.points, two.points, out);
  pcs::IO::write_points(file_name(o, lambda, ".ply"), out);
}

std::string matches_text(const Space& space, const Tree_file& one, const Tree_file& two)
{
  std::ostringstream text;
  text << "tip_a,tip_b\n";
  for (const pcs::Branch_match& m : space.matches())
    text << (m.tip[0] == pcs::npos ? -1 : one.ids[m.tip[0]]) << ','
         << (m.tip[1] == pcs::npos ? -1 : two.ids[m.tip[1]]) << '\n';
  return text.str();
}

std::string report_text(const Space& space, const pcs::Orl_report& r)
{
  using pcs::shape_space::Orl_metric;
  const pcs::Orl_tree a = space.tree(0), b = space.tree(1);
  nlohmann::ordered_json json;
  json["status"] = pcs::to_string(r.status);
  json["distance"] = {{"sum", r.distance},
                      {"square", space.distance(a, b, np::metric(Orl_metric::square))},
                      {"cone", space.distance(a, b, np::metric(Orl_metric::cone))}};
  json["matching_energy"] = r.matching_energy;
  json["number_of_nodes"] = r.number_of_nodes;
  json["number_of_branches"] = r.number_of_branches;
  json["number_of_matched_branches"] = r.number_of_matched_branches;
  json["number_of_edges"] = r.number_of_edges;
  json["number_of_points"] = r.number_of_points;
  json["number_of_point_pairs"] = r.number_of_point_pairs;
  json["number_of_single_points"] = r.number_of_single_points;
  json["number_of_windows"] = r.number_of_windows;
  json["number_of_failed_windows"] = r.number_of_failed_windows;
  json["marginal_violation"] = {{"worst", r.worst_marginal_violation},
                                {"mean", r.mean_marginal_violation}};
  json["seconds"] = {{"matching", r.seconds.matching},
                     {"topology", r.seconds.topology},
                     {"assignment", r.seconds.assignment},
                     {"transport", r.seconds.transport},
                     {"instances", r.seconds.instances},
                     {"correspondences", r.seconds.total()}};
  return json.dump(2) + "\n";
}

void run(const Options& o)
{
  check(o);
  const auto file = [](const std::vector<std::string>& files, std::size_t i) {
    return files.empty() ? std::string() : files[i];
  };
  const Tree_file one = read_tree(file(o.trees, 0), file(o.skeletons, 0));
  const Tree_file two = read_tree(file(o.trees, 1), file(o.skeletons, 1));
  std::error_code error;
  std::filesystem::create_directories(o.output, error);
  if (!std::filesystem::is_directory(o.output))
    throw pcs::IO_error(o.output, "cannot be made a folder");
  std::optional<program::Report_file> matches, report_file;
  if (!o.matches.empty())
    matches.emplace(o.matches);
  if (!o.report.empty())
    report_file.emplace(o.report);

  Space space;
  add(space, one);
  add(space, two);
  const pcs::Orl_report report = build(space, o);
  for (const double lambda : o.lambda)
    write_instance(space, o, lambda, one, two, !o.trees.empty());
  if (matches)
    matches->commit(matches_text(space, one, two));
  if (report_file)
    report_file->commit(report_text(space, report));
  if (!o.is_quiet)
    std::cout << report << '\n';
}

int fail(int exit_code, const std::string& what)
{
  std::cerr << "orl_geodesic: " << what << '\n';
  return exit_code;
}

} // namespace orl_program

int main(int argc, char** argv)
{
  constexpr int bad_input = 1, internal_error = 2;
  orl_program::Options options;
  CLI::App app("Makes the trees on the way from one scanned tree to another.", "orl_geodesic");
  orl_program::declare(app, options);
  try {
    app.parse(argc, argv);
    orl_program::run(options);
    return 0;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0)
      return app.exit(e); // --help, --version
    return orl_program::fail(bad_input,
                             std::string(e.what()) + "\nRun with --help for more information.");
  } catch (const pcs::IO_error& e) {
    return orl_program::fail(bad_input, e.what());
  } catch (const pcs::Invalid_input& e) {
    return orl_program::fail(bad_input, e.what());
  } catch (const std::bad_alloc&) {
    return orl_program::fail(internal_error, "not enough memory");
  } catch (const std::exception& e) {
    return orl_program::fail(internal_error, std::string("internal error: ") + e.what());
  }
}
