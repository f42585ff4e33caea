// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program orl_geodesic for families: means, modes, random trees, growth, changes, saved
// spaces, and invalid input.

#include <pcs/IO/read_swc.h>
#include <pcs/IO/write_swc.h>
#include <pcs/core/rotations.h>
#include <support/orl_trees.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <examples/Program_run.h>
#include <string>
#include <vector>

namespace test_orl_family_program {

namespace {

struct Three_trees : Program_run
{
  Three_trees() : Program_run("orl_geodesic")
  {
    using namespace orl_test;
    for (unsigned k = 0; k < 3; ++k) {
      // One tree at three ages, the second of them with a wider crown.
      orl_test::Tree tree = moved(random_tree(71, 4, 2),
                                  Eigen::Matrix3d::Identity(),
                                  Vec3(0, 0, 0),
                                  1 + 0.2 * static_cast<double>(k));
      if (k == 1)
        for (const auto v : boost::make_iterator_range(vertices(tree)))
          tree[v].point =
              Kernel::Point_3(1.1 * tree[v].point.x(), 1.1 * tree[v].point.y(), tree[v].point.z());
      const std::string name = "abc"[k] + std::string();
      pcs::IO::write_swc(path(name + ".swc"), tree);
      Table table(tube_points(tree, 1500 + 200 * k, k + 1));
      table.add_property("height", std::vector<float>(table.number_of_points(), float(k)));
      table.add_property("red", std::vector<std::uint8_t>(table.number_of_points(), 100));
      table.add_property("label", std::vector<std::int32_t>(table.number_of_points(), 7));
      pcs::IO::write_points(path(name + ".ply"), table);
    }
  }
  const std::string skeletons = "--skeleton a.swc --skeleton b.swc --skeleton c.swc ";
  const std::string trees = skeletons + "--tree a.ply --tree b.ply --tree c.ply ";

  void succeeds(const std::string& arguments)
  {
    const int code = run(arguments);
    BOOST_TEST_REQUIRE(code == 0, arguments << ": exit code " << code << ": " << err);
  }
  void refuses(const std::string& arguments, const std::string& word)
  {
    const int code = run(arguments);
    BOOST_TEST(code == 1, arguments << ": exit code " << code);
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
    const auto lines = std::count(err.begin(), err.end(), '\n');
    BOOST_TEST((lines == 1 || lines == 2), arguments << ": " << err);
  }
  double length(const std::string& name) const
  {
    orl_test::Tree tree;
    pcs::IO::read_swc<orl_test::Kernel>(path(name), tree);
    double sum = 0;
    for (const auto e : boost::make_iterator_range(edges(tree)))
      sum += std::sqrt(
          CGAL::squared_distance(tree[source(e, tree)].point, tree[target(e, tree)].point));
    return sum;
  }
};

} // namespace

BOOST_FIXTURE_TEST_SUITE(orl_family_program, Three_trees)

BOOST_AUTO_TEST_CASE(a_mean_mixes_points_and_properties)
{
  succeeds(trees + "--mean --mean-kind frechet --weights 0,1,0 --mesh --output out");
  const Table mean = pcs::IO::read_points(path("out/mean.ply"));
  BOOST_TEST(mean.number_of_points() >= 1500u);
  std::size_t number_mixed = 0;
  for (const double v : mean.property_as_double("height")) {
    BOOST_TEST(v >= 0);
    BOOST_TEST(v <= 2);
    number_mixed += std::abs(v - 1) < 1e-3; // between 0, 1 and 2
  }
  BOOST_TEST(number_mixed > mean.number_of_points() * 8 / 10);
  for (const double v : mean.property_as_double("red"))
    BOOST_TEST(v == 100);
  for (const double v : mean.property_as_double("label"))
    BOOST_TEST(v == 7);
  const double middle = (length("a.swc") + length("b.swc") + length("c.swc")) / 3;
  BOOST_TEST(std::abs(length("out/mean.swc") / middle - 1) <
             0.02); // mean of all; the weights select one tree
  BOOST_TEST(std::abs(length("out/weighted_mean.swc") / length("b.swc") - 1) < 0.02);
  BOOST_TEST(exists("out/mean_surface.ply"));
  BOOST_TEST(exists("out/weighted_mean_surface.ply"));
}

BOOST_AUTO_TEST_CASE(trees_of_given_scores_are_written)
{
  succeeds(skeletons + "--modes 2 --scores=-2 --scores=2,0 --scores 0,1 --output out");
  BOOST_TEST(content("out/scores_0000.swc") == content("out/mode_1_minus.swc"));
  BOOST_TEST(content("out/scores_0001.swc") == content("out/mode_1_plus.swc"));
  BOOST_TEST(content("out/scores_0002.swc") != content("out/mode_2_plus.swc"));
  BOOST_TEST(!exists("out/scores_0003.swc"));
  refuses(skeletons + "--modes 2 --scores 1,2,3 --output three", "at most one per mode");
  BOOST_TEST(!exists("three/mode_1_plus.swc"));
  refuses(skeletons + "--modes 2 --scores 1,,2 --output three", "numbers separated by commas");
  refuses(skeletons + "--modes 2 --scores 1,nan --output three", "between -100 and 100");
  refuses(skeletons + "--mean --scores 1 --output three", "without --modes");
}

BOOST_AUTO_TEST_CASE(modes_and_new_trees_are_written)
{
  succeeds(skeletons + "--modes 2 --sample 3 --seed 5 --distances d.csv --output out");
  const Json modes = Json::parse(content("out/modes.json"));
  BOOST_TEST(modes["number_of_modes"].get<int>() == 2);
  BOOST_TEST(modes["modes"].size() == 2u);
  BOOST_TEST(modes["modes"][0]["scores"].size() == 3u);
  BOOST_TEST(modes["outlier_scores"].size() == 3u);
  // The size has the largest variance.
  const double small = length("out/mode_1_minus.swc"), large = length("out/mode_1_plus.swc");
  BOOST_TEST(std::max(small, large) > 1.3 * std::min(small, large));
  for (const char* name : {"out/mode_2_minus.swc", "out/mode_2_plus.swc", "out/sample_0002.swc"})
    BOOST_TEST(exists(name));
  BOOST_TEST(!exists("out/sample_0003.swc"));
  BOOST_TEST(!exists("out/mean.swc"));
  BOOST_TEST(content("out/sample_0000.swc") != content("out/sample_0001.swc"));
  const std::string distances = content("d.csv");
  BOOST_TEST(std::count(distances.begin(), distances.end(), '\n') == 3);
  BOOST_TEST(std::count(distances.begin(), distances.end(), ',') == 6);
  BOOST_TEST(modes["measure"] == "branches");
  BOOST_TEST(modes["left_out_error_of_mean"].get<double>() > 0);
  succeeds("--skeleton a.swc --skeleton b.swc --modes 1 --output two"); // none can be left out
  const Json two = Json::parse(content("two/modes.json"));
  BOOST_TEST(two["left_out_error_of_mean"].is_null());
  BOOST_TEST(two["modes"][0]["left_out_error"].is_null());
  succeeds("--skeleton a.swc --skeleton a.swc --modes 1 --output same");
  BOOST_TEST((Json::parse(content("same/modes.json"))["modes"] == Json::array()));
  succeeds(skeletons + "--modes 5 --output many");
  BOOST_TEST(err.find("no more than 2 mode(s)") != std::string::npos, err);
  succeeds(skeletons + "--modes 2 --mode-inner-product metric --output metric --report three.json");
  // For more than two trees there are no values of pairs.
  BOOST_TEST(out.find("3 trees, ") != std::string::npos, out);
  BOOST_TEST(out.find("distance") == std::string::npos, out);
  const Json three = Json::parse(content("three.json"));
  for (const char* name : {"matching_energy",
                           "unexplained_fraction",
                           "is_grown_at_tips",
                           "yaw_degrees",
                           "number_of_matched_branches"})
    BOOST_TEST(!three.contains(name), name);
  BOOST_TEST(three["number_of_nodes"].size() == 3u);
  BOOST_TEST(three["number_of_points"].size() == 3u);
  BOOST_TEST(three.contains("fraction_of_changed_matches"));
  BOOST_TEST(Json::parse(content("metric/modes.json"))["measure"] == "metric");
  BOOST_TEST(content("metric/mode_1_plus.swc") != content("out/mode_1_plus.swc"));
  // A seed determines the trees.
  succeeds(skeletons + "--sample 2 --seed 5 --output again");
  BOOST_TEST(content("out/sample_0001.swc") == content("again/sample_0001.swc"));
  succeeds(skeletons + "--sample 2 --seed 6 --output other");
  BOOST_TEST(content("out/sample_0001.swc") != content("other/sample_0001.swc"));
}

BOOST_AUTO_TEST_CASE(absent_branches_are_written_on_request_only)
{
  using namespace orl_test;
  const std::vector<Branch> branches = random_branches(72, 5, 3);
  std::string family;
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<char> is_kept(branches.size(), 1);
    for (std::size_t b = 1; b < branches.size(); ++b)
      is_kept[b] = b % 4 == k ? 0 : 1;
    std::vector<std::size_t> tip;
    const orl_test::Tree tree =
        make_tree(branches, Turns(branches.size(), Eigen::Matrix3d::Identity()), is_kept, tip);
    const std::string name = "pruned" + std::to_string(k) + ".swc";
    pcs::IO::write_swc(path(name), tree);
    family += "--skeleton " + name + ' ';
  }
  const std::string arguments = family +
                                "--modes 3 --mode-inner-product metric --sample 3 --mean " +
                                "--growth --frames 5 --lambda=-0.5,0.5,1.5 --output ";
  succeeds(arguments + "clean");
  succeeds(arguments + "whole --mesh --keep-absent-branches");
  std::size_t number_in_one_place = 0, number_without_radius = 0;
  for (const std::string name : {"mode_1_minus",
                                 "mode_1_plus",
                                 "mode_2_minus",
                                 "mode_2_plus",
                                 "mode_3_minus",
                                 "mode_3_plus",
                                 "sample_0000",
                                 "sample_0002",
                                 "mean",
                                 "growth_0001",
                                 "growth_0004",
                                 "lambda_-0.500",
                                 "lambda_0.500",
                                 "lambda_1.500"})
    for (const std::string result : {"clean", "whole"}) {
      orl_test::Tree tree;
      pcs::IO::read_swc<orl_test::Kernel>(path(result + '/' + name + ".swc"), tree);
      std::size_t joined = 0, thin = 0;
      for (const auto v : boost::make_iterator_range(vertices(tree)))
        thin += tree[v].radius > 0 ? 0 : 1;
      for (const auto e : boost::make_iterator_range(edges(tree)))
        joined += tree[source(e, tree)].branch == tree[target(e, tree)].branch &&
                          tree[source(e, tree)].point == tree[target(e, tree)].point
                      ? 1
                      : 0;
      if (result == "whole") {
        number_in_one_place += joined;
        number_without_radius += thin;
        BOOST_TEST(exists("whole/" + name + "_surface.ply"));
        continue;
      }
      BOOST_TEST(joined == 0u, name << ": " << joined << " nodes in the place of another");
      BOOST_TEST(thin == 0u, name << ": " << thin << " nodes without radius");
    }
  BOOST_TEST(number_in_one_place > 0u);
  BOOST_TEST(number_without_radius > 0u);
}

BOOST_AUTO_TEST_CASE(growth_and_changes_are_written)
{
  succeeds(skeletons + "--growth --times 0,2,3 --frames 4 --monotone --output out");
  double last = 0;
  for (int k = 0; k < 4; ++k) {
    const double now = length("out/growth_000" + std::to_string(k) + ".swc");
    BOOST_TEST(now > last);
    last = now;
  }
  BOOST_TEST(std::abs(last / length("c.swc") - 1) < 0.02);
  succeeds("--skeleton a.swc --skeleton c.swc --changes c.csv --output two");
  const std::string changes = content("c.csv");
  BOOST_TEST(changes.find("longer") != std::string::npos);
  BOOST_TEST(changes.find("new") == std::string::npos);
}

BOOST_AUTO_TEST_CASE(trees_that_were_put_down_anew_are_turned_back_on_request)
{
  std::string turned_skeletons, turned_trees;
  for (unsigned k = 0; k < 3; ++k) {
    const std::string name = "abc"[k] + std::string();
    orl_test::Tree tree;
    pcs::IO::read_swc<orl_test::Kernel>(path(name + ".swc"), tree);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(1.3 * k, orl_test::Vec3::UnitY()).toRotationMatrix();
    // y is the vertical, to distinguish it from the other axes.
    const Eigen::Matrix3d upright =
        pcs::rotation_between(orl_test::Vec3::UnitZ(), orl_test::Vec3::UnitY()).toRotationMatrix();
    pcs::IO::write_swc(path(name + "_up.swc"), orl_test::moved(tree, upright, {1, 2, 3}));
    pcs::IO::write_swc(path(name + "_turned.swc"),
                       orl_test::moved(tree, turn * upright, {1, 2, 3}));
    Table table = pcs::IO::read_points(path(name + ".ply"));
    std::vector<Table::Vector_3> normals;
    for (auto& p : table.points()) {
      const orl_test::Vec3 q = turn * upright * orl_test::to_eigen(p) + orl_test::Vec3(1, 2, 3);
      const orl_test::Vec3 n = turn * orl_test::Vec3::UnitX();
      p = orl_test::to_cgal(q);
      normals.emplace_back(n.x(), n.y(), n.z());
    }
    table.set_normals(normals);
    pcs::IO::write_points(path(name + "_turned.ply"), table);
    turned_skeletons += "--skeleton " + name + "_turned.swc ";
    turned_trees += "--tree " + name + "_turned.ply ";
  }
  const std::string wanted = "--growth --frames 3 --lambda 0.5 --output ";
  succeeds("--skeleton a_up.swc --skeleton b_up.swc --skeleton c_up.swc " + wanted + "still");
  succeeds(turned_skeletons + turned_trees + "--align yaw --up y --report r.json " + wanted +
           "back");
  succeeds(turned_skeletons + turned_trees + "--align yaw --up -y " + wanted + "under");
  succeeds(turned_skeletons + wanted + "turned");
  const auto difference = [&](const std::string& one, const std::string& two) {
    orl_test::Tree a, b;
    pcs::IO::read_swc<orl_test::Kernel>(path(one), a);
    pcs::IO::read_swc<orl_test::Kernel>(path(two), b);
    BOOST_TEST_REQUIRE(num_vertices(a) == num_vertices(b));
    double worst = 0;
    for (std::size_t v = 0; v < num_vertices(a); ++v)
      worst = std::max(worst, CGAL::squared_distance(a[v].point, b[v].point));
    return std::sqrt(worst);
  };
  for (const std::string name : {"growth_0001.swc", "growth_0002.swc", "lambda_0.500.swc"}) {
    BOOST_TEST(difference("still/" + name, "back/" + name) < 1e-3 * length("a.swc"));
    BOOST_TEST(difference("still/" + name, "under/" + name) < 1e-3 * length("a.swc"));
    BOOST_TEST(difference("still/" + name, "turned/" + name) > 0.01 * length("a.swc"));
  }
  for (const double n : pcs::IO::read_points(path("back/growth_0002.ply")).property_as_double("nx"))
    BOOST_TEST(n > 1 - 1e-6);
  const Json family = Json::parse(content("r.json"));
  BOOST_TEST(family["number_of_whorls"].size() == 3u);
  BOOST_TEST(family["number_of_broken_whorls"].size() == 3u);
  const Json turns = family["yaws_degrees"];
  BOOST_TEST_REQUIRE(turns.size() == 3u);
  BOOST_TEST(turns[0].get<double>() == 0);
  for (const std::size_t k : {1u, 2u}) // relative to the previous tree, which was rotated back
    BOOST_TEST(std::abs(std::remainder(turns[k].get<double>() + 1.3 * double(k) * 180 / CGAL_PI,
                                       360)) < 0.2);
}

BOOST_AUTO_TEST_CASE(a_saved_space_gives_the_same_trees)
{
  succeeds(trees + "--mean --sample 1 --save-space s.txt --output out");
  succeeds("--load-space s.txt --mean --sample 1 --output again");
  BOOST_TEST(content("out/mean.swc") == content("again/mean.swc"));
  BOOST_TEST(content("out/sample_0000.swc") == content("again/sample_0000.swc"));
  const Table one = pcs::IO::read_points(path("out/sample_0000.ply")),
              two = pcs::IO::read_points(path("again/sample_0000.ply"));
  BOOST_TEST((one.points() == two.points()));
  const std::string text = content("s.txt");
  for (std::size_t k = 1; k < 10; ++k) {
    write("cut.txt", text.substr(0, text.size() * k / 10));
    refuses("--load-space cut.txt --mean --output cut", "cut.txt");
  }
  write("cut.txt", text.substr(0, text.size() - 2)); // within the last number
  refuses("--load-space cut.txt --mean --output cut", "the last line has no end");
  BOOST_TEST(!exists("cut/mean.swc"));
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused_with_a_sentence)
{
  refuses(skeletons + "--output out", "--mean");
  refuses(skeletons + "--mean --weights 1,2 --output out", "--weights has 2 numbers for 3 trees");
  refuses(skeletons + "--mean --weights 1,-1,0 --output out", "add up");
  refuses(skeletons + "--weights 1,x,0 --output out", "weights");
  refuses(skeletons + "--weights 1,,0 --output out", "separated by commas");
  refuses(skeletons + "--growth --times 0,1, --output out", "separated by commas");
  refuses(skeletons + "--weights 1e308,1e308,0 --output out", "finite");
  refuses(skeletons + "--sample 1 --seed -1 --output out", "9223372036854775807");
  refuses(skeletons + "--sample 1 --seed 99999999999999999999 --output out", "at most 64 bits");
  refuses(skeletons + "--growth --times 0,2,1 --output out", "increase");
  refuses(skeletons + "--growth --times=-1e308,0,1e308 --output out", "times must differ by");
  refuses(skeletons + "--mean --growth --times 0,1 --output out", "--times has 2 numbers");
  refuses(skeletons + "--mean --changes c.csv --output out", "two trees");
  succeeds(skeletons + "--mean --save-space s.txt --output saved");
  refuses("--load-space s.txt --mean --weights 1,2 --output out", "--weights has 2 numbers");
  BOOST_TEST(!exists("out"));
  refuses(skeletons + "--mean --times 0,1,2 --output out", "--growth");
  refuses(skeletons + "--mean --mean-kind l3 --output out", "mean-kind");
  refuses(skeletons + "--modes 1 --mode-inner-product l2 --output out", "mode-inner-product");
  refuses(skeletons + "--sample -1 --output out", "sample");
  refuses(skeletons + "--modes -1 --output out", "modes");
  refuses(skeletons + "--mean --matches m.csv --output out", "two trees");
  refuses(skeletons + "--load-space s.txt --mean --output out", "only one of them");
  refuses("--load-space missing.txt --mean --output out", "missing.txt");
  refuses("--load-space s.txt --output out", "expected one of --lambda");
  refuses(skeletons + "--skeleton missing.swc --mean --output out", "missing.swc");
  write("file", "");
  refuses(skeletons + "--mean --output file", "file");
  for (const char* name : {"mean", "weighted_mean", "growth_0000", "sample_0000"})
    BOOST_TEST(!exists("out/" + std::string(name) + ".swc"));
}

BOOST_AUTO_TEST_CASE(options_that_would_have_no_effect_are_refused)
{
  succeeds(skeletons + "--mean --save-space s.txt --output out");
  for (const std::string option : {"--orientation world-axes",
                                   "--orientation gauge-fixed",
                                   "--extend-axes",
                                   "--align none",
                                   "--up z",
                                   "--transport exact",
                                   "--published-energy"}) {
    const std::string name = option.substr(0, option.find(' '));
    refuses("--load-space s.txt --mean --output again " + option, name + " has no effect with");
    BOOST_TEST(err.find("s.txt") != std::string::npos);
  }
  BOOST_TEST(!exists("again"));
  refuses("--load-space s.txt --mean --normals across --output again", "s.txt has no points");
  refuses(skeletons + "--mean --extend-axes --output again", "--extend-axes has no effect without");
  refuses(skeletons + "--mean --transport sinkhorn --output again", "--transport has no effect");
  for (const std::string option : {"--max-extrapolation-degrees 30",
                                   "--sequential-emergence",
                                   "--simultaneous-emergence",
                                   "--limit-radii",
                                   "--mode-inner-product metric",
                                   "--seed 1",
                                   "--any-range",
                                   "--pipe-model 2",
                                   "--frames 3",
                                   "--monotone"})
    refuses(skeletons + "--mean --output again " + option,
            option.substr(0, option.find(' ')) + " has no effect without");
  refuses(skeletons + "--growth --mean-kind median --output again", "--mean-kind has no effect");
  succeeds(skeletons + "--mean --align none --orientation transported --output again");
  succeeds("--load-space s.txt --lambda 0.5 --max-extrapolation-degrees 30 "
           "--sequential-emergence --limit-radii "
           "--output again");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_orl_family_program
