// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Collects training data of the networks for leaf-wood separation: evidence about points and axes
// of virtual scans, with the true labels.

#include <pcs/core/errors.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session_impl.h>

#include <CGAL/Simple_cartesian.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace pcs::skeleton;
using Kernel = CGAL::Simple_cartesian<double>;
using pcs::Leaf_removal;
using Tree = pcs::Tree_skeleton<Kernel>;
using Scan_of_tree = pcs::Virtual_scan<Kernel>;
using Tag = CGAL::Parallel_if_available_tag;

enum class Label { leaf, wood, other };

/// Rows of numbers in single precision: scan, weight, label, output of the network in use,
/// features.
class Rows
{
public:
  explicit Rows(const std::filesystem::path& path)
    : m_path(path.string()), m_out(path, std::ios::binary)
  {
  }

  template <class Features>
  void add(unsigned scan, double weight, bool is_wood, double wood_score, const Features& features)
  {
    std::vector<float> row{float(scan), float(weight), float(is_wood), float(wood_score)};
    for (const double f : features)
      row.push_back(float(f));
    m_out.write(reinterpret_cast<const char*>(row.data()),
                static_cast<std::streamsize>(row.size() * sizeof(float)));
    ++m_count;
  }

  std::size_t close()
  {
    m_out.close();
    if (!m_out)
      throw pcs::IO_error(m_path, "cannot be written");
    return m_count;
  }

private:
  std::string m_path;
  std::ofstream m_out;
  std::size_t m_count = 0;
};

/// The rows of the three networks.
struct Evidence
{
  explicit Evidence(const std::filesystem::path& folder)
    : surroundings(folder / "surroundings.f32"),
      paths(folder / "paths.f32"),
      axes(folder / "axes.f32")
  {
  }

  Rows surroundings, paths, axes;
};

/// Repeats the rounds of leaf removal, and writes the evidence of each decision.
class Evidence_session
{
public:
  Evidence_session(const Scan_of_tree& input, unsigned seed, Evidence& evidence)
    : m_session(coordinates(input), {}, options()),
      m_seed(seed),
      m_evidence(evidence),
      m_input_node(input.node)
  {
  }

  void run(std::size_t number_of_points)
  {
    pcs::internal::Progress progress{std::function<bool(double)>()};
    m_session.find_paths(progress);
    if (m_state.root.empty())
      return;
    m_label.assign(m_scan.size(), Label::other);
    for (std::size_t i = 0; i < m_input_node.size(); ++i)
      m_label[m_scan.point_of_input[i]] = label_of(m_input_node[i]);
    fit();
    add_points(number_of_points);
    while (m_state.leaves.rounds + 1 < m_options.leaves.rounds) {
      if (!pcs::skeleton::internal::remove_leaves(m_state))
        return;
      fit();
      add_axes();
    }
  }

private:
  static std::vector<Vec3> coordinates(const Scan_of_tree& scan)
  {
    std::vector<Vec3> result;
    for (const auto& p : scan.points)
      result.emplace_back(p.x(), p.y(), p.z());
    return result;
  }

  static Session_options options()
  {
    Session_options o;
    o.leaf_removal = Leaf_removal::always;
    return o;
  }

  static Label label_of(int node)
  {
    return node >= 0 ? Label::wood : node == pcs::scan_label_leaf ? Label::leaf : Label::other;
  }

  void fit()
  {
    m_state.axes = pcs::skeleton::fit_axes<Tag>(m_scan, m_state.layers, m_options.axes, [](double) {
      return true;
    });
  }

  /// Adds a random subset of the points outside thick wood, since thick wood is certain.
  void add_points(std::size_t number_of_points)
  {
    const Leaf_options& rules = m_options.leaves;
    const std::vector<std::uint8_t>& is_used = m_state.is_used();
    const std::vector<std::uint8_t> is_thick =
        points_on_hollow_sections<Tag>(m_scan, m_state.axes, rules.hollow);
    std::vector<Surroundings> surroundings(m_scan.size());
    std::vector<float> wood_score(m_scan.size());
    points_on_lines<Tag>(
        m_scan,
        is_used,
        is_thick,
        rules.lines,
        [&](std::size_t i, const pcs::skeleton::internal::Line_search& search, float score) {
          surroundings[i] = search.surroundings(score);
          wood_score[i] = static_cast<float>(wood_probability(surroundings[i]));
        });
    const std::vector<float> score = scores_of_surroundings(is_used, is_thick, wood_score);
    const std::vector<Path_context> path =
        path_contexts(m_scan, m_state.paths, score, rules.paths.reach * m_scan.spacing);

    std::vector<Index> open;
    for (Index i = 0; i < m_scan.size(); ++i)
      if (is_used[i] && !is_thick[i] && m_label[i] != Label::other)
        open.push_back(i);
    pcs::internal::Random_stream random(m_seed, 1, 0);
    const std::size_t count = std::min(number_of_points, open.size());
    std::vector<Index> near;
    for (std::size_t k = 0; k < count; ++k) {
      const auto other = k + static_cast<std::size_t>(random.uniform() * double(open.size() - k));
      std::swap(open[k], open[std::min(other, open.size() - 1)]);
      const Index i = open[k];
      const bool is_wood = m_label[i] == Label::wood;
      near.clear();
      m_scan.search->append_within(m_scan.points[i], rules.paths.radius * m_scan.spacing, near);
      const Wood_evidence e = evidence_of_point(m_scan, is_used, score, path, i, near);
      m_evidence.surroundings.add(m_seed,
                                  1,
                                  is_wood,
                                  double(wood_score[i]),
                                  surroundings[i].features());
      m_evidence.paths.add(m_seed, 1, is_wood, wood_probability(e), e.features());
    }
  }

  /// Labels an axis as wood if a fifth of its points are wood.
  void add_axes()
  {
    const std::vector<Axis_evidence> evidence = evidence_of_axes<Tag>(m_scan,
                                                                      m_state.axes,
                                                                      m_state.is_used(),
                                                                      m_state.paths,
                                                                      m_state.leaves.wood_score,
                                                                      m_options.breast_height);
    const Index_groups points_of_axis(evidence.size(), m_state.axes.axis_of_point);
    for (std::size_t a = 0; a < evidence.size(); ++a) {
      std::size_t wood = 0, count = 0;
      for (const Index i : points_of_axis[a]) {
        wood += m_label[i] == Label::wood;
        count += m_label[i] != Label::other;
      }
      if (count > 0)
        m_evidence.axes.add(m_seed,
                            evidence[a].length,
                            5 * wood >= count,
                            wood_probability(evidence[a]),
                            evidence[a].features());
    }
  }

  pcs::skeleton::Session<Tag> m_session;
  pcs::skeleton::Session_state<Tag>& m_state = m_session.state();
  const Session_options& m_options = m_state.options;
  const pcs::skeleton::Scan& m_scan = m_state.scan;
  unsigned m_seed;
  Evidence& m_evidence;
  const std::vector<int>& m_input_node;
  std::vector<Label> m_label; ///< of the points of the scan
};

/// Cycles through the five presets, with one to four stations, and few to many leaves of different
/// sizes.
Scan_of_tree scan_with_leaves(unsigned seed)
{
  pcs::internal::Random_stream random(seed, 0, 0);
  const auto between = [&](double low, double high) { // uniform in the logarithm
    return low * std::pow(high / low, random.uniform());
  };
  const auto habits = pcs::tree_habits();
  Tree tree;
  pcs::grow_tree(tree, habits[seed % habits.size()].second, pcs::parameters::random_seed(seed));
  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = 1 + static_cast<std::size_t>(3.999 * random.uniform());
  scanner.angular_step = between(0.05, 0.2) * CGAL_PI / 180;
  scanner.range_noise = between(0.0015, 0.004);
  scanner.leaves_per_length = between(2, 40);
  scanner.leaf_radius = between(0.015, 0.05);
  Scan_of_tree scan;
  pcs::scan_tree(tree, scan, scanner, pcs::parameters::random_seed(seed));
  return scan;
}

} // namespace

int main(int argc, char** argv)
{
  unsigned seed = 1, scans = 60;
  std::size_t points = 5000;
  std::string folder;
  CLI::App app("Writes the evidence about points and axes of virtual scans with leaves, and "
               "whether they are "
               "of wood, for fit_network.py.",
               "collect_wood_evidence");
  app.add_option("--seed", seed, "of the first scan")->capture_default_str();
  app.add_option("--scans", scans, "their number")->capture_default_str();
  app.add_option("--points", points, "at most, of each scan")->capture_default_str();
  app.add_option("--output", folder, "folder for surroundings.f32, paths.f32, axes.f32")
      ->required();
  try {
    app.parse(argc, argv);
    std::filesystem::create_directories(folder);
    Evidence evidence(folder);
    for (unsigned s = seed; s < seed + scans; ++s) {
      const Scan_of_tree scan = scan_with_leaves(s);
      Evidence_session(scan, s, evidence).run(points);
      std::cerr << '\r' << s + 1 - seed << " of " << scans << " scans" << std::flush;
    }
    std::cerr << '\n';
    evidence.surroundings.close();
    const std::size_t rows = evidence.paths.close();
    std::cout << rows << " points, " << evidence.axes.close() << " axes\n";
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    std::cerr << "collect_wood_evidence: " << e.what() << '\n';
    return 1;
  }
}
