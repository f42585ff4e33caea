// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Deforms points and normals in memory by the motions of an edit.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_RUN_SESSION_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_RUN_SESSION_H

#include "common/Progress_line.h"
#include "deformation/Deformation_options.h"
#include "deformation/Edit.h"
#include "deformation/Normals.h"
#include "deformation/apply_edit.h"
#include <pcs/IO/points/Point_table.h>
#include <pcs/Point_set_deformation.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>

#include <boost/property_map/property_map.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace program {

//! [index_map]
/// Reads and writes `(*values)[i]` for a point number `i`. Fixed points are not written.
template <class Value>
struct Index_map
{
  using key_type = std::size_t;
  using value_type = Value;
  using reference = const Value&;
  using category = boost::read_write_property_map_tag;

  friend const Value& get(const Index_map& map, std::size_t i) { return (*map.values)[i]; }
  friend void put(const Index_map& map, std::size_t i, const Value& value)
  {
    if (map.is_fixed == nullptr || !(*map.is_fixed)[i])
      (*map.values)[i] = value;
  }

  std::vector<Value>* values = nullptr;
  const std::vector<char>* is_fixed = nullptr; ///< null: none is
};
//! [index_map]

using Point_map = Index_map<pcs::IO::Point_table::Point_3>;
using Normal_map = Index_map<pcs::IO::Point_table::Vector_3>;
using Gradient_map = Index_map<Eigen::Matrix3d>;

/// The points of an edit: `handles[i]` is the handle of point `i`, or `no_handle`.
struct Edited_points
{
  const Edit& edit;
  const std::vector<pcs::Similarity>& motions;
  const std::vector<std::uint32_t>& handles;
  std::vector<pcs::IO::Point_table::Point_3>& points;
  Normal_vectors* normals;                 ///< null: normals are not deformed
  std::vector<Eigen::Matrix3d>* gradients; ///< null: not needed; otherwise of the rest shape
  std::string note;                        ///< for messages that contain the number of a point
  const std::vector<char>& is_inside;      ///< whether each point may move; empty: all may
};

inline bool is_hard(const Handle& handle)
{
  return handle.softness == 0;
}

/// Returns the points of fixed handles, which the library returns up to rounding and the program
/// exactly.
inline std::vector<char> fixed_points(const Edit& edit, const std::vector<std::uint32_t>& handles)
{
  std::vector<char> is_fixed(handles.size(), 0);
  for (std::size_t i = 0; i < handles.size(); ++i)
    is_fixed[i] = handles[i] != no_handle && is_hard(edit.handles[handles[i]]) &&
                  edit.handles[handles[i]].motion.is_fixed();
  return is_fixed;
}

/// Returns the targets of a handle in the order of its points, which is increasing.
inline std::vector<Vec3> sorted_targets(const Handle& handle)
{
  std::map<std::uint64_t, Vec3> target_of_point;
  const std::vector<std::uint64_t>& points = std::get<Index_list>(handle.selector).indices;
  for (std::size_t k = 0; k < points.size(); ++k)
    target_of_point.emplace(points[k], handle.motion.targets[k]);
  std::vector<Vec3> result;
  for (const auto& entry : target_of_point)
    result.push_back(entry.second);
  return result;
}

/// Returns the indices of the entries that are set.
inline std::vector<std::size_t> numbers_of(const std::vector<char>& is_set)
{
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < is_set.size(); ++i)
    if (is_set[i])
      result.push_back(i);
  return result;
}

template <class Session>
void add_handles(Session& session, const Edited_points& cloud)
{
  std::vector<std::vector<std::size_t>> indices(cloud.edit.handles.size());
  for (std::size_t i = 0; i < cloud.handles.size(); ++i)
    if (cloud.handles[i] != no_handle)
      indices[cloud.handles[i]].push_back(i);
  for (std::size_t h = 0; h < indices.size(); ++h)
    try {
      const auto handle = session.add_handle(indices[h], cloud.edit.handles[h].softness);
      if (cloud.edit.handles[h].motion.targets.empty())
        session.set_transformation(handle, cloud.motions[h]);
      else
        session.set_targets(handle, sorted_targets(cloud.edit.handles[h]));
    } catch (const pcs::Invalid_input& e) {
      throw pcs::IO_error(cloud.edit.source,
                          cloud.edit.handles[h].pointer + ": " + e.what() + cloud.note);
    }
}

/// Points of another range, at rest, which follow the deformed ones.
struct Following_points
{
  std::vector<std::size_t>& indices; ///< of those to move
  std::vector<pcs::IO::Point_table::Point_3>& points;
  Normal_vectors* normals;                 ///< null: normals are not deformed
  std::vector<Eigen::Matrix3d>* gradients; ///< null: not needed
};
using Move_others = std::function<void(const Following_points&)>;

template <class Session>
void move_others(Session& session, const Following_points& others)
{
  const auto move = [&](const auto& maps) {
    if (others.normals != nullptr)
      session.apply(others.indices, maps.normal_map(Normal_map{others.normals}));
    else
      session.apply(others.indices, maps);
  };
  const auto maps = pcs::parameters::point_map(Point_map{&others.points});
  if (others.gradients != nullptr)
    move(maps.gradient_map(Gradient_map{others.gradients}));
  else
    move(maps);
}

/// Deforms the points, then calls `use` with a function that moves other points.
inline pcs::Deformation_report run_session(const Edited_points& cloud,
                                           const Options& options,
                                           Progress_line& progress,
                                           const std::function<void(const Move_others&)>& use)
{
  const char* stage = "preparing";
  const std::function<bool(double)> show = [&](double fraction) {
    progress.show(stage, fraction);
    return true;
  };
  std::vector<std::size_t> indices(cloud.points.size());
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  const std::vector<char> is_fixed = fixed_points(cloud.edit, cloud.handles);
  const std::vector<std::size_t> region = numbers_of(cloud.is_inside);
  const auto run = [&](const auto& maps, const auto& np) {
    using Session =
        pcs::Point_set_deformation<std::vector<std::size_t>, std::decay_t<decltype(maps)>>;
    Session session(indices, np);
    add_handles(session, cloud);
    stage = "deforming";
    const pcs::Deformation_report report = session.deform();
    if (report.status == pcs::Status::numerical_failure)
      throw pcs::Invalid_input("a matrix could not be factorised, probably because parts of the "
                               "cloud are too far apart for their size; remove points far away "
                               "from all others, or use more --neighbors");
    use([&](const Following_points& others) { move_others(session, others); });
    return report;
  };
  const auto run_with_options = [&](const auto& maps) {
    const auto np = maps.number_of_neighbors(options.number_of_neighbors)
                        .poisson_ratio(options.model.poisson_ratio)
                        .stiffness(options.model.stiffness)
                        .do_preserve_volume(!options.model.is_volume_ignored)
                        .number_of_iterations(options.model.number_of_iterations)
                        .tolerance(options.model.tolerance)
                        .sample_weights(options.model.sample_weights())
                        .sample_search(options.model.sample_search())
                        .rotation_field(options.model.rotation_field())
                        .callback(show);
    const auto run_in_region = [&](const auto& np_of_region) {
      return options.number_of_samples > 0
                 ? run(maps, np_of_region.number_of_samples(options.number_of_samples))
                 : run(maps, np_of_region);
    };
    return cloud.is_inside.empty() ? run_in_region(np)
                                   : run_in_region(np.region_of_interest(std::cref(region)));
  };
  const auto run_with_normals = [&](const auto& maps) {
    return cloud.normals != nullptr
               ? run_with_options(maps.normal_map(Normal_map{cloud.normals, &is_fixed}))
               : run_with_options(maps);
  };
  const auto maps = pcs::parameters::point_map(Point_map{&cloud.points, &is_fixed});
  return cloud.gradients != nullptr
             ? run_with_normals(maps.gradient_map(Gradient_map{cloud.gradients, &is_fixed}))
             : run_with_normals(maps);
}

/// Throws if a coordinate is not finite. Points are numbered from `first` on.
inline void check_range(const Edit& edit, const pcs::IO::Point_table& table, std::uint64_t first)
{
  for (std::size_t i = 0; i < table.number_of_points(); ++i)
    if (!to_vec3(table.points()[i]).allFinite())
      throw pcs::IO_error(edit.source,
                          "the edit moves point " + std::to_string(first + i) +
                              " out of the range of numbers");
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_RUN_SESSION_H
