// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Finds the points of the handles of an edit and their motions; the input may arrive in chunks.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_APPLY_EDIT_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_APPLY_EDIT_H

#include "deformation/Edit.h"
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>

#include <CGAL/number_type_config.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace program {

/// Denotes a point without a handle.
constexpr std::uint32_t no_handle = std::numeric_limits<std::uint32_t>::max();

/// Finds the points of a selector in a chunk of the input.
class Selection
{
public:
  Selection(const Edit& edit, const Handle& handle) : m_edit(edit), m_handle(handle)
  {
    if (const auto* list = std::get_if<Index_list>(&handle.selector)) {
      m_indices = list->indices;
      std::sort(m_indices.begin(), m_indices.end());
      m_indices.erase(std::unique(m_indices.begin(), m_indices.end()), m_indices.end());
    }
  }

  /// Throws if the input lacks the property of the selector.
  void check_property(const pcs::IO::Point_table& table) const
  {
    const auto* wanted = std::get_if<Property_equals>(&m_handle.selector);
    if (wanted == nullptr || table.has_property(wanted->name))
      return;
    std::string names;
    for (const std::string& name : table.property_names())
      names += (names.empty() ? "" : ", ") + name;
    fail("/property",
         "there is no property \"" + wanted->name + "\", the input has " +
             (names.empty() ? "none except x, y, z" : names));
  }

  /// Throws if a listed index is not below `n`, the number of all points.
  void check_numbers(std::uint64_t n) const
  {
    if (m_indices.empty() || m_indices.back() < n)
      return;
    const std::vector<std::uint64_t>& list = std::get<Index_list>(m_handle.selector).indices;
    std::size_t i = 0;
    while (list[i] < n)
      ++i;
    fail("/indices/" + std::to_string(i),
         "there is no point " + std::to_string(list[i]) + ", the input has " + std::to_string(n) +
             ", counted from 0");
  }

  /// Returns distinct positions in the chunk, ascending. Its points are numbered from `first` on.
  std::vector<std::size_t> in(const pcs::IO::Point_table& piece, std::uint64_t first) const
  {
    return std::visit([&](const auto& selector) { return select(selector, piece, first); },
                      m_handle.selector);
  }

  /// Throws an error about the selection.
  [[noreturn]] void fail(const std::string& below, const std::string& what) const
  {
    throw pcs::IO_error(m_edit.source, m_handle.pointer + "/select" + below + ": " + what);
  }

  bool is_place() const
  {
    return std::holds_alternative<Box>(m_handle.selector) ||
           std::holds_alternative<Sphere>(m_handle.selector);
  }

private:
  using Table = pcs::IO::Point_table;

  template <class Predicate>
  static std::vector<std::size_t> where(const Table& piece, const Predicate& is_selected)
  {
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < piece.number_of_points(); ++i)
      if (is_selected(i))
        result.push_back(i);
    return result;
  }

  std::vector<std::size_t> select(const Box& box, const Table& piece, std::uint64_t) const
  {
    return where(piece, [&](std::size_t i) {
      const Vec3 p = to_vec3(piece.points()[i]);
      return (p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all();
    });
  }

  std::vector<std::size_t> select(const Sphere& sphere, const Table& piece, std::uint64_t) const
  {
    return where(piece, [&](std::size_t i) {
      const auto& p = piece.points()[i];
      const Vec3& c = sphere.center;
      return std::hypot(p.x() - c.x(), p.y() - c.y(), p.z() - c.z()) <= sphere.radius;
    });
  }

  std::vector<std::size_t>
  select(const Property_equals& wanted, const Table& piece, std::uint64_t) const
  {
    return std::visit(
        [&](const auto& values, const auto value) {
          return where(piece, [&](std::size_t i) { return is_equal(values[i], value); });
        },
        piece.property_values(wanted.name),
        wanted.value);
  }

  std::vector<std::size_t> select(const Index_list&, const Table& piece, std::uint64_t first) const
  {
    std::vector<std::size_t> result;
    const std::uint64_t end = first + piece.number_of_points();
    for (auto at = std::lower_bound(m_indices.begin(), m_indices.end(), first);
         at != m_indices.end() && *at < end;
         ++at)
      result.push_back(static_cast<std::size_t>(*at - first));
    return result;
  }

  /// Compares integers as integers; a wanted number is first rounded to `float` if the property is
  /// one.
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

  const Edit& m_edit;
  const Handle& m_handle;
  std::vector<std::uint64_t> m_indices; // sorted and distinct
};

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

/// Visits all points once, in chunks and in order; then returns the motions, or throws the error of
/// the edit.
class Edit_scan
{
public:
  /// Checks the properties of the input, which `empty` must have.
  Edit_scan(const Edit& edit, const pcs::IO::Point_table& empty) : m_edit(edit)
  {
    for (const Handle& handle : edit.handles) {
      m_selections.emplace_back(edit, handle);
      m_selections.back().check_property(empty);
    }
    m_moments.resize(edit.handles.size());
  }

  /// Returns the handle of each point of a chunk, numbered from `first` on, or `no_handle`.
  std::vector<std::uint32_t> handles_of(const pcs::IO::Point_table& piece,
                                        std::uint64_t first) const
  {
    return find_handles(piece, first, [](std::uint32_t, std::uint32_t, std::uint64_t) {});
  }

  /// Returns the same for the next points of the input.
  std::vector<std::uint32_t> add(const pcs::IO::Point_table& piece)
  {
    const auto note_overlap = [&](std::uint32_t a, std::uint32_t b, std::uint64_t number) {
      Overlap& overlap = m_overlaps[{a, b}];
      if (overlap.number_of_points++ == 0)
        overlap.first_point = number;
    };
    const std::vector<std::uint32_t> handles = find_handles(piece, m_count, note_overlap);
    for (std::size_t i = 0; i < handles.size(); ++i) {
      const Vec3 p = to_vec3(piece.points()[i]);
      m_low = m_count + i == 0 ? p : m_low.cwiseMin(p);
      m_high = m_count + i == 0 ? p : m_high.cwiseMax(p);
      if (handles[i] != no_handle)
        m_moments[handles[i]].add(p);
    }
    m_count += handles.size();
    return handles;
  }

  /// Returns the motions of the handles after the last point. Errors name the handle.
  std::vector<pcs::Similarity> motions() const
  {
    for (std::size_t h = 0; h < m_selections.size(); ++h) {
      m_selections[h].check_numbers(m_count);
      if (m_moments[h].count == 0 && !is_in_overlap(h))
        m_selections[h].fail("",
                             "selects none of the " + std::to_string(m_count) + " points" +
                                 (m_selections[h].is_place() ? hint() : ""));
    }
    check_overlaps();
    std::vector<pcs::Similarity> result;
    for (std::size_t h = 0; h < m_selections.size(); ++h)
      try {
        result.push_back(similarity(m_edit.handles[h].motion, m_moments[h].centroid()));
      } catch (const pcs::Invalid_input& refusal) {
        throw pcs::IO_error(m_edit.source, m_edit.handles[h].pointer + ": " + refusal.what());
      }
    return result;
  }

  /// Returns the largest absolute value of the coordinates. [L]
  double largest_coordinate() const
  {
    return m_low.cwiseAbs().cwiseMax(m_high.cwiseAbs()).maxCoeff();
  }

private:
  /// Sums relative to one of the points, which keeps the precision far from the origin.
  struct Moment
  {
    std::uint64_t count = 0;
    Vec3 first = Vec3::Zero(), sum = Vec3::Zero();

    void add(const Vec3& p)
    {
      if (count++ == 0)
        first = p;
      sum += p - first;
    }
    Vec3 centroid() const { return first + sum / static_cast<double>(count); }
  };

  struct Overlap
  {
    std::uint64_t number_of_points = 0, first_point = 0;
  };

  template <class Note_overlap>
  std::vector<std::uint32_t> find_handles(const pcs::IO::Point_table& piece,
                                          std::uint64_t first,
                                          const Note_overlap& note_overlap) const
  {
    std::vector<std::uint32_t> handles(piece.number_of_points(), no_handle);
    for (std::uint32_t h = 0; h < m_selections.size(); ++h)
      for (const std::size_t i : m_selections[h].in(piece, first))
        if (handles[i] == no_handle)
          handles[i] = h;
        else
          note_overlap(handles[i], h, first + i);
    return handles;
  }

  bool is_in_overlap(std::size_t h) const
  {
    return std::any_of(m_overlaps.begin(), m_overlaps.end(), [&](const auto& entry) {
      return entry.first.second == h;
    });
  }

  /// Throws if two handles select the same point, and names them.
  void check_overlaps() const
  {
    if (m_overlaps.empty())
      return;
    const auto& [pair, overlap] = *m_overlaps.begin();
    std::string message =
        m_edit.handles[pair.first].pointer + " and " + m_edit.handles[pair.second].pointer +
        " overlap: both select " + std::to_string(overlap.number_of_points) +
        (overlap.number_of_points == 1 ? " point, number " : " points, the first is number ") +
        std::to_string(overlap.first_point);
    if (m_overlaps.size() > 1)
      message += "; so do " + std::to_string(m_overlaps.size() - 1) + " more pairs of handles";
    throw pcs::IO_error(m_edit.source, message);
  }

  /// Describes the bounding box of the points, which indicates a wrong unit or axis.
  std::string hint() const
  {
    if (m_count == 0)
      return "";
    std::ostringstream text;
    text << ", which lie between [" << m_low.x() << ", " << m_low.y() << ", " << m_low.z()
         << "] and [" << m_high.x() << ", " << m_high.y() << ", " << m_high.z() << "]";
    return text.str();
  }

  const Edit& m_edit;
  std::vector<Selection> m_selections;
  std::vector<Moment> m_moments; // one per handle
  std::map<std::pair<std::uint32_t, std::uint32_t>, Overlap> m_overlaps;
  std::uint64_t m_count = 0;
  Vec3 m_low = Vec3::Zero(), m_high = Vec3::Zero();
};

/// The points that may move, in the order of the input; all of them without a region.
class Region
{
public:
  /// \param edit the region as read by `read_region()`, or null; must outlive this object
  /// \param empty has the properties of the input
  Region(const Edit* edit, const pcs::IO::Point_table& empty)
  {
    if (edit == nullptr)
      return;
    m_selection.emplace(*edit, edit->handles.front());
    m_selection->check_property(empty);
  }

  bool is_given() const { return m_selection.has_value(); }

  /// Returns whether each point of a chunk, numbered from `first` on, may move; empty if all may.
  /// Throws if a handle selects another point.
  std::vector<char> in(const pcs::IO::Point_table& piece,
                       std::uint64_t first,
                       const std::vector<std::uint32_t>& handles,
                       const Edit* edit) const
  {
    std::vector<char> is_inside;
    if (!m_selection)
      return is_inside;
    is_inside.assign(piece.number_of_points(), 0);
    for (const std::size_t i : m_selection->in(piece, first))
      is_inside[i] = 1;
    for (std::size_t i = 0; i < handles.size(); ++i)
      if (handles[i] != no_handle && !is_inside[i])
        throw pcs::IO_error(
            edit->source,
            edit->handles[handles[i]].pointer + "/select: point " + std::to_string(first + i) +
                " is not in the --region; extend the region or select fewer points");
    return is_inside;
  }

  /// Throws if the region is empty or lists a number that is none of the `n` points.
  void check(std::uint64_t n, std::uint64_t number_of_points_inside) const
  {
    if (!m_selection)
      return;
    m_selection->check_numbers(n);
    if (number_of_points_inside == 0)
      m_selection->fail("", "selects none of the " + std::to_string(n) + " points");
  }

private:
  std::optional<Selection> m_selection;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_APPLY_EDIT_H
