// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Prints the accuracy of a skeleton as tables and as JSON.

#ifndef PCS_BENCHMARK_QUALITY_PRINT_ACCURACY_H
#define PCS_BENCHMARK_QUALITY_PRINT_ACCURACY_H

#include "Skeleton_accuracy.h"
#include "support/Table.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

namespace pcs_bench {

inline std::string percent(double share)
{
  return number(100 * share) + " %";
}

inline std::string radius_range(const Size_class& c)
{
  return std::isfinite(c.to) ? number(100 * c.from) + " - " + number(100 * c.to)
                             : "> " + number(100 * c.from);
}

inline void print(std::ostream& out, const Skeleton_accuracy& a)
{
  Table axes({"axes within", "precision", "recall", "F1"});
  const auto add_row = [&](const std::string& name, const Agreement& g) {
    axes.add({name, percent(g.precision), percent(g.recall), percent(g.f1())});
  };
  for (const Agreement& g : a.at_distance)
    add_row(number(100 * g.tolerance) + " cm", g);
  for (const Agreement& g : a.at_radius)
    add_row(number(g.tolerance) + " radius", g);
  axes.print(out);

  Table distances({"distance [mm]", "mean", "median", "rms", "95 %"});
  const auto add_distances = [&](const char* name, const Distances& d) {
    distances.add({name,
                   number(1000 * d.mean),
                   number(1000 * d.median),
                   number(1000 * d.rms),
                   number(1000 * d.quantile_95)});
  };
  add_distances("result to truth", a.to_truth);
  add_distances("truth to result", a.to_result);
  add_distances("points to surface", a.point_to_surface);
  distances.print(out);

  Table classes({"radius [cm]",
                 "true length [m]",
                 "seen",
                 "length",
                 "true volume [l]",
                 "volume",
                 "radius error",
                 "bias",
                 "compared",
                 "precision",
                 "recall"});
  for (const Size_class& c : a.size_classes)
    classes.add({radius_range(c),
                 number(c.true_length),
                 number(c.seen_length),
                 number(c.length),
                 number(1000 * c.true_volume),
                 number(1000 * c.volume),
                 percent(c.radius_error),
                 percent(c.radius_bias),
                 percent(c.matched_share),
                 percent(c.agreement.precision),
                 percent(c.agreement.recall)});
  classes.print(out);

  Table orders({"order",
                "true branches",
                "missed",
                "branches",
                "false",
                "matched",
                "parent right",
                "of length"});
  for (std::size_t i = 0; i < a.order_classes.size(); ++i) {
    const Order_class& c = a.order_classes[i];
    const auto matched = static_cast<double>(c.number_of_matched_branches);
    orders.add({std::to_string(i),
                std::to_string(c.number_of_true_branches),
                std::to_string(c.number_of_missed_branches),
                std::to_string(c.number_of_branches),
                std::to_string(c.number_of_false_branches),
                std::to_string(c.number_of_matched_branches),
                percent(static_cast<double>(c.number_of_correct_parents) / matched),
                percent(c.correct_length / c.matched_length)});
  }
  orders.print(out);

  Table totals({"", "truth", "result", "error"});
  totals.add({"length [m]",
              number(a.true_length, 5) + " (seen " + number(a.seen_length, 5) + ")",
              number(a.length, 5),
              percent(a.length_error())});
  totals.add(
      {"volume [m3]", number(a.true_volume, 4), number(a.volume, 4), percent(a.volume_error())});
  totals.add({"DBH [cm]",
              number(100 * a.true_dbh),
              number(100 * a.dbh),
              number(100 * a.dbh_error()) + " cm"});
  totals.add({"height [m]",
              number(a.true_height, 4),
              number(a.height, 4),
              percent((a.height - a.true_height) / a.true_height)});
  totals.print(out);
}

inline nlohmann::json to_json(const Agreement& g)
{
  return {{"tolerance", g.tolerance},
          {"precision", g.precision},
          {"recall", g.recall},
          {"f1", g.f1()}};
}

inline nlohmann::json to_json(const Distances& d)
{
  return {{"mean", d.mean}, {"median", d.median}, {"rms", d.rms}, {"quantile_95", d.quantile_95}};
}

/// Missing values become `null`.
inline nlohmann::json to_json(const Skeleton_accuracy& a)
{
  nlohmann::json json;
  for (const Agreement& g : a.at_distance)
    json["at_distance"].push_back(to_json(g));
  for (const Agreement& g : a.at_radius)
    json["at_radius"].push_back(to_json(g));
  json["to_truth"] = to_json(a.to_truth);
  json["to_result"] = to_json(a.to_result);
  json["point_to_surface"] = to_json(a.point_to_surface);
  for (const Size_class& c : a.size_classes)
    json["size_classes"].push_back({{"from", c.from},
                                    {"to", c.to},
                                    {"true_length", c.true_length},
                                    {"seen_length", c.seen_length},
                                    {"length", c.length},
                                    {"true_volume", c.true_volume},
                                    {"volume", c.volume},
                                    {"matched_share", c.matched_share},
                                    {"radius_error", c.radius_error},
                                    {"radius_bias", c.radius_bias},
                                    {"agreement", to_json(c.agreement)}});
  for (const Order_class& c : a.order_classes)
    json["order_classes"].push_back({{"true_branches", c.number_of_true_branches},
                                     {"missed_branches", c.number_of_missed_branches},
                                     {"branches", c.number_of_branches},
                                     {"false_branches", c.number_of_false_branches},
                                     {"matched_branches", c.number_of_matched_branches},
                                     {"correct_parents", c.number_of_correct_parents},
                                     {"matched_length", c.matched_length},
                                     {"correct_length", c.correct_length}});
  json["true_length"] = a.true_length;
  json["seen_length"] = a.seen_length;
  json["length"] = a.length;
  json["true_volume"] = a.true_volume;
  json["volume"] = a.volume;
  json["true_dbh"] = a.true_dbh;
  json["dbh"] = a.dbh;
  json["true_height"] = a.true_height;
  json["height"] = a.height;
  json["radius_error"] = a.radius_error;
  json["radius_bias"] = a.radius_bias;
  json["correct_parent_share"] = a.correct_parent_share();
  return json;
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_PRINT_ACCURACY_H
