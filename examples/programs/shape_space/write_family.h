// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Means, modes, random trees, growth and changes of a family of trees, as files.

#ifndef PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_WRITE_FAMILY_H
#define PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_WRITE_FAMILY_H

#include "Results.h"
#include "common/Progress_line.h"
#include "common/Report_file.h"
#include "write_tree.h"
#include <pcs/compare_trees.h>
#include <pcs/core/errors.h>
#include <pcs/find_modes.h>
#include <pcs/fit_growth_path.h>
#include <pcs/mean_tree.h>
#include <pcs/sample_tree.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace orl_program {

/// Writes a tree for each --scores.
inline void write_trees_of_scores(const Space& space,
                                  const pcs::Modes_of_variation& modes,
                                  const std::vector<Tree_file>& files,
                                  const Options& o)
{
  for (std::size_t i = 0; i < o.scores.size(); ++i)
    write_tree(space,
               pcs::tree_of_modes(space, modes, o.scores[i]),
               files,
               o,
               numbered("scores", i));
}

inline void write_modes(const Space& space, const std::vector<Tree_file>& files, const Options& o)
{
  program::Report_file report((std::filesystem::path(o.output) / "modes.json").string());
  const pcs::Modes_of_variation modes = pcs::find_modes(
      space,
      o.number_of_modes,
      np::mode_inner_product(o.mode_inner_product == "metric" ? pcs::Mode_inner_product::metric
                                                              : pcs::Mode_inner_product::branches));
  for (const std::vector<double>& scores : o.scores)
    if (scores.size() > modes.size())
      throw pcs::Invalid_input("--scores has " + std::to_string(scores.size()) + " numbers for " +
                               std::to_string(modes.size()) +
                               " modes; expected at most one per mode");
  if (modes.size() < o.number_of_modes && !o.is_quiet)
    std::cerr << "orl_geodesic: warning: these " << space.number_of_trees()
              << " trees have no more than " << modes.size() << " mode(s)\n";
  nlohmann::ordered_json json;
  json["number_of_modes"] = modes.size();
  json["measure"] =
      modes.features.measure == pcs::Mode_inner_product::metric ? "metric" : "branches";
  json["modes"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    nlohmann::ordered_json mode;
    mode["deviation"] = modes.deviations[i];
    mode["share_of_variance"] = modes.share(k + 1) - modes.share(k);
    mode["scores"] = std::vector<double>(modes.scores.col(i).begin(), modes.scores.col(i).end());
    mode["left_out_error"] = modes.left_out_error(k + 1);
    json["modes"].push_back(mode);
    for (const double side : {-2.0, 2.0}) {
      std::vector<double> scores(k, 0);
      scores.push_back(side);
      write_tree(space,
                 pcs::tree_of_modes(space, modes, scores),
                 files,
                 o,
                 "mode_" + std::to_string(k + 1) + (side < 0 ? "_minus" : "_plus"));
    }
  }
  write_trees_of_scores(space, modes, files, o);
  json["left_out_error_of_mean"] = modes.left_out_error(0);
  for (std::size_t h = 0; h < space.number_of_trees(); ++h)
    json["outlier_scores"].push_back(pcs::outlier_score(space, modes, space.tree(h)));
  report.commit(json);
}

inline void write_samples(const Space& space, const std::vector<Tree_file>& files, const Options& o)
{
  program::Progress_line line(!o.is_quiet);
  pcs::Tree_sampling_options options;
  options.do_keep_in_range = !o.may_leave_range;
  options.do_limit_radii = o.do_limit_radii;
  options.pipe_exponent = o.pipe_exponent;
  const pcs::Orl_distribution distribution = pcs::learn_distribution(space);
  for (std::size_t i = 0; i < o.number_of_samples; ++i) {
    line.show("random trees", static_cast<double>(i) / static_cast<double>(o.number_of_samples));
    write_tree(space,
               pcs::sample_tree(space,
                                distribution,
                                static_cast<std::uint64_t>(o.seed),
                                i,
                                np::sampling_options(options)),
               files,
               o,
               numbered("sample", i));
  }
}

inline void write_growth(const Space& space, const std::vector<Tree_file>& files, const Options& o)
{
  std::vector<Space::Handle> trees;
  std::vector<double> times = o.times;
  for (std::size_t h = 0; h < space.number_of_trees(); ++h) {
    trees.push_back(h);
    if (o.times.empty())
      times.push_back(static_cast<double>(h));
  }
  const auto path = pcs::fit_growth_path(space, trees, times, np::is_monotone(o.is_monotone));
  for (std::size_t i = 0; i < o.number_of_frames; ++i) {
    const double f = static_cast<double>(i) / static_cast<double>(o.number_of_frames - 1);
    write_tree(space,
               pcs::tree_at_time(space, path, (1 - f) * times.front() + f * times.back()),
               files,
               o,
               numbered("growth", i));
  }
}

inline std::string changes_text(const Space& space, const std::vector<Tree_file>& files)
{
  std::ostringstream text;
  text << "tip_a,tip_b,order,change,length_a,length_b,radius_a,radius_b,angle_degrees\n";
  for (const pcs::Branch_change& c : pcs::find_branch_changes(space, 0, 1)) {
    const auto id = [&](std::size_t h) {
      const std::size_t v = space.tip_of_branch(h, c.branch);
      return v == pcs::npos  ? std::int64_t(-1)
             : files.empty() ? static_cast<std::int64_t>(v)
                             : files[h].ids[v];
    };
    std::string what;
    const auto add = [&](bool is_so, const char* word) {
      if (is_so)
        what += (what.empty() ? "" : " ") + std::string(word);
    };
    add(c.is_new, "new");
    add(c.is_lost, "lost");
    add(c.is_longer, "longer");
    add(c.is_shorter, "shorter");
    add(c.is_thicker, "thicker");
    add(c.is_thinner, "thinner");
    add(c.is_turned, "turned");
    text << id(0) << ',' << id(1) << ',' << c.order << ',' << (what.empty() ? "same" : what) << ','
         << c.length[0] << ',' << c.length[1] << ',' << c.radius[0] << ',' << c.radius[1] << ','
         << c.angle * 180 / CGAL_PI << '\n';
  }
  return text.str();
}

inline std::string distances_text(const Space& space, pcs::Orl_metric metric)
{
  std::ostringstream text;
  text.precision(17);
  const std::size_t n = space.number_of_trees();
  const std::vector<double> distances = pcs::distance_matrix(space, np::metric(metric));
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      text << distances[a * n + b] << (b + 1 < n ? ',' : '\n');
  return text.str();
}

/// Writes all results except the files with a separate path.
inline void write_family(const Space& space, const std::vector<Tree_file>& files, const Options& o)
{
  using pcs::Tree_mean;
  if (o.do_mean)
    write_tree(space,
               pcs::mean_tree(
                   space,
                   np::tree_mean(o.mean_kind == "median" ? Tree_mean::median : Tree_mean::frechet)),
               files,
               o,
               "mean");
  if (!o.weights.empty())
    write_tree(space, pcs::weighted_mean(space, o.weights), files, o, "weighted_mean");
  if (o.number_of_modes > 0)
    write_modes(space, files, o);
  if (o.number_of_samples > 0)
    write_samples(space, files, o);
  if (o.do_growth)
    write_growth(space, files, o);
}

} // namespace orl_program

#endif // PCS_EXAMPLES_PROGRAMS_SHAPE_SPACE_WRITE_FAMILY_H
