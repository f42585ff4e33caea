// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads an edit from a JSON file, with all checks that do not need the points.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_READ_EDIT_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_READ_EDIT_H

#include "common/Json_value.h"
#include "deformation/Edit.h"
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace program {

inline Box read_box(const Json_value& json)
{
  json.array(2, "[[x, y, z], [x, y, z]], two corners");
  const Vec3 a = json[std::size_t(0)].vector_3(), b = json[std::size_t(1)].vector_3();
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

inline Sphere read_sphere(const Json_value& json)
{
  json.object({"center", "radius"});
  for (const char* key : {"center", "radius"})
    if (!json.has(key))
      json.fail(std::string("the key ") + key + " is missing");
  const Sphere sphere{json["center"].vector_3(), json["radius"].number("a number > 0")};
  if (!(sphere.radius > 0))
    json["radius"].fail_expected("a number > 0");
  return sphere;
}

inline Property_equals read_property(const Json_value& select)
{
  if (!select.has("property") || !select.has("equals"))
    select.fail("property and equals belong together, one is missing");
  if (!select["property"].json().is_string())
    select["property"].fail_expected("the name of a property");
  const Json_value equals = select["equals"];
  Property_equals result{select["property"].json().get<std::string>(), equals.number()};
  if (equals.json().is_number_unsigned())
    result.value = equals.json().get<std::uint64_t>();
  else if (equals.json().is_number_integer())
    result.value = equals.json().get<std::int64_t>();
  return result;
}

inline Index_list read_indices(const Json_value& json)
{
  if (!json.json().is_array())
    json.fail_expected("an array of point numbers");
  Index_list list;
  list.indices.reserve(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (!json.json()[i].is_number_unsigned())
      json[i].fail_expected("a point number, an integer >= 0");
    list.indices.push_back(json.json()[i].get<std::uint64_t>());
  }
  return list;
}

inline Selector read_selector(const Json_value& json)
{
  json.object({"box", "sphere", "property", "equals", "indices"});
  const bool has_property = json.has("property") || json.has("equals");
  const int count = json.has("box") + json.has("sphere") + json.has("indices") + has_property;
  if (count != 1)
    json.fail("expected exactly one of box, sphere, property with equals, indices; found " +
              std::to_string(count));
  if (json.has("box"))
    return read_box(json["box"]);
  if (json.has("sphere"))
    return read_sphere(json["sphere"]);
  if (json.has("indices"))
    return read_indices(json["indices"]);
  return read_property(json);
}

inline Rotation read_rotation(const Json_value& json)
{
  json.object({"axis", "degrees", "center"});
  for (const char* key : {"axis", "degrees"})
    if (!json.has(key))
      json.fail(std::string("the key ") + key + " is missing");
  Rotation rotation;
  rotation.axis = json["axis"].vector_3();
  if (rotation.axis.isZero(0))
    json["axis"].fail("expected a direction, found [0, 0, 0]");
  rotation.degrees = json["degrees"].number();
  if (json.has("center"))
    rotation.center = json["center"].vector_3();
  return rotation;
}

inline pcs::Similarity read_matrix(const Json_value& json)
{
  json.array(16, "16 numbers, a 4 x 4 matrix row by row");
  Eigen::Matrix4d m;
  for (int i = 0; i < 16; ++i)
    m(i / 4, i % 4) = json[static_cast<std::size_t>(i)].number();
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    json.fail("the last row must be 0, 0, 0, 1");
  try {
    return pcs::Similarity::from_matrix(m.topRows<3>());
  } catch (const pcs::Invalid_input& e) {
    json.fail(e.what());
  }
}

/// Reads one target for each listed point.
inline std::vector<Vec3> read_targets(const Json_value& handle, const Selector& selector)
{
  const Json_value json = handle["targets"];
  const auto* list = std::get_if<Index_list>(&selector);
  if (list == nullptr)
    json.fail("needs select with indices, whose order is that of the targets");
  if (!json.json().is_array())
    json.fail_expected("an array of positions [x, y, z]");
  if (json.size() != list->indices.size())
    json.fail("expected one position for each of the " + std::to_string(list->indices.size()) +
              " indices, found " + std::to_string(json.size()));
  std::vector<std::uint64_t> sorted = list->indices;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    json.fail("point " + std::to_string(*twice) + " is listed twice in indices; list it once");
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < json.size(); ++i)
    result.push_back(json[i].vector_3());
  return result;
}

inline Motion read_motion(const Json_value& handle, const Selector& selector)
{
  const bool has_steps = handle.has("rotate") || handle.has("translate") || handle.has("scale");
  if (handle.has("fixed") + handle.has("matrix") + handle.has("targets") + has_steps != 1)
    handle.fail(
        "expected exactly one of fixed, matrix, targets, or any of rotate, translate, scale");
  Motion motion;
  if (handle.has("targets"))
    motion.targets = read_targets(handle, selector);
  if (handle.has("fixed") && handle["fixed"].json() != Json(true))
    handle["fixed"].fail_expected("true");
  if (handle.has("matrix"))
    motion.matrix = read_matrix(handle["matrix"]);
  if (handle.has("rotate"))
    motion.rotation = read_rotation(handle["rotate"]);
  if (handle.has("translate"))
    motion.translation = handle["translate"].vector_3();
  if (handle.has("scale")) {
    motion.scale = handle["scale"].number("a number > 0");
    if (!(*motion.scale > 0))
      handle["scale"].fail_expected("a number > 0");
  }
  return motion;
}

inline Handle read_handle(const Json_value& json)
{
  json.object({"select", "fixed", "matrix", "targets", "rotate", "translate", "scale", "softness"});
  if (!json.has("select"))
    json.fail("the key select is missing");
  Handle handle{json.pointer(), read_selector(json["select"]), Motion()};
  handle.motion = read_motion(json, handle.selector);
  if (json.has("softness")) {
    handle.softness = json["softness"].number("a number >= 0");
    if (!(handle.softness >= 0))
      json["softness"].fail_expected("a number >= 0");
  }
  return handle;
}

/// Reads an edit. Throws `pcs::IO_error` with the file, the JSON pointer, and the expected value.
inline Edit read_edit(const std::string& path)
{
  const Json json = read_json(path, "an edit");
  const Json_value top(json, path);
  top.object({"handles"});
  if (!top.has("handles"))
    top.fail("the key handles is missing");
  const Json_value handles = top["handles"];
  if (!handles.json().is_array() || handles.size() == 0)
    handles.fail_expected("an array with at least one handle");
  Edit edit{path, {}};
  for (std::size_t i = 0; i < handles.size(); ++i)
    edit.handles.push_back(read_handle(handles[i]));
  return edit;
}

/// Reads the region of interest: a selection, stored as the only handle of an edit.
inline Edit read_region(const std::string& path)
{
  const Json json = read_json(path, "a region");
  const Json_value top(json, path);
  top.object({"select"});
  if (!top.has("select"))
    top.fail("the key select is missing");
  return {path, {Handle{"", read_selector(top["select"]), Motion()}}};
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_READ_EDIT_H
