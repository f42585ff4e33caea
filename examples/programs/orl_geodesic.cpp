// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: computes trees between and beyond scanned trees, their mean, and similar random trees.

#include "common/run_program.h"
#include "common/unit_warning.h"
#include "common/up_direction.h"
#include "shape_space/Results.h"
#include "shape_space/Tree_file.h"
#include "shape_space/align_trees.h"
#include "shape_space/write_family.h"
#include <pcs/IO/read_correspondences.h>
#include <pcs/IO/read_shape_space.h>
#include <pcs/IO/write_correspondences.h>
#include <pcs/IO/write_shape_space.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace orl_program {

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

/// Whether branches and points were matched in an earlier run, whose method is unknown.
bool is_stored(const Options& o)
{
  std::error_code error;
  return !o.load.empty() ||
         (!o.correspondences.empty() && std::filesystem::exists(o.correspondences, error));
}

pcs::Matching_weights weights_of(const Options& o)
{
  pcs::Matching_weights weights;
  weights.is_published = o.method.is_published;
  return weights;
}

/// Describes the method of matching branches and points, for files of correspondences.
std::string method(const Options& o)
{
  std::string text = "--align " + o.align + " --up " + o.up;
  for (const auto& [name, value] : point_method(o.method))
    text += " " + name + " " + value;
  return text + (o.method.is_published ? " --published-energy" : "");
}

/// Reads stored correspondences. Options may repeat the stored method, but not change it.
pcs::Orl_correspondences read_stored(const Options& o)
{
  pcs::Orl_correspondences stored = pcs::IO::read_correspondences(o.correspondences);
  std::vector<std::pair<std::string, std::string>> options = point_method(o.method);
  options.insert(options.begin(), {{"--align", o.align}, {"--up", o.up}});
  for (auto& [name, value] : options)
    value.insert(0, " ");
  options.emplace_back("--published-energy", "");
  for (const auto& [name, value] : options)
    if (o.is_given(name) && (stored.note + " ").find(name + value + " ") == std::string::npos)
      throw pcs::Invalid_input(o.correspondences + ": made with other options (" + stored.note +
                               ") than " + name + value + "; leave this out, or name another file");
  return stored;
}

pcs::Orl_report
build(Space& space, const Options& o, const std::optional<pcs::Orl_correspondences>& stored)
{
  program::Progress_line line(!o.is_quiet);
  const std::function<bool(double)> callback = [&](double f) {
    line.show("correspondences", f);
    return true;
  };
  const auto form =
      np::orientation(orientation(o.method)).virtual_direction(virtual_direction(o.method));
  if (stored)
    try {
      return space.build_from(*stored, form);
    } catch (const pcs::Invalid_input& refusal) {
      throw pcs::Invalid_input(o.correspondences + ": " + refusal.what());
    }
  // more than two trees keep their given orientation
  const bool may_turn = o.align == "yaw" && o.number_of_trees() == 2;
  pcs::Orl_report report = space.build(
      form.matching_weights(weights_of(o))
          .assignment_options(assignment_options(o.method))
          .transport_options(transport_options(o.method))
          .alignment(may_turn ? pcs::Orl_alignment::rotate_about_up : pcs::Orl_alignment::as_given)
          .up_direction(program::up_direction<Kernel>(o.up))
          .callback(callback));
  line.clear();
  if (report.number_of_failed_windows > 0 && !o.is_quiet)
    std::cerr << "orl_geodesic: warning: the transport of points did not converge in "
              << report.number_of_failed_windows << " of " << report.number_of_windows
              << " windows; use a larger --sinkhorn-epsilon, or --transport exact\n";
  if (!o.correspondences.empty()) {
    pcs::Orl_correspondences found = space.correspondences();
    found.note = method(o);
    pcs::IO::write_correspondences(o.correspondences, found);
  }
  return report;
}

/// Selects sequential emergence if branches of one of two trees continue at the tips of those of
/// the other, as in growth at the tips.
pcs::Branch_emergence branch_emergence(const Space& space, const Options& o)
{
  using pcs::Branch_emergence;
  bool is_in_order = o.do_order_births;
  if (!is_in_order && !o.do_join_births && o.load.empty() && o.number_of_trees() == 2)
    for (const auto& branch : space.correspondences().branches)
      is_in_order = is_in_order || branch.is_continued[0] || branch.is_continued[1];
  return is_in_order ? Branch_emergence::sequential : Branch_emergence::simultaneous;
}

std::string matches_text(const Space& space, const Tree_file& one, const Tree_file& two)
{
  std::ostringstream text;
  text << "tip_a,tip_b,confidence\n";
  for (const pcs::Branch_match& m : space.matches()) {
    text << (m.tip[0] == pcs::npos ? -1 : one.ids[m.tip[0]]) << ','
         << (m.tip[1] == pcs::npos ? -1 : two.ids[m.tip[1]]) << ',';
    if (std::isfinite(m.confidence))
      text << m.confidence;
    text << '\n';
  }
  return text.str();
}

/// Makes the report; values that were not computed in this run are omitted.
nlohmann::ordered_json report_json(const Space& space,
                                   const pcs::Orl_report& r,
                                   const std::vector<Tree_file>& files,
                                   const Options& o,
                                   bool is_stored,
                                   const std::vector<double>& turns)
{
  using pcs::Orl_metric;
  const pcs::Orl_tree a = space.tree(0), b = space.tree(1);
  nlohmann::ordered_json json;
  json["status"] = pcs::to_string(r.status);
  json["distance"] = {{"sum", r.distance},
                      {"square", space.distance(a, b, np::metric(Orl_metric::square))},
                      {"cone", space.distance(a, b, np::metric(Orl_metric::cone))},
                      {"published", space.distance(a, b, np::metric(Orl_metric::published))}};
  json["number_of_trees"] = r.number_of_trees;
  json["number_of_common_branches"] = r.number_of_common_branches;
  const bool is_pair = r.number_of_trees == 2;
  if (!is_stored && is_pair) {
    json["matching_energy"] = r.matching_energy;
    json["unexplained_fraction"] = r.unexplained_fraction;
    json["is_grown_at_tips"] = r.is_grown_at_tips;
    json["yaw_degrees"] = r.yaw * 180 / CGAL_PI;
  }
  if (!is_stored) {
    if (!is_pair)
      json["fraction_of_changed_matches"] = r.fraction_of_changed_matches;
    for (const double turn : turns)
      json["yaws_degrees"].push_back(turn * 180 / CGAL_PI);
    json["number_of_windows"] = r.number_of_windows;
    json["number_of_failed_windows"] = r.number_of_failed_windows;
    json["marginal_violation"] = {{"worst", r.worst_marginal_violation},
                                  {"mean", r.mean_marginal_violation}};
    json["mean_remaining_mass"] = r.untransported_mass_share;
  }
  json["number_of_edges"] = r.number_of_edges;
  if (o.load.empty()) {
    for (const Tree_file& file : files)
      json["number_of_nodes"].push_back(num_vertices(file.skeleton));
    if (is_pair) {
      json["number_of_branches"] = r.number_of_branches;
      json["number_of_matched_branches"] = r.number_of_matched_branches;
    }
    json["number_of_whorls"] = r.number_of_whorls;
    json["number_of_broken_whorls"] = r.number_of_broken_whorls;
    for (const Tree_file& file : files)
      json["number_of_points"].push_back(file.points.number_of_points());
    json["number_of_point_pairs"] = r.number_of_point_pairs;
    json["number_of_unmatched_points"] = r.number_of_unmatched_points;
  }
  json["seconds"] = {{"matching", r.seconds.matching},
                     {"topology", r.seconds.topology},
                     {"assignment", r.seconds.assignment},
                     {"transport", r.seconds.transport},
                     {"instances", r.seconds.instances},
                     {"correspondences", r.seconds.total()}};
  return json;
}

/// Says which arrangements of branches are not kept between trees.
void warn_of_whorls(const Options& o, const pcs::Orl_report& r)
{
  for (std::size_t t = 0; t < r.number_of_broken_whorls.size() && !o.is_quiet; ++t)
    if (r.number_of_broken_whorls[t] > 0)
      std::cerr << "orl_geodesic: warning: " << r.number_of_broken_whorls[t] << " of "
                << r.number_of_whorls[t] << " opposite pairs or whorls of branches of "
                << (o.skeletons.empty() ? o.trees : o.skeletons)[t] << " separate on the path"
                << (r.number_of_trees > 2 ? " to other trees" : "")
                << ", because their partners begin at different places\n";
}

/// Returns which tree is read from the skeleton file `i`.
Root_number root_number(const Options& o, std::size_t i)
{
  if (o.root_numbers.empty())
    return {};
  if (o.root_numbers.size() == 1)
    return {o.root_numbers.front(), true};
  return {o.root_numbers[i], false};
}

/// Says why results do not have the normals of the scans although a file has some.
void warn_of_normals(const Options& o, const std::vector<Tree_file>& files)
{
  if (o.is_quiet || o.method.normals == "across")
    return;
  for (std::size_t i = 0; i < files.size(); ++i)
    if (const std::size_t n = files[i].number_of_bad_normals; n > 0)
      std::cerr << "orl_geodesic: warning: " << o.trees[i] << ": " << n << " of "
                << files[i].points.number_of_points() << " normals are zero or not finite, so "
                << (o.method.normals == "scans"
                        ? "no normals are written; --normals across needs none\n"
                        : "the normals that are written are orthogonal to the branches\n");
}

/// Reads all files before skeletons are computed, which takes time.
std::vector<Tree_file> read_trees(const Options& o)
{
  std::vector<Tree_file> files;
  const auto file = [](const std::vector<std::string>& names, std::size_t i) {
    return names.empty() ? std::string() : names[i];
  };
  for (std::size_t i = 0; i < o.number_of_trees(); ++i) {
    std::string warning;
    files.push_back(read_tree(file(o.trees, i), file(o.skeletons, i), root_number(o, i), warning));
    for (const std::string& w : files.back().points.schema().warnings)
      if (!o.is_quiet)
        std::cerr << "orl_geodesic: warning: " << file(o.trees, i) << ": " << w << '\n';
    if (!warning.empty() && !o.is_quiet)
      std::cerr << "orl_geodesic: warning: " << warning << '\n';
  }
  const bool are_single = std::all_of(files.begin(), files.end(), [](const Tree_file& f) {
    return f.number_of_trees_in_file <= 1;
  });
  if (are_single && o.root_numbers.size() == 1 && o.root_numbers.front() > 1)
    throw pcs::Invalid_input("--root-number " + std::to_string(o.root_numbers.front()) +
                             " has no effect: no file of --skeleton has more than one tree");
  warn_of_normals(o, files);
  return files;
}

/// Warns if two skeletons seem to have different units or origins: the path between them then
/// changes its size, or moves far away.
void warn_of_places(const Options& o, const std::vector<Tree_file>& files)
{
  constexpr double largest_ratio = 100;
  const auto root_of = [](const Tree_file& file) {
    return file.skeleton[file.skeleton[boost::graph_bundle].root].point;
  };
  const std::vector<std::string>& names = o.skeletons.empty() ? o.trees : o.skeletons;
  for (std::size_t i = 1; i < files.size() && !o.is_quiet; ++i) {
    const double a = program::extent(files[0].skeleton), b = program::extent(files[i].skeleton);
    const double distance = std::sqrt(CGAL::squared_distance(root_of(files[0]), root_of(files[i])));
    std::ostringstream text;
    text << program::unit_warning(a, b);
    if (text.str().empty() && distance > largest_ratio * std::max(a, b))
      text << "the roots are " << distance << " apart, and the extents are " << a << " and " << b
           << "; check the units and origins of both trees";
    if (!text.str().empty())
      std::cerr << "orl_geodesic: warning: " << names[0] << " and " << names[i] << ": "
                << text.str() << '\n';
  }
}

void complete_trees(const Options& o, std::vector<Tree_file>& files)
{
  for (std::size_t i = 0; i < files.size(); ++i)
    complete_tree(files[i], o.trees.empty() ? "" : o.trees[i], o.do_extend_axes, o.up);
}

/// A file with a separate path. Whether it can be written is checked before the computation.
class Extra_file
{
public:
  explicit Extra_file(const std::string& path)
  {
    if (!path.empty())
      m_file.emplace(path);
  }
  template <class Text>
  void write(const Text& text)
  {
    if (m_file)
      m_file->commit(text());
  }

private:
  std::optional<program::Report_file> m_file;
};

void run(const Options& o)
{
  check(o);
  check_files(o);
  const bool was_stored = is_stored(o);
  const Result_folder folder(o.output);
  Extra_file matches(o.matches), report_file(o.report), changes(o.changes), distances(o.distances);
  probe_file(o.save);
  if (!was_stored)
    probe_file(o.correspondences);
  std::vector<Tree_file> files = read_trees(o);
  Space space;
  if (!o.load.empty()) {
    space.restore(pcs::IO::read_shape_space(o.load));
    check_numbers(o, space.number_of_trees());
    check_points(o, space.has_points());
  }
  std::optional<pcs::Orl_correspondences> stored;
  if (was_stored && o.load.empty())
    stored = read_stored(o);
  complete_trees(o, files);
  warn_of_places(o, files);

  std::vector<double> turns; // angles of more than two trees, which are stored rotated
  pcs::Orl_report report;
  if (o.load.empty()) {
    for (std::size_t i = 0; i < files.size(); ++i)
      try {
        add(space, files[i]);
      } catch (const pcs::Invalid_input& refusal) {
        throw pcs::Invalid_input((o.skeletons.empty() ? o.trees : o.skeletons)[i] + ": " +
                                 refusal.what());
      }
    if (files.size() > 2 && o.is_given("--align") && o.align == "yaw") {
      turns = align_trees(files, o.up, weights_of(o));
      space = Space();
      for (const Tree_file& file : files)
        add(space, file);
    }
    report = build(space, o, stored);
    warn_of_whorls(o, report);
  } else {
    report.status = pcs::Status::converged;
    report.number_of_trees = space.number_of_trees();
    report.number_of_common_branches = space.family().layout.branches.size();
    report.number_of_edges = space.family().layout.number_of_edges();
    report.distance = space.distance(Space::Handle(0), Space::Handle(1));
  }
  if (!o.save.empty())
    pcs::IO::write_shape_space(o.save, space.data());
  if (o.has_places()) {
    const auto path = np::max_extrapolation_angle(o.max_extrapolation_angle * CGAL_PI / 180)
                          .extrapolation(extrapolation(o.method))
                          .do_limit_radii(o.do_limit_radii)
                          .branch_emergence(branch_emergence(space, o));
    for (const double lambda : o.lambda)
      write_tree(space, space.geodesic(0, 1, lambda, path), files, o, name_of(lambda));
  }
  write_family(space, files, o);
  if (files.size() == 2)
    matches.write([&] { return matches_text(space, files[0], files[1]); });
  changes.write([&] { return changes_text(space, files); });
  distances.write([&] { return distances_text(space, metric(o.method)); });
  report_file.write([&] { return report_json(space, report, files, o, was_stored, turns); });
  if (!o.is_quiet && o.load.empty())
    std::cout << report << '\n';
}

} // namespace orl_program

int main(int argc, char** argv)
{
  orl_program::Options options;
  CLI::App app("Makes trees between scanned trees, beyond them, and like them.", "orl_geodesic");
  orl_program::declare(app, options);
  return program::run_program(app,
                              argc,
                              argv,
                              "--tree a.ply --tree b.ply --lambda 0,0.5,1 --output results",
                              [&] {
                                orl_program::run(options);
                                return true;
                              });
}
