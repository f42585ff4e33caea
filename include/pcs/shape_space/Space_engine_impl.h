// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of Space_engine.h.

#ifndef PCS_SHAPE_SPACE_SPACE_ENGINE_IMPL_H
#define PCS_SHAPE_SPACE_SPACE_ENGINE_IMPL_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/Space_engine.h>
#include <pcs/shape_space/family/Family_points_impl.h>
#include <pcs/shape_space/family/build_family.h>
#include <pcs/shape_space/family/make_family.h>
#include <pcs/shape_space/family/serialize_family.h>
#include <pcs/shape_space/pair/build_pair.h>
#include <pcs/shape_space/pair/embed_pair.h>
#include <pcs/shape_space/pair/serialize_topology.h>
#include <pcs/shape_space/path/apply_pipe_model.h>
#include <pcs/shape_space/points/Point_instances_impl.h>
#include <pcs/shape_space/statistics/Tangent_space.h>
#include <pcs/shape_space/statistics/Tree_distribution.h>
#include <pcs/shape_space/statistics/find_modes.h>
#include <pcs/shape_space/statistics/mean_tree.h>
#include <pcs/shape_space/statistics/project_to_range.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

inline std::vector<const Orl_coordinates*> pointers(const std::vector<Orl_coordinates>& trees)
{
  std::vector<const Orl_coordinates*> result;
  for (const Orl_coordinates& x : trees)
    result.push_back(&x);
  return result;
}

} // namespace internal

template <class ConcurrencyTag>
bool Space_engine<ConcurrencyTag>::find_correspondences(const Inputs& inputs,
                                                        const Build_options& options,
                                                        pcs::internal::Progress& progress,
                                                        Embedded_pair& built,
                                                        std::vector<Point_pair>& pairs,
                                                        Orl_report& report)
{
  return shape_space::find_correspondences<ConcurrencyTag>(inputs,
                                                           options,
                                                           progress,
                                                           built,
                                                           pairs,
                                                           report);
}

template <class ConcurrencyTag>
void Space_engine<ConcurrencyTag>::embed_stored(const Orl_correspondences& stored,
                                                const Inputs& inputs,
                                                const std::string& caller,
                                                Embedded_pair& built)
{
  built.topology = restore_topology(stored, inputs, caller);
  const auto& [w, x, y, z] = stored.turn;
  built.turn = Quaternion(w, x, y, z);
  embed(inputs, built);
  if (!inputs[0]->points.empty() || !inputs[1]->points.empty())
    check_pairs(stored,
                built.layout.number_of_edges(),
                {inputs[0]->points.size(), inputs[1]->points.size()},
                caller);
}

template <class ConcurrencyTag>
Tree_family Space_engine<ConcurrencyTag>::finish_pair(const Inputs& inputs,
                                                      std::vector<Point_pair> pairs,
                                                      const Matching_weights& weights,
                                                      Embedded_pair& built,
                                                      Orl_report& report)
{
  built.instances.set(built.layout,
                      built.geometry,
                      {inputs[0]->points, points_of_second(inputs)},
                      {inputs[0]->normals, inputs[1]->normals},
                      built.is_relative,
                      std::move(pairs),
                      ConcurrencyTag());
  Tree_family family = make_family(built, inputs, weights);
  family.first_point = first_of_edges(built.instances.pairs(), built.layout.number_of_edges());
  describe(built, report);
  return family;
}

template <class ConcurrencyTag>
Orl_correspondences Space_engine<ConcurrencyTag>::store_topology(const Embedded_pair& built,
                                                                 const Inputs& inputs)
{
  return shape_space::store_topology(built.topology, built.turn, inputs, built.instances.pairs());
}

template <class ConcurrencyTag>
bool Space_engine<ConcurrencyTag>::build_family(const std::vector<Tree_input>& inputs,
                                                const Build_options& options,
                                                Virtual_direction direction,
                                                bool has_unit_weights,
                                                pcs::internal::Progress& progress,
                                                Built_family& built,
                                                Orl_report& report)
{
  return shape_space::build_family<ConcurrencyTag>(inputs,
                                                   options,
                                                   direction,
                                                   has_unit_weights,
                                                   progress,
                                                   built,
                                                   report);
}

template <class ConcurrencyTag>
void Space_engine<ConcurrencyTag>::set_points(const std::vector<Orl_space_data::Point>& points,
                                              const std::vector<Orl_space_data::Partner>& partners,
                                              bool has_normals,
                                              Tree_family& family,
                                              Family_points& result)
{
  std::vector<Orl_geometry> geometry(family.x.size());
  for (std::size_t t = 0; t < family.x.size(); ++t)
    build_geometry(family, family.x[t], geometry[t]);
  result.set(family.layout, geometry, points, partners, has_normals, ConcurrencyTag());
  family.first_point = result.first();
}

template <class ConcurrencyTag>
Orl_coordinates Space_engine<ConcurrencyTag>::embed_tree(const Tree_family& family,
                                                         const Rooted_tree& tree,
                                                         double* share)
{
  return shape_space::embed_tree<ConcurrencyTag>(family, tree, share);
}

template <class ConcurrencyTag>
Orl_space_data Space_engine<ConcurrencyTag>::store_family(const Tree_family& family)
{
  return shape_space::store_family(family);
}

template <class ConcurrencyTag>
void Space_engine<ConcurrencyTag>::store_points(const Inputs& inputs, Orl_space_data& stored)
{
  shape_space::store_points(inputs, stored);
}

template <class ConcurrencyTag>
Tree_family Space_engine<ConcurrencyTag>::restore_family(const Orl_space_data& stored,
                                                         const std::string& caller)
{
  return shape_space::restore_family(stored, caller);
}

template <class ConcurrencyTag>
std::vector<Tree_input> Space_engine<ConcurrencyTag>::restore_pair(const Orl_space_data& stored,
                                                                   const std::string& caller,
                                                                   Tree_family& family,
                                                                   Embedded_pair& built)
{
  std::vector<Tree_input> inputs =
      shape_space::restore_pair<ConcurrencyTag>(stored, family, caller, built);
  family.first_point = first_of_edges(built.instances.pairs(), family.layout.number_of_edges());
  return inputs;
}

template <class ConcurrencyTag>
void Space_engine<ConcurrencyTag>::check_family_points(const Orl_space_data& stored,
                                                       std::size_t number_of_edges,
                                                       const std::string& caller)
{
  shape_space::check_family_points(stored, number_of_edges, caller);
}

template <class ConcurrencyTag>
void Space_engine<ConcurrencyTag>::build_geometry(const Tree_family& family,
                                                  const Orl_coordinates& x,
                                                  Orl_geometry& result)
{
  shape_space::build_geometry(family.layout, x, family.orientation, result);
}

template <class ConcurrencyTag>
void Space_engine<ConcurrencyTag>::tree_at(const Tree_family& family,
                                           const Orl_coordinates& a,
                                           const Orl_coordinates& b,
                                           double t,
                                           const Path_options& options,
                                           Extrapolation_buffers& near_end,
                                           Sequential_births_buffers& births,
                                           Orl_coordinates& x,
                                           Orl_geometry& geometry)
{
  coordinates_at(family.layout, a, b, t, options.maximal_turn, x);
  if (options.births == Branch_emergence::sequential && t > 0 && t < 1)
    Sequential_births(family.layout, births)(a, b, t, x);
  if (t < 0 || t > 1)
    Extrapolation_limits(family.layout,
                         family.orientation,
                         family.up,
                         options.maximal_turn,
                         near_end)(t < 0 ? a : b, t < 0 ? b : a, x);
  if (options.do_limit_radii)
    limit_radii(family.layout, x);
  build_geometry(family, x, geometry);
}

template <class ConcurrencyTag>
double Space_engine<ConcurrencyTag>::distance(const Tree_family& family,
                                              const Orl_coordinates& a,
                                              const Orl_coordinates& b,
                                              Orl_metric metric)
{
  return shape_space::distance(a, b, family.weights, metric);
}

template <class ConcurrencyTag>
std::vector<Branch_change> Space_engine<ConcurrencyTag>::find_changes(const Tree_family& family,
                                                                      const Orl_coordinates& a,
                                                                      const Orl_coordinates& b,
                                                                      const Change_limits& limits)
{
  return shape_space::find_changes(family.layout, a, b, family.orientation, limits);
}

template <class ConcurrencyTag>
Tree_descriptors Space_engine<ConcurrencyTag>::measure(const Tree_family& family,
                                                       const Orl_coordinates& x,
                                                       const Orl_geometry& geometry)
{
  return shape_space::measure(family.layout, x, geometry, family.up);
}

template <class ConcurrencyTag>
double Space_engine<ConcurrencyTag>::share_of_second(const Tree_family& family,
                                                     const Orl_coordinates& x)
{
  const Tangent_space tangent(family.layout, family.x[0], family.weights);
  const Eigen::VectorXd way = tangent.log(family.x[1]);
  const double length = way.squaredNorm();
  return length > 0 ? std::min(1.0, std::max(0.0, tangent.log(x).dot(way) / length)) : 0;
}

template <class ConcurrencyTag>
Orl_coordinates Space_engine<ConcurrencyTag>::parallel_displacement(const Tree_family& family,
                                                                    const Orl_coordinates& t,
                                                                    const Orl_coordinates& a,
                                                                    const Orl_coordinates& b,
                                                                    double step)
{
  // turns are carried over in the frames of the edges themselves
  const Tangent_space from(family.layout, a, family.weights), at(family.layout, t, family.weights);
  Orl_coordinates x = at.exp(step * from.log(b));
  x.root = t.root + step * (b.root - a.root);
  return x;
}

template <class ConcurrencyTag>
Orl_coordinates Space_engine<ConcurrencyTag>::mean_tree(const Tree_family& family,
                                                        const std::vector<double>& weights,
                                                        Tree_mean kind)
{
  return shape_space::mean_tree<ConcurrencyTag>(family.layout,
                                                internal::pointers(family.x),
                                                weights,
                                                kind);
}

template <class ConcurrencyTag>
Modes_of_variation Space_engine<ConcurrencyTag>::find_modes(const Tree_family& family,
                                                            std::size_t most,
                                                            Mode_inner_product measure)
{
  const std::vector<double> ones(family.x.size(), 1);
  return shape_space::find_modes<ConcurrencyTag>(family.layout,
                                                 internal::pointers(family.x),
                                                 family.weights,
                                                 family.orientation,
                                                 mean_tree(family, ones, Tree_mean::frechet),
                                                 most,
                                                 measure);
}

template <class ConcurrencyTag>
Orl_coordinates Space_engine<ConcurrencyTag>::tree_of_modes(const Tree_family& family,
                                                            const Modes_of_variation& modes,
                                                            const std::vector<double>& scores)
{
  return shape_space::tree_of_modes(family.layout, family.weights, modes, scores);
}

template <class ConcurrencyTag>
Mode_coordinates Space_engine<ConcurrencyTag>::project_on_modes(const Tree_family& family,
                                                                const Modes_of_variation& modes,
                                                                const Orl_coordinates& x,
                                                                std::size_t most)
{
  return shape_space::project_on_modes(family.layout,
                                       family.weights,
                                       family.orientation,
                                       modes,
                                       x,
                                       most);
}

template <class ConcurrencyTag>
double Space_engine<ConcurrencyTag>::outlier_score(const Modes_of_variation& modes,
                                                   const Mode_coordinates& at)
{
  return shape_space::outlier_score(modes, at);
}

template <class ConcurrencyTag>
std::shared_ptr<const Tree_distribution>
Space_engine<ConcurrencyTag>::distribution(const Tree_family& family)
{
  return std::make_shared<const Tree_distribution>(family.layout,
                                                   internal::pointers(family.x),
                                                   family.has,
                                                   family.orientation,
                                                   family.up,
                                                   ConcurrencyTag());
}

template <class ConcurrencyTag>
Orl_coordinates Space_engine<ConcurrencyTag>::draw(const Tree_family& family,
                                                   const Tree_distribution& distribution,
                                                   const std::vector<Tree_descriptors>& figures,
                                                   std::uint64_t seed,
                                                   std::uint64_t index,
                                                   const Tree_sampling_options& options,
                                                   bool is_late)
{
  Orl_coordinates x = distribution.draw(seed, index, options);
  if (options.do_keep_in_range)
    limit_angles(family.layout, family.orientation, figures, x);
  if (options.do_keep_in_range && is_late)
    limit_lengths(family.layout, family.orientation, family.up, figures, x);
  if (options.pipe_exponent > 0)
    apply_pipe_model(family.layout, options.pipe_exponent, x);
  if (options.do_limit_radii)
    limit_radii(family.layout, x);
  return x;
}

template <class ConcurrencyTag>
double Space_engine<ConcurrencyTag>::range_violation(const Tree_descriptors& figures,
                                                     const std::vector<Tree_descriptors>& range,
                                                     bool is_of_all)
{
  return shape_space::range_violation(figures, range, is_of_all);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_SPACE_ENGINE_IMPL_H
