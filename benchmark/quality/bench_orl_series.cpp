// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Plants scanned at three times: predicts the middle one from the other two, and compares with
// linear morphing and with no change.

#include <support/growth_series.h>
#include <support/material_places.h>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <string>
#include <vector>

using namespace orl_test;

namespace {

void print(const std::string& what, const Series& series)
{
  const Prediction p = predict(series);
  std::printf("| %s | %.2f | %.3f | %.3f | %.3f | %.3f | %.3f | %.3f | %.2f | %s | %.0f |\n",
              what.c_str(),
              series.lambda,
              p.geodesic,
              p.in_order,
              p.linear,
              p.first,
              p.last,
              p.attainable,
              p.unexplained,
              p.is_grown_at_tips ? "at tips" : "along",
              p.turn * 180 / CGAL_PI);
  std::fflush(stdout);
}

void tomato(const std::string& data)
{
  const std::string days[] = {"03-05", "03-06", "03-08", "03-10"};
  const double day[] = {0, 1, 3, 5};
  std::vector<Seen_plant> plants;
  for (std::size_t i = 0; i < 4; ++i)
    plants.push_back(read_plant(data + "/tomato_series/" + days[i] + (i < 2 ? ".xyz" : ".ply"),
                                data + "/tomato_series/" + days[i] + ".graph.txt",
                                40000));
  const std::size_t triples[][3] = {{0, 2, 3}, {0, 1, 3}, {0, 1, 2}, {1, 2, 3}};
  for (const auto& [a, m, b] : triples)
    print("tomato " + days[a] + " " + days[m] + " " + days[b],
          {plants[a],
           plants[m],
           plants[b],
           (day[m] - day[a]) / (day[b] - day[a]),
           Vec3::UnitZ(),
           false});
}

/// Axes of four plants on up to eleven days of March, without radii. Each day is predicted from the
/// days before and after it.
void axes_of_plants(const std::string& data)
{
  const std::pair<std::string, std::vector<int>> plants[] = {
      {"M01", {13, 15, 17, 19, 21, 24, 25}},
      {"M02", {13, 15, 17, 19, 21, 25}},
      {"T03", {5, 7, 9, 11, 13, 15, 17, 19, 21, 24, 25}},
      {"T04", {5, 7, 9, 11, 13, 15, 17, 19, 21, 24, 25}}};
  for (const auto& [name, days] : plants) {
    std::vector<Seen_plant> seen;
    for (const int day : days)
      seen.push_back(read_axes(data + "/growth_swc/" + name + (day < 10 ? "_030" : "_03") +
                                   std::to_string(day) + "_a_seg.swc",
                               4000));
    for (std::size_t i = 0; i + 2 < days.size(); ++i)
      print(name + " day " + std::to_string(days[i + 1]),
            {seen[i],
             seen[i + 1],
             seen[i + 2],
             double(days[i + 1] - days[i]) / (days[i + 2] - days[i]),
             Vec3::UnitZ(),
             false});
  }
}

/// Reads the files young, medium and adult, and tests all orders.
void european(const std::string& data)
{
  const std::string names[] = {"young", "medium", "adult"};
  std::vector<Seen_plant> models;
  for (const std::string age : {"y", "m", "a"})
    models.push_back(
        read_model(data + "/skel_collections/EU06" + age + "_postProcessing_max.txtskl",
                   40000,
                   static_cast<unsigned>(models.size())));
  const std::size_t triples[][3] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}};
  for (const auto& [a, m, b] : triples)
    print("EU06 " + names[a] + " " + names[m] + " " + names[b],
          {models[a], models[m], models[b], 0.5, Vec3::UnitY(), true});
}

Seen_plant scanned(const Tree& tree, int seed, double turn)
{
  Seen_plant result;
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix();
  result.tree = moved(tree, rotation, Vec3::Zero());
  for (const Point& p : scan_wood(tree, seed, 2).points)
    result.scan.push_back(to_cgal(rotation * to_eigen(p)));
  return result;
}

/// Growing trees, and triples of unrelated trees of one kind.
void virtual_trees(int first_seed, int number)
{
  const std::pair<std::string, pcs::Tree_habit> habits[] = {{"broadleaf", pcs::broadleaf_habit()},
                                                            {"fruit", pcs::fruit_habit()},
                                                            {"forked", pcs::forked_habit()}};
  for (const auto& [name, habit] : habits)
    for (int seed = first_seed; seed < first_seed + number; ++seed) {
      const auto grown = [&, &h = habit](int of) {
        Tree tree;
        pcs::grow_tree(tree, h, pcs::parameters::random_seed(of));
        return tree;
      };
      const Tree tree = grown(seed);
      std::vector<std::size_t> nodes;
      std::vector<Seen_plant> stages, others;
      int turn = 0;
      for (const double age : {0.5, 0.75, 1.0}) {
        stages.push_back(scanned(pcs::tree_at_age(tree, age, nodes), 10 * seed + turn, turn));
        ++turn;
      }
      print(name + " " + std::to_string(seed) + " growing",
            {stages[0], stages[1], stages[2], 0.5, Vec3::UnitZ(), true});
      for (const int k : {0, 1, 2})
        others.push_back(scanned(grown(1000 * seed + k), 10 * seed + k, 0));
      print(name + " " + std::to_string(seed) + " strangers",
            {others[0], others[1], others[2], 0.5, Vec3::UnitZ(), true});
    }
}

} // namespace

int main(int argc, char** argv)
{
  std::string data;
  int first_seed = 1, trees = 2;
  CLI::App app("Chamfer distances of predicted points to the scan in the middle.");
  app.add_option("--data", data, "folder with tomato_series, growth_swc and skel_collections");
  app.add_option("--trees", trees, "number of virtual trees of each habit")->capture_default_str();
  app.add_option("--first-seed", first_seed, "first seed of the virtual trees")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::printf(
      "| plant | lambda | geodesic | sequential | linear | first end | last end | attainable | "
      "unexplained | growth | rotation [deg] |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  if (!data.empty()) {
    tomato(data);
    axes_of_plants(data);
    european(data);
  }
  virtual_trees(first_seed, trees);
  return 0;
}
