// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads JSON files of the programs for the page, and checks the values that the page shows.

#ifndef PCS_EXAMPLES_GALLERY_REPORTS_H
#define PCS_EXAMPLES_GALLERY_REPORTS_H

#include "Page.h"
#include "common/Json_value.h"
#include "deformation/read_edit.h"

#include <cstddef>
#include <string>

namespace gallery {

/// Returns the value of a key that must be there.
inline program::Json_value member(const program::Json_value& object, const char* key)
{
  if (!object.json().is_object() || !object.has(key))
    object.fail(std::string("the key ") + key + " is missing");
  return object[key];
}

/// Checks that the value of `key` is an array, and calls `check` for each of its values.
template <class Check>
void check_each(const program::Json_value& object, const char* key, const Check& check)
{
  const program::Json_value array = member(object, key);
  if (!array.json().is_array())
    array.fail_expected("an array");
  for (std::size_t i = 0; i < array.size(); ++i)
    check(array[i]);
}

/// Checks a diameter. It is null if the tree ends below breast height.
inline void check_diameter(const program::Json_value& object)
{
  const program::Json_value diameter = member(object, "diameter_at_breast_height");
  if (!diameter.json().is_null())
    diameter.number("a number or null");
}

inline Json read_edit(const std::string& path)
{
  program::read_edit(path); // checks all of it
  return Json(program::read_json(path, "an edit"));
}

/// Reads the report of `extract_tree_skeleton`.
inline Json read_scan_report(const std::string& path)
{
  const program::Json json = program::read_json(path, "the report of extract_tree_skeleton");
  const program::Json_value report(json, path);
  for (const char* const key : {"branches", "length", "volume"})
    member(member(report, "total"), key).number();
  check_each(report, "by_order", [](const program::Json_value& order) {
    member(order, "branches").number();
    member(order, "length").number();
  });
  member(report, "height").number();
  member(report, "volume").number();
  check_diameter(report);
  return Json(json);
}

/// Reads the report of `segment_trees`.
inline Json read_stand_report(const std::string& path)
{
  const program::Json json = program::read_json(path, "the report of segment_trees");
  check_each(program::Json_value(json, path), "trees", [](const program::Json_value& tree) {
    member(tree, "tree").number();
    member(tree, "height").number();
    check_diameter(tree);
  });
  return Json(json);
}

} // namespace gallery

#endif // PCS_EXAMPLES_GALLERY_REPORTS_H
