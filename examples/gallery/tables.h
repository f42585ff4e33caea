// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What the views read: tables of cylinders, branches of skeletons, random subsets of points.

#ifndef PCS_EXAMPLES_GALLERY_TABLES_H
#define PCS_EXAMPLES_GALLERY_TABLES_H

#include "Page.h"
#include "common/read_skeleton.h"
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>

#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace gallery {

using Kernel = CGAL::Simple_cartesian<double>;

/// A row of the table of cylinders that `extract_tree_skeleton` writes.
struct Cylinder
{
  Point start, end;
  double radius = 0, radius_error = 0;
  std::size_t branch = 0; ///< from 0
  int order = 0;
};

inline std::vector<double> numbers_of_line(const std::string& line,
                                           std::size_t expected,
                                           const std::string& path,
                                           std::size_t number)
{
  std::vector<double> values;
  std::istringstream words(line);
  for (std::string word; std::getline(words, word, ',');) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      throw pcs::IO_error(path,
                          "line " + std::to_string(number) + ": expected a number, found '" + word +
                              "'");
    values.push_back(value);
  }
  if (values.size() != expected)
    throw pcs::IO_error(path,
                        "line " + std::to_string(number) + ": expected " +
                            std::to_string(expected) + " numbers, found " +
                            std::to_string(values.size()));
  return values;
}

/// Reads the table of cylinders (CSV) of `extract_tree_skeleton`, with the errors of the radii.
inline std::vector<Cylinder> read_cylinders(const std::string& path)
{
  std::string text = text_of_file(path);
  text.erase(std::remove(text.begin(), text.end(), '\r'), text.end()); // of line ends of Windows
  if (text.rfind("\xEF\xBB\xBF", 0) == 0)                              // the mark of UTF-8
    text.erase(0, 3);
  std::istringstream lines(text);
  std::string line, name;
  std::getline(lines, line);
  std::vector<std::string> names;
  for (std::istringstream words(line); std::getline(words, name, ',');)
    names.push_back(name);
  std::vector<std::size_t> column;
  for (const char* const wanted : {"sx",
                                   "sy",
                                   "sz",
                                   "ax",
                                   "ay",
                                   "az",
                                   "length",
                                   "radius",
                                   "radius_error",
                                   "branch",
                                   "order"}) {
    const auto at = std::find(names.begin(), names.end(), wanted);
    if (at == names.end())
      throw pcs::IO_error(path,
                          std::string("has no column `") + wanted +
                              "`; expected the table of --cylinders of extract_tree_skeleton");
    column.push_back(static_cast<std::size_t>(at - names.begin()));
  }
  std::vector<Cylinder> cylinders;
  for (std::size_t number = 2; std::getline(lines, line); ++number) {
    const std::vector<double> row = numbers_of_line(line, names.size(), path, number);
    const auto value = [&](std::size_t k) { return row[column[k]]; };
    Cylinder c;
    c.start = Point(value(0), value(1), value(2));
    c.end = c.start + value(6) * Kernel::Vector_3(value(3), value(4), value(5));
    c.radius = value(7);
    c.radius_error = value(8);
    const auto fail = [&](const std::string& what) {
      throw pcs::IO_error(path, "line " + std::to_string(number) + ": " + what);
    };
    if (value(9) < 1 || value(9) > 1e9 || value(9) != std::floor(value(9)) ||
        std::abs(value(10)) > 1000)
      fail("expected a branch from 1 and an order up to 1000");
    if (c.radius < 0 || !((c.end - CGAL::ORIGIN).squared_length() < 1e300))
      fail("expected a radius of 0 or more, and coordinates below 1e150");
    c.branch = static_cast<std::size_t>(value(9)) - 1;
    c.order = static_cast<int>(value(10));
    cylinders.push_back(c);
  }
  return cylinders;
}

/// Returns the index of the cylinder of the branch that is nearest to each point, or `none`. A
/// branch without cylinders has none.
inline std::vector<std::size_t> nearest_cylinders(const std::vector<Point>& points,
                                                  const std::vector<double>& branch,
                                                  const std::vector<Cylinder>& cylinders,
                                                  std::size_t none)
{
  std::map<double, std::vector<std::size_t>> of_branch; // numbers of branches may have large gaps
  for (std::size_t i = 0; i < cylinders.size(); ++i)
    of_branch[static_cast<double>(cylinders[i].branch)].push_back(i);
  std::vector<std::size_t> result(points.size(), none);
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (!(branch[p] >= 0))
      continue;
    const auto found = of_branch.find(branch[p]);
    if (found == of_branch.end())
      continue;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : found->second) {
      const Cylinder& c = cylinders[i];
      const Kernel::Vector_3 axis = c.end - c.start, v = points[p] - c.start;
      const double length = axis.squared_length();
      const double t = length > 0 ? std::clamp(v * axis / length, 0.0, 1.0) : 0;
      const double distance = (v - t * axis).squared_length();
      if (distance < least) {
        least = distance;
        result[p] = i;
      }
    }
  }
  return result;
}

/// Nodes of a skeleton: the same number for each branch, at equal distances along it.
struct Branches
{
  std::vector<Point> point;
  std::vector<double> radius;
  std::vector<std::uint8_t> order; ///< of each branch
};

/// Reads a skeleton and places `n` nodes on each branch, in the order of the branches in the file.
/// Trees of one family with all branches thus have corresponding nodes.
inline Branches read_branches(const std::string& path, std::size_t n)
{
  pcs::Tree_skeleton<Kernel> tree;
  std::vector<std::int64_t> ids;
  program::read_skeleton<Kernel>(path, tree, ids);
  auto nodes = pcs::nodes_by_branch(tree);
  std::sort(nodes.begin(), nodes.end()); // by the first node
  Branches result;
  for (const std::vector<std::size_t>& branch : nodes) {
    std::vector<double> place(branch.size(), 0);
    for (std::size_t i = 1; i < branch.size(); ++i) {
      const Kernel::Vector_3 step = tree[branch[i]].point - tree[branch[i - 1]].point;
      place[i] = place[i - 1] + std::sqrt(step.squared_length());
    }
    for (std::size_t k = 0, i = 0; k < n && !branch.empty(); ++k) {
      const double at = place.back() * static_cast<double>(k) / static_cast<double>(n - 1);
      while (i + 2 < branch.size() && place[i + 1] < at)
        ++i;
      const std::size_t j = std::min(i + 1, branch.size() - 1);
      const double length = place[j] - place[i];
      const double t = length > 0 ? std::clamp((at - place[i]) / length, 0.0, 1.0) : 0;
      const auto &a = tree[branch[i]], &b = tree[branch[j]];
      result.point.push_back(a.point + t * (b.point - a.point));
      result.radius.push_back((1 - t) * a.radius + t * b.radius);
    }
    const int order = tree[boost::graph_bundle].branches[tree[branch.front()].branch].order;
    result.order.push_back(static_cast<std::uint8_t>(std::clamp(order, 0, 255)));
  }
  return result;
}

/// Returns the sorted indices of a random subset of at most `most` of `n` points.
inline std::vector<std::size_t> random_subset(std::size_t n, std::size_t most)
{
  std::vector<std::size_t> indices(n);
  for (std::size_t i = 0; i < n; ++i)
    indices[i] = i;
  if (n <= most)
    return indices;
  std::mt19937_64 engine(1);
  for (std::size_t i = 0; i < most; ++i)
    std::swap(indices[i], indices[i + engine() % (n - i)]);
  indices.resize(most);
  std::sort(indices.begin(), indices.end());
  return indices;
}

template <class T>
std::vector<T> select(const std::vector<T>& values, const std::vector<std::size_t>& indices)
{
  std::vector<T> result;
  result.reserve(indices.size());
  for (const std::size_t i : indices)
    result.push_back(values[i]);
  return result;
}

} // namespace gallery

#endif // PCS_EXAMPLES_GALLERY_TABLES_H
