// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Turns the handles of an edit into numbers of points and motions, and checks them against the points.

#ifndef PCS_EXAMPLES_PROGRAM_APPLY_EDIT_H
#define PCS_EXAMPLES_PROGRAM_APPLY_EDIT_H

#include "program/Edit.h"
#include <pcs/IO/Point_table.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>
#include <pcs/deform_point_set.h>

#include <CGAL/number_type_config.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace program {

/// Finds the points of a selector, in ascending order and each once.
class Selection
{
public:
  Selection(const Edit& edit, const Handle& handle, const pcs::IO::Point_table& table)
    : m_edit(edit), m_handle(handle), m_table(table)
  {
  }

  std::vector<std::size_t> indices() const
  {
    std::vector<std::size_t> result =
        std::visit([this](const auto& selector) { return select(selector); }, m_handle.selector);
    if (result.empty())
      fail("",
           "selects none of the " + std::to_string(m_table.number_of_points()) + " points" +
               hint());
    return result;
  }

private:
  using Property = pcs::IO::Property_values;

  [[noreturn]] void fail(const std::string& below, const std::string& what) const
  {
    throw pcs::IO_error(m_edit.source, m_handle.pointer + "/select" + below + ": " + what);
  }

  template <class Predicate>
  std::vector<std::size_t> where(const Predicate& is_selected) const
  {
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < m_table.number_of_points(); ++i)
      if (is_selected(i))
        result.push_back(i);
    return result;
  }

  std::vector<std::size_t> select(const Box& box) const
  {
    return where([&](std::size_t i) {
      const Vec3 p = to_vec3(m_table.points()[i]);
      return (p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all();
    });
  }

  std::vector<std::size_t> select(const Sphere& sphere) const
  {
    return where([&](std::size_t i) {
      const auto& p = m_table.points()[i];
      const Vec3& c = sphere.center;
      return std::hypot(p.x() - c.x(), p.y() - c.y(), p.z() - c.z()) <= sphere.radius;
    });
  }

  std::vector<std::size_t> select(const Property_equals& wanted) const
  {
    if (!m_table.has_property(wanted.name)) {
      std::string names;
      for (const std::string& name : m_table.property_names())
        names += (names.empty() ? "" : ", ") + name;
      fail("/property",
           "there is no property \"" + wanted.name + "\", the input has " +
               (names.empty() ? "none besides x, y, z" : names));
    }
    return std::visit(
        [&](const auto& values, const auto value) {
          return where([&](std::size_t i) { return is_equal(values[i], value); });
        },
        m_table.property_values(wanted.name),
        wanted.value);
  }

  std::vector<std::size_t> select(const Index_list& list) const
  {
    const std::size_t n = m_table.number_of_points();
    for (std::size_t i = 0; i < list.indices.size(); ++i)
      if (list.indices[i] >= n)
        fail("/indices/" + std::to_string(i),
             "there is no point " + std::to_string(list.indices[i]) + ", the input has " +
                 std::to_string(n) + ", counted from 0");
    std::vector<std::size_t> result(list.indices.begin(), list.indices.end());
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  /// Integers are compared as integers; a wanted number is first rounded to `float` if the property is.
  template <class Value, class Wanted>
  static bool is_equal(Value value, Wanted wanted)
  {
    if constexpr (std::is_same_v<Value, float>) {
      const auto w = static_cast<double>(wanted);
      return std::abs(w) <= static_cast<double>(std::numeric_limits<float>::max()) &&
             value == static_cast<float>(w);
    } else if constexpr (std::is_floating_point_v<Value> || std::is_floating_point_v<Wanted>)
      return static_cast<double>(value) == static_cast<double>(wanted);
    else if constexpr (std::is_signed_v<Value> == std::is_signed_v<Wanted>)
      return std::common_type_t<Value, Wanted>(value) == std::common_type_t<Value, Wanted>(wanted);
    else
      return value >= Value(0) && wanted >= Wanted(0) &&
             static_cast<std::uint64_t>(value) == static_cast<std::uint64_t>(wanted);
  }

  /// Where the points are, so that a wrong unit or axis is seen at once.
  std::string hint() const
  {
    const bool is_place = std::holds_alternative<Box>(m_handle.selector) ||
                          std::holds_alternative<Sphere>(m_handle.selector);
    if (!is_place || m_table.number_of_points() == 0)
      return "";
    Vec3 low = to_vec3(m_table.points().front()), high = low;
    for (const auto& point : m_table.points()) {
      const Vec3 p = to_vec3(point);
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    std::ostringstream text;
    text << ", which lie between [" << low.x() << ", " << low.y() << ", " << low.z() << "] and ["
         << high.x() << ", " << high.y() << ", " << high.z() << "]";
    return text.str();
  }

  const Edit& m_edit;
  const Handle& m_handle;
  const pcs::IO::Point_table& m_table;
};

inline Vec3 centroid(const pcs::IO::Point_table& table, const std::vector<std::size_t>& indices)
{
  // Relative to one of the points: no digits are lost far from the origin.
  const Vec3 first = to_vec3(table.points()[indices.front()]);
  Vec3 sum = Vec3::Zero();
  for (const std::size_t i : indices)
    sum += to_vec3(table.points()[i]) - first;
  return first + sum / static_cast<double>(indices.size());
}

inline pcs::Similarity similarity(const Motion& motion, const Vec3& centroid)
{
  if (motion.matrix)
    return *motion.matrix;
  const Vec3 center =
      motion.rotation && motion.rotation->center ? *motion.rotation->center : centroid;
  pcs::Similarity result;
  if (motion.scale)
    result = pcs::scaling(*motion.scale, center);
  if (motion.rotation) {
    const double angle = motion.rotation->degrees * (CGAL_PI / 180);
    result = pcs::rotation(motion.rotation->axis, angle, center) * result;
  }
  if (motion.translation)
    result = pcs::translation(*motion.translation) * result;
  return result;
}

/// Throws if a point is selected twice, and says by which handles.
inline void
check_overlaps(const Edit& edit, const std::vector<pcs::Deformation_handle>& handles, std::size_t n)
{
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  struct Overlap
  {
    std::size_t number_of_points = 0, first_point = 0;
  };
  std::map<std::pair<std::size_t, std::size_t>, Overlap> overlaps;
  std::vector<std::size_t> owner(n, none);
  for (std::size_t h = 0; h < handles.size(); ++h)
    for (const std::size_t i : handles[h].indices) {
      if (owner[i] == none) {
        owner[i] = h;
        continue;
      }
      Overlap& overlap = overlaps[{owner[i], h}];
      if (overlap.number_of_points++ == 0)
        overlap.first_point = i;
    }
  if (overlaps.empty())
    return;
  const auto& [pair, overlap] = *overlaps.begin();
  std::string message =
      edit.handles[pair.first].pointer + " and " + edit.handles[pair.second].pointer +
      " overlap: both select " + std::to_string(overlap.number_of_points) +
      (overlap.number_of_points == 1 ? " point, number " : " points, the first is number ") +
      std::to_string(overlap.first_point);
  if (overlaps.size() > 1)
    message += "; so do " + std::to_string(overlaps.size() - 1) + " more pairs of handles";
  throw pcs::IO_error(edit.source, message);
}

/// The handles of an edit as the library wants them. Throws `pcs::IO_error` that names the handle.
inline std::vector<pcs::Deformation_handle> apply_edit(const Edit& edit,
                                                       const pcs::IO::Point_table& table)
{
  std::vector<pcs::Deformation_handle> result;
  for (const Handle& handle : edit.handles) {
    std::vector<std::size_t> indices = Selection(edit, handle, table).indices();
    const pcs::Similarity motion = similarity(handle.motion, centroid(table, indices));
    result.push_back({std::move(indices), motion, handle.softness});
  }
  check_overlaps(edit, result, table.number_of_points());
  return result;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAM_APPLY_EDIT_H
