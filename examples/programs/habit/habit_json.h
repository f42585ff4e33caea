// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes and reads the habit of measured trees as JSON.

#ifndef PCS_EXAMPLES_PROGRAMS_HABIT_HABIT_JSON_H
#define PCS_EXAMPLES_PROGRAMS_HABIT_HABIT_JSON_H

#include "common/Json_value.h"
#include <pcs/core/errors.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Tree_habit_fit.h>

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace program {

constexpr const char* habit_format = "pcs_tree_habit";
constexpr int habit_version = 1;

/// Calls `visit(name, member)` for each member of a habit.
template <class Habit, class Visitor>
void visit_habit(Habit& h, const Visitor& visit)
{
  visit("height", h.height);
  visit("trunk_radius", h.trunk_radius);
  visit("flare", h.flare);
  visit("flare_height", h.flare_height);
  visit("lean", h.lean);
  visit("number_of_orders", h.number_of_orders);
  visit("largest_step", h.largest_step);
  visit("smallest_step", h.smallest_step);
  visit("bend_length", h.bend_length);
  visit("bend", h.bend);
  visit("bend_renewal", h.bend_renewal);
  visit("tropism", h.tropism);
  visit("sag", h.sag);
  visit("taper", h.taper);
  visit("tip_share", h.tip_share);
  visit("tip_radius", h.tip_radius);
  visit("spacing", h.spacing);
  visit("bare", h.bare);
  visit("whorl", h.whorl);
  visit("insertion", h.insertion);
  visit("child_radius", h.child_radius);
  visit("largest_branch", h.largest_branch);
  visit("smallest_branch", h.smallest_branch);
  visit("slenderness", h.slenderness);
  visit("crown", h.crown);
  visit("crown_radius", h.crown_radius);
  visit("number_of_leaders", h.number_of_leaders);
  visit("fork", h.fork);
  visit("fork_angle", h.fork_angle);
  visit("number_of_stubs", h.number_of_stubs);
  visit("flattest_section", h.flattest_section);
}

/// Calls `visit(name, quantiles)` for each quantity of a distribution.
template <class Distribution, class Visitor>
void visit_distribution(Distribution& d, const Visitor& visit)
{
  visit("length", d.length);
  visit("base_radius", d.base_radius);
  visit("slenderness", d.slenderness);
  visit("insertion", d.insertion);
  visit("radius_ratio", d.radius_ratio);
  visit("place", d.place);
  visit("number_of_children", d.number_of_children);
  visit("children_per_length", d.children_per_length);
}

inline const std::array<const char*, 3>& crown_names()
{
  static const std::array<const char*, 3> names = {"dome", "cone", "vase"};
  return names;
}

/// Converts members of a habit to JSON.
struct Member_writer
{
  nlohmann::ordered_json& json;

  template <class Number>
  static nlohmann::ordered_json value(const Number& number)
  {
    return number;
  }
  static nlohmann::ordered_json value(const pcs::Value_range& r) { return {r.least, r.largest}; }
  static nlohmann::ordered_json value(pcs::Crown_shape shape)
  {
    return crown_names()[static_cast<std::size_t>(shape)];
  }
  static nlohmann::ordered_json value(const std::array<pcs::Value_range, 2>& ranges)
  {
    return {value(ranges[0]), value(ranges[1])};
  }

  template <class Member>
  void operator()(const char* name, const Member& member) const
  {
    json[name] = value(member);
  }
};

/// Reads members of a habit; every one must be there.
struct Member_reader
{
  const Json_value& json;

  static void read(const Json_value& v, double& number) { number = v.number(); }
  template <class Integer>
  static void read_integer(const Json_value& v, Integer& number)
  {
    const double value = v.number("an integer");
    if (!(value >= 0 && value <= 1e9) || value != std::floor(value))
      v.fail_expected("an integer, 0 or more");
    number = static_cast<Integer>(value);
  }
  static void read(const Json_value& v, int& number) { read_integer(v, number); }
  static void read(const Json_value& v, std::size_t& number) { read_integer(v, number); }
  static void read(const Json_value& v, pcs::Value_range& range)
  {
    v.array(2, "[least, largest]");
    range = {v[std::size_t(0)].number(), v[std::size_t(1)].number()};
  }
  static void read(const Json_value& v, pcs::Crown_shape& shape)
  {
    for (std::size_t i = 0; i < crown_names().size(); ++i)
      if (v.json() == crown_names()[i]) {
        shape = static_cast<pcs::Crown_shape>(i);
        return;
      }
    v.fail_expected("\"dome\", \"cone\" or \"vase\"");
  }
  template <class Value, std::size_t n>
  static void read(const Json_value& v, std::array<Value, n>& values)
  {
    v.array(n, "an array of length " + std::to_string(n));
    for (std::size_t i = 0; i < n; ++i)
      read(v[i], values[i]);
  }

  template <class Member>
  void operator()(const char* name, Member& member) const
  {
    if (!json.has(name))
      json.fail(std::string("the key \"") + name + "\" is missing");
    read(json[name], member);
  }
};

inline nlohmann::ordered_json json_of(const pcs::Habit_value& v, const std::string& length_unit)
{
  return {{"name", v.name},
          {"unit",
           v.unit == "L"   ? length_unit
           : v.unit == "-" ? "1"
                           : v.unit},
          {"value", v.value},
          {"standard_error", v.standard_error},
          {"interval_95", {v.least, v.largest}},
          {"number_of_samples", v.number_of_samples},
          {"is_identified", v.is_identified}};
}

/// The whole fit as JSON. Lengths have the unit `length_unit`, angles are in radians.
inline nlohmann::ordered_json json_of(const pcs::Tree_habit_fit& fit,
                                      const std::string& length_unit,
                                      const std::vector<std::string>& sources)
{
  nlohmann::ordered_json json = {{"format", habit_format},
                                 {"version", habit_version},
                                 {"length_unit", length_unit},
                                 {"angle_unit", "rad"},
                                 {"sources", sources},
                                 {"number_of_trees", fit.number_of_trees},
                                 {"number_of_branches", fit.number_of_branches},
                                 {"smallest_radius", fit.smallest_radius},
                                 {"crown_margin", std::min(fit.crown_margin, 1e6)}};
  visit_habit(fit.habit, Member_writer{json["habit"]});
  const pcs::Habit_allometry& a = fit.allometry;
  json["allometry"] = {{"height", a.height},
                       {"height_spread", a.height_spread},
                       {"trunk_radius_exponent", a.trunk_radius_exponent},
                       {"crown_radius_exponent", a.crown_radius_exponent},
                       {"trunk_radius_error", a.trunk_radius_error},
                       {"crown_radius_error", a.crown_radius_error},
                       {"is_identified", a.is_identified}};
  json["values"] = nlohmann::ordered_json::array();
  for (const pcs::Habit_value& v : fit.values)
    json["values"].push_back(json_of(v, length_unit));
  json["quantiles"] = {0.05, 0.25, 0.5, 0.75, 0.95};
  json["distributions"] = nlohmann::ordered_json::array();
  for (const pcs::Habit_distribution& d : fit.distributions) {
    nlohmann::ordered_json entry = {{"order", d.order},
                                    {"number_of_branches", d.number_of_branches}};
    visit_distribution(d, Member_writer{entry});
    json["distributions"].push_back(entry);
  }
  return json;
}

inline pcs::Habit_allometry read_allometry(const Json_value& v)
{
  v.object({"height",
            "height_spread",
            "trunk_radius_exponent",
            "crown_radius_exponent",
            "trunk_radius_error",
            "crown_radius_error",
            "is_identified"});
  pcs::Habit_allometry a;
  const Member_reader read{v};
  read("height", a.height);
  read("height_spread", a.height_spread);
  read("trunk_radius_exponent", a.trunk_radius_exponent);
  read("crown_radius_exponent", a.crown_radius_exponent);
  if (!(a.height > 0))
    v.fail("\"height\" must be positive");
  if (!(a.height_spread >= 0 && a.height_spread <= 1))
    v.fail("\"height_spread\" must be in [0, 1]");
  if (v.has("trunk_radius_error"))
    read("trunk_radius_error", a.trunk_radius_error);
  if (v.has("crown_radius_error"))
    read("crown_radius_error", a.crown_radius_error);
  a.is_identified = v.has("is_identified") && v["is_identified"].json() == true;
  return a;
}

/// Reads what is needed to grow trees: the habit, its allometry, and the resolution. `length_unit`
/// receives the unit. Throws `pcs::IO_error`.
inline pcs::Tree_habit_fit read_habit(const std::string& path, std::string& length_unit)
{
  const Json json = read_json(path, "a habit of fit_tree_habit");
  const Json_value v(json, path);
  v.object({"format",
            "version",
            "length_unit",
            "angle_unit",
            "sources",
            "number_of_trees",
            "number_of_branches",
            "smallest_radius",
            "crown_margin",
            "habit",
            "allometry",
            "values",
            "quantiles",
            "distributions"});
  for (const char* key :
       {"format", "version", "length_unit", "smallest_radius", "habit", "allometry"})
    if (!v.has(key))
      v.fail(std::string("the key \"") + key + "\" is missing");
  if (v["format"].json() != habit_format)
    v["format"].fail_expected(std::string("\"") + habit_format + "\"");
  if (v["version"].json() != habit_version)
    v["version"].fail_expected("version " + std::to_string(habit_version));
  if (!v["length_unit"].json().is_string())
    v["length_unit"].fail_expected("a unit such as \"m\"");
  length_unit = v["length_unit"].json().get<std::string>();

  pcs::Tree_habit_fit fit;
  const Json_value habit = v["habit"];
  if (!habit.json().is_object())
    habit.fail_expected("an object");
  visit_habit(fit.habit, Member_reader{habit});
  try {
    pcs::internal::check_habit(fit.habit);
  } catch (const pcs::Invalid_input& e) {
    habit.fail(e.what());
  }
  fit.allometry = read_allometry(v["allometry"]);
  fit.smallest_radius = v["smallest_radius"].number();
  if (fit.smallest_radius < 0)
    v["smallest_radius"].fail_expected("0 or more");
  return fit;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_HABIT_HABIT_JSON_H
