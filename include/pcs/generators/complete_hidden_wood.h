// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Infers the wood of a tree that no beam of the scanner reached.

#ifndef PCS_GENERATORS_COMPLETE_HIDDEN_WOOD_H
#define PCS_GENERATORS_COMPLETE_HIDDEN_WOOD_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Tree_measures.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/generators/Hidden_wood.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/habit/check_tree.h>
#include <pcs/generators/hidden/Beam_visibility.h>
#include <pcs/generators/hidden/estimate_hidden_wood.h>
#include <pcs/internal/text.h>

#include <CGAL/number_utils.h>
#include <CGAL/property_map.h>
#include <CGAL/tags.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace internal {

/// The named parameters of `complete_hidden_wood()`, and the points of each station.
struct Hidden_wood_input
{
  std::uint64_t seed = 0;
  std::size_t number_of_simulations = 100;
  double angular_step = 0;
  std::vector<Eigen::Vector3d> stations;
  std::vector<std::vector<Eigen::Vector3d>> points;
  double grid_share = 1; ///< found with the views; see `Hidden_wood`
};

constexpr const char* hidden_wood_caller = "pcs::complete_hidden_wood()";

/// Throws `Invalid_input` with `name` unless all coordinates are finite.
template <class Point>
Eigen::Vector3d finite_vector(const Point& p, const char* name)
{
  const Eigen::Vector3d v(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
  check(v.allFinite(), hidden_wood_caller, std::string(name) + " must be finite");
  return v;
}

template <class NamedParameters>
Hidden_wood_input read_hidden_wood_input(const NamedParameters& np)
{
  namespace tags = internal_np;
  check_names<CGAL::internal_np::random_seed_t,
              CGAL::internal_np::point_t,
              tags::number_of_simulations_t,
              tags::scanner_positions_t,
              tags::station_map_t,
              tags::angular_step_t>(np);
  Hidden_wood_input input;
  constexpr bool is_number = is_integer_parameter_v<NamedParameters, tags::number_of_simulations_t>;
  static_assert(is_number,
                "pcs::complete_hidden_wood(): named parameter `number_of_simulations` must be an "
                "integer");
  static_assert(is_integer_parameter_v<NamedParameters, CGAL::internal_np::random_seed_t>,
                "pcs::complete_hidden_wood(): named parameter `random_seed` must be an integer");
  static_assert(is_parameter_v<double, NamedParameters, tags::angular_step_t>,
                "pcs::complete_hidden_wood(): named parameter `angular_step` must be a number");
  if constexpr (is_number)
    input.number_of_simulations = check_count(
        hidden_wood_caller,
        "number_of_simulations",
        choose(np, tags::number_of_simulations, static_cast<int>(input.number_of_simulations)),
        20,
        100'000);
  input.seed = read_random_seed(np);
  read_parameter(np, tags::angular_step, input.angular_step);
  check_at_least(hidden_wood_caller, "angular_step", input.angular_step, 0);
  if constexpr (is_given_v<NamedParameters, tags::scanner_positions_t>) {
    const auto& positions = CGAL::parameters::get_parameter_reference(np, tags::scanner_positions);
    using Position = std::decay_t<decltype(*std::begin(positions))>;
    static_assert(
        is_coordinate_triple_v<Position>,
        "pcs::complete_hidden_wood(): named parameter `scanner_positions` must be a range "
        "of points with x(), y(), z()");
    for (const auto& p : positions)
      input.stations.push_back(finite_vector(p, "scanner_positions"));
  }
  check(!input.stations.empty(),
        hidden_wood_caller,
        "no station is known; pass scanner_positions(), a range of points in the coordinates of "
        "the scan, as Virtual_scan::stations or the positions in the headers of PTX files");
  input.points.resize(input.stations.size());
  return input;
}

/// Sorts the points by stations.
template <class PointRange, class NamedParameters>
void read_station_points(const PointRange& points,
                         const NamedParameters& np,
                         Hidden_wood_input& input)
{
  namespace tags = internal_np;
  using Element = std::decay_t<decltype(*std::begin(points))>;
  const auto map = choose(np, CGAL::internal_np::point_map, CGAL::Identity_property_map<Element>());
  static_assert(is_coordinate_triple_v<std::decay_t<decltype(get(map, *std::begin(points)))>>,
                "pcs::complete_hidden_wood(): named parameter `point_map` must be readable, accept "
                "an element of `points` as key, and store points with x(), y(), z()");
  constexpr bool are_labelled = is_given_v<NamedParameters, tags::station_map_t>;
  const std::size_t number = input.stations.size();
  check(are_labelled || number == 1,
        hidden_wood_caller,
        std::to_string(number) + " stations are given; pass station_map(), the index of the "
                                 "station of each point in scanner_positions()");
  for (const Element& element : points) {
    std::size_t station = 0;
    if constexpr (are_labelled) {
      const auto labels = CGAL::parameters::get_parameter(np, tags::station_map);
      using Label = std::decay_t<decltype(get(labels, element))>;
      static_assert(std::is_integral_v<Label>,
                    "pcs::complete_hidden_wood(): named parameter `station_map` must be readable, "
                    "accept an element of `points` as key, and store an integer type");
      const auto label = static_cast<long long>(get(labels, element));
      if (label < 0)
        continue;
      station = static_cast<std::size_t>(label);
      check(station < number,
            hidden_wood_caller,
            "station_map() has the station " + std::to_string(label) +
                ", counted from 0, but there are only " + std::to_string(number) +
                " scanner_positions(); negative: unknown");
    }
    input.points[station].push_back(finite_vector(get(map, element), "points"));
  }
}

/// Returns the angle between the beams of station `s`, and lowers `grid_share`.
inline double angular_step_of(Hidden_wood_input& input, std::size_t s)
{
  constexpr double least_grid_share = 0.5;
  const auto distances = generators::hidden::distances_of_beams(input.stations[s], input.points[s]);
  const bool is_given = input.angular_step > 0;
  const double step = is_given ? input.angular_step : distances.step();
  const double share = distances.share_at(step);
  const std::string way_on = "check that the position of station " + std::to_string(s) +
                             " in scanner_positions() is in the coordinates of `points`, and that "
                             "`points` has all returns "
                             "of this station and is not thinned, or pass angular_step() [rad]";
  check(is_given || share >= least_grid_share,
        hidden_wood_caller,
        "the angle between beams is not recognised, because the returns are not on a grid of "
        "directions; " +
            way_on);
  check(step >= 1e-6 && step < 0.5,
        hidden_wood_caller,
        "the angle between beams must be at least 1e-6 and less than 0.5 rad, found " +
            to_text(step) + "; " + way_on);
  input.grid_share = std::min(input.grid_share, share);
  return step;
}

/// Returns the views of all stations with points. Sets the angular step if it is not given.
inline generators::hidden::Beam_visibility visibility_of(Hidden_wood_input& input)
{
  namespace hidden = generators::hidden;
  constexpr double largest_crowded_share = 0.5;
  std::vector<hidden::Station_view> views;
  double largest_step = 0;
  for (std::size_t s = 0; s < input.stations.size(); ++s) {
    if (input.points[s].empty())
      continue;
    const double step = angular_step_of(input, s);
    largest_step = std::max(largest_step, step);
    views.emplace_back(input.stations[s], input.points[s], step);
    check(views.back().crowded_share() < largest_crowded_share,
          hidden_wood_caller,
          "most points of station " + std::to_string(s) +
              " are in directions with more than twice as many points as beams; angular_step() is "
              "too large, or `points` has other stations as well");
  }
  check(!views.empty(), hidden_wood_caller, "`points` has no point of a station; pass the scan");
  input.angular_step = largest_step;
  return hidden::Beam_visibility(std::move(views));
}

/// Adds the inferred branches to the graph of the result.
template <class Kernel>
void add_inferred_branches(const generators::habit::Tree_sample& sample,
                           const std::vector<generators::hidden::Inferred_branch>& branches,
                           Hidden_wood<Kernel>& result)
{
  using FT = typename Kernel::FT;
  auto& tree = result.branches;
  auto& bundle = tree[boost::graph_bundle];
  const std::size_t first = sample.axes.size();
  std::vector<std::size_t> base(branches.size());
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const auto& branch = branches[b];
    const bool is_on_measured = branch.parent < first;
    bundle.branches.push_back({is_on_measured ? npos : branch.parent - first, branch.order, npos});
    base[b] = num_vertices(tree);
    for (std::size_t i = 0; i < branch.points.size(); ++i) {
      const auto& p = branch.points[i];
      const std::size_t v = add_vertex(tree);
      tree[v].point = typename Kernel::Point_3(FT(p.x()), FT(p.y()), FT(p.z()));
      tree[v].radius = tree[v].major_radius = tree[v].minor_radius = FT(branch.radii[i]);
      tree[v].branch = b;
      result.attached_to.push_back(npos);
      if (i > 0)
        add_edge(v - 1, v, tree);
      else if (is_on_measured)
        result.attached_to.back() = sample.axes[branch.parent].nodes[branch.place];
      else
        add_edge(base[branch.parent - first] + branch.place, v, tree);
    }
  }
  bundle.root = branches.empty() ? npos : 0;
}

} // namespace internal

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief infers the wood that the scanner cannot have shown, apart from the measured wood.

  The stations and the angle between their beams are known, and so is the share of the beams that
  pass any position: those without a return before it. Three kinds of wood are inferred:

  - Branches in places that few beams reach. Branches grow on the measured axes by the habit. The
    share of each that a skeleton would contain follows from the beams that reach it. The density of
    branches is scaled so that this part has the measured volume, separately for branches on stems,
    on branches and on twigs; the other part is hidden.
  - Thick stems, where the area of the section of an axis is larger than that of the axes that
    continue it (the pipe model), and beams end before or near the place of the missing one.
  - The volume of measured axes that are partly hidden, whose radii are too small.

  Nothing of the measured skeleton is changed; all figures are inferred, with standard errors. They
  come from the spread of the grown branches, from the number of measured branches, and from shares
  of the volume that were chosen by virtual scans; see `benchmark/results/hidden_wood.md`. Stems of
  which the skeleton shows no trace are not inferred.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
          `CGAL::Parallel_if_available_tag`
  \tparam Kernel a kernel of CGAL
  \tparam PointRange a range of points, or of elements that `point_map` maps to points
  \tparam NamedParameters a sequence of named parameters
  \param tree the skeleton of the scan, z upwards [L]; `m` nodes
  \param points the scan with all returns, those of leaves and other objects as well, in the
         coordinates of the tree; `n` points. Beams without a return count as free, so in a thinned
         scan too few places are hidden, also if the angle between beams is given
  \param fit the habit, as from `fit_tree_habit()` of this tree, or of trees of its kind. Wood
         thinner than its `smallest_radius` is left out of the density
  \param np an optional sequence of named parameters, listed below
  \npbegin
    \np{scanner_positions} positions of the scanners, which must be given [L]
      \nptype a range of points with `x()`, `y()`, `z()`
      \npdefault none
    \np{station_map} the index in `scanner_positions` of the station of a point; negative: unknown.
        It must be given if there are several stations
      \nptype a readable property map with integers; key: element of `points`
      \npdefault all points are of the only station
    \np{angular_step} the angle between neighbouring beams; 0: estimated [rad]
      \nptype number, `>= 0`, at most 0.5
      \npdefault `0`. The estimate is refused unless at least half of the returns have their next
          return in a direction at the same angle, within a tenth
    \np{point_map} where a position is read
      \nptype a readable property map; key: element of `points`
      \npdefault `CGAL::Identity_property_map`
    \np{number_of_simulations} times that hidden branches are grown [count]
      \nptype integer, `20` or more
      \npdefault `100`
    \np{random_seed} seed of the grown branches
      \nptype integer
      \npdefault `0`
  \npend
  \return inferred branches and volumes; without hidden places, no branches and volumes near 0
  \throws pcs::Invalid_input when no station is known, several stations have no `station_map`, a
          station of a point is not given, no point has a station, the angle between beams is not
          recognised, most returns are in directions with more than twice as many returns as beams,
          a coordinate is not finite, the tree has fewer than four branches besides its trunk, the
          trunk is 100 times as long or short as that of the habit, or the habit or a named
          parameter is invalid
  \par Complexity
  \f$O(n \log n)\f$ for the views of the stations. Every simulation grows about the branches of the
  tree, with \f$O(\log n)\f$ for each node.
  \par Determinism
  Same bits for every number of threads and for the sequential tag.
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class Kernel,
          class PointRange,
          class NamedParameters = parameters::Default_named_parameters>
Hidden_wood<Kernel> complete_hidden_wood(const Tree_skeleton<Kernel>& tree,
                                         const PointRange& points,
                                         const Tree_habit_fit& fit,
                                         const NamedParameters& np = parameters::default_values())
{
  namespace hidden = generators::hidden;
  internal::Hidden_wood_input input = internal::read_hidden_wood_input(np);
  const std::string caller = internal::hidden_wood_caller;
  const auto sample =
      generators::habit::checked_sample(tree, fit.smallest_radius, caller + ": the tree");
  internal::check_unit(sample.axes.front().length(), fit, caller);
  const Tree_habit habit = habit_at_height(fit, sample.axes.front().length());
  internal::check_habit(habit);
  internal::read_station_points(points, np, input);
  const hidden::Beam_visibility visibility = internal::visibility_of(input);
  const hidden::Hidden_estimate e =
      hidden::estimate_hidden_wood<ConcurrencyTag>(sample,
                                                   habit,
                                                   visibility,
                                                   input.seed,
                                                   input.number_of_simulations);
  Hidden_wood<Kernel> result;
  internal::add_inferred_branches(sample, e.branches, result);
  result.number_of_stems = e.number_of_stems;
  result.measured_volume = measure_tree(tree).volume;
  result.hidden_branches = e.hidden_branches;
  result.missing_stems = e.missing_stems;
  result.radius_correction = e.radius_correction;
  hidden::sum_up(e, result.measured_volume, result.inferred_volume, result.total_volume);
  result.hidden_crown_share = hidden::hidden_crown_share(sample, visibility, input.seed);
  std::copy(e.density_factors.begin(), e.density_factors.end(), result.density_factors);
  result.angular_step = input.angular_step;
  result.grid_share = input.grid_share;
  result.scanned_share = hidden::scanned_share(sample, visibility);
  return result;
}

} // namespace pcs

#endif // PCS_GENERATORS_COMPLETE_HIDDEN_WOOD_H
