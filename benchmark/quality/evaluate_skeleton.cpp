// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares a skeleton in a file with the true one.

#include "common/Distinct_files.h"
#include "common/run_program.h"
#include "measure_skeleton.h"
#include "print_accuracy.h"
#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/read_cylinders.h>
#include <pcs/IO/read_points.h>
#include <pcs/IO/read_swc.h>
#include <pcs/IO/read_tree_csv.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

namespace {

void read_tree(const std::string& path, Tree& tree, std::vector<std::size_t>& hits)
{
  const std::string extension = std::filesystem::path(path).extension().string();
  pcs::IO::Tree_selection selection;
  if ((extension == ".csv" || extension == ".txt") && pcs::IO::is_cylinder_table(path))
    selection = pcs::IO::read_cylinders<Kernel>(path, tree);
  else if (extension == ".csv")
    pcs::IO::read_tree_csv<Kernel>(path, tree, hits);
  else
    selection = pcs::IO::read_swc<Kernel>(path, tree);
  for (const std::string& sentence : warnings(selection))
    std::cerr << "evaluate_skeleton: warning: " << path << ": " << sentence << '\n';
}

/// The points of a scan, without those that a virtual scan labels as ghosts and outliers.
std::vector<Kernel::Point_3> read_wood(const std::string& path)
{
  const pcs::IO::Point_table table = pcs::IO::read_points(path);
  if (!table.has_property("node"))
    return table.points();
  const std::vector<double> node = table.property_as_double("node");
  std::vector<Kernel::Point_3> points;
  for (std::size_t i = 0; i < node.size(); ++i)
    if (node[i] >= 0)
      points.push_back(table.points()[i]);
  return points;
}

void write_text(const std::string& path, const std::string& text)
{
  pcs::IO::internal::Output_file file(path);
  file.write(text);
  file.commit();
}

} // namespace

int main(int argc, char** argv)
{
  std::string truth_file, result_file, point_file, json_file;
  bool is_quiet = false;
  pcs_bench::Accuracy_rules rules;
  CLI::App app("Compares a tree skeleton with the true one; lengths in metres.",
               "evaluate_skeleton");
  app.add_option("--truth", truth_file, "true tree: csv with hits, or swc")->required();
  app.add_option("--result", result_file, "tree to evaluate: swc or csv")->required();
  app.add_option("--points", point_file, "scan, for the distance to the surface of the result");
  app.add_option("--json", json_file, "write all values here");
  app.add_option("--step", rules.sampling_step, "axes are sampled at this distance")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_flag("--quiet", is_quiet, "print no tables");
  return program::run_program(app, argc, argv, "--truth truth.csv --result my.swc", [&] {
    program::Distinct_files files;
    for (const std::string& path : {truth_file, result_file, point_file})
      files.add_input(path);
    files.add_output(json_file);
    Tree truth, result;
    std::vector<std::size_t> hits, unused;
    read_tree(truth_file, truth, hits);
    read_tree(result_file, result, unused);
    auto accuracy = pcs_bench::measure_skeleton<Kernel>(truth, hits, result, rules);
    if (!point_file.empty())
      accuracy.point_to_surface =
          pcs_bench::point_to_surface_distances<Kernel>(result, read_wood(point_file));
    if (!json_file.empty())
      write_text(json_file, pcs_bench::to_json(accuracy).dump(2) + "\n");
    if (!is_quiet)
      pcs_bench::print(std::cout, accuracy);
    return true;
  });
}
