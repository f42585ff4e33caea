// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A plant seen at three times: how well the middle is predicted from the ends, by the space of trees and by simpler means.

#ifndef PCS_TEST_SUPPORT_GROWTH_SERIES_H
#define PCS_TEST_SUPPORT_GROWTH_SERIES_H

#include <pcs/IO/read_points.h>
#include <pcs/IO/read_txtskl.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/shape_space/best_turn.h>
#include <support/orl_trees.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace orl_test {

/// A skeleton and points about it.
struct Seen_plant
{
  Tree tree;
  std::vector<Point> scan;
};

/// Lines `v x y z` and `e i j`. The root is the lowest node of one edge; radii are not known.
inline Tree read_plant_graph(const std::string& path)
{
  std::ifstream file(path);
  if (!file)
    throw std::runtime_error(path + ": cannot be opened");
  Tree tree;
  std::vector<std::vector<std::size_t>> neighbors;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    double x = 0, y = 0, z = 0;
    std::size_t i = 0, j = 0;
    if (words >> kind && kind == "v" && words >> x >> y >> z) {
      pcs::Tree_node<Kernel> node;
      node.point = Point(x, y, z);
      node.radius = 0;
      add_vertex(node, tree);
      neighbors.emplace_back();
    } else if (kind == "e" && words >> i >> j) {
      neighbors.at(i).push_back(j);
      neighbors.at(j).push_back(i);
    }
  }
  std::size_t root = pcs::npos;
  for (std::size_t v = 0; v < neighbors.size(); ++v)
    if (neighbors[v].size() == 1 && (root == pcs::npos || tree[v].point.z() < tree[root].point.z()))
      root = v;
  if (root == pcs::npos)
    throw std::runtime_error(path + ": no node with one edge");
  std::vector<std::pair<std::size_t, std::size_t>> open{{root, pcs::npos}};
  while (!open.empty()) {
    const auto [v, parent] = open.back();
    open.pop_back();
    for (const std::size_t w : neighbors[v])
      if (w != parent) {
        add_edge(v, w, tree);
        open.emplace_back(w, v);
      }
  }
  tree[boost::graph_bundle].root = root;
  return tree;
}

/// A scan with its graph, thinned evenly in the order of the file.
inline Seen_plant
read_plant(const std::string& scan, const std::string& graph, std::size_t most_points)
{
  Seen_plant result;
  result.tree = read_plant_graph(graph);
  const auto table = pcs::IO::read_points(scan);
  const std::size_t n = table.points().size();
  for (std::size_t k = 0; k < std::min(n, most_points); ++k) {
    const auto& p = table.points()[n <= most_points ? k : k * n / most_points];
    result.scan.emplace_back(p.x(), p.y(), p.z());
  }
  return result;
}

/// A skeleton that stands on the origin, with points on its tubes.
inline Seen_plant read_model(const std::string& path, std::size_t number_of_points, unsigned seed)
{
  Tree tree;
  pcs::IO::read_txtskl<Kernel>(path, tree);
  const Vec3 root = to_eigen(tree[tree[boost::graph_bundle].root].point);
  Seen_plant result;
  result.tree = moved(tree, Eigen::Matrix3d::Identity(), -root);
  Tree wood = result.tree; // edges that only lead to a branch are not part of it
  remove_edge_if(
      [&](const auto& e) { return wood[source(e, wood)].branch != wood[target(e, wood)].branch; },
      wood);
  result.scan = tube_points(wood, number_of_points, seed);
  return result;
}

inline std::vector<Vec3> to_eigen(const std::vector<Point>& points)
{
  std::vector<Vec3> result;
  for (const Point& p : points)
    result.push_back(to_eigen(p));
  return result;
}

/// Mean of the mean distances to the nearest point, both ways.
inline double chamfer(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
  double result = 0;
  for (const auto& [from, to] : {std::make_pair(&a, &b), std::make_pair(&b, &a)}) {
    const pcs::neighborhood::Nearest_neighbors search(*to);
    std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> found;
    double sum = 0;
    for (const Vec3& p : *from) {
      search(p, 1, found);
      sum += std::sqrt(found[0].squared_distance);
    }
    result += 0.5 * sum / static_cast<double>(from->size());
  }
  return result;
}

/// Every point of each scan on the way to the nearest point of the other.
inline std::vector<Vec3>
morph_linearly(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double lambda)
{
  std::vector<Vec3> result;
  std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> found;
  const pcs::neighborhood::Nearest_neighbors in_a(a), in_b(b);
  for (const Vec3& p : a) {
    in_b(p, 1, found);
    result.push_back((1 - lambda) * p + lambda * b[found[0].index]);
  }
  for (const Vec3& q : b) {
    in_a(q, 1, found);
    result.push_back((1 - lambda) * a[found[0].index] + lambda * q);
  }
  return result;
}

/// A rotation and a shift.
struct Pose
{
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Vec3 shift = Vec3::Zero();
  Vec3 operator()(const Vec3& p) const { return rotation * p + shift; }
  std::vector<Vec3> operator()(std::vector<Vec3> points) const
  {
    for (Vec3& p : points)
      p = (*this)(p);
    return points;
  }
};

inline std::vector<Vec3> thinned(const std::vector<Vec3>& points, std::size_t most)
{
  std::vector<Vec3> result;
  const std::size_t n = points.size();
  for (std::size_t k = 0; k < std::min(n, most); ++k)
    result.push_back(points[n <= most ? k : k * n / most]);
  return result;
}

/// The pose that lays `points` on `target`: turned about `up` by all angles, with both centers in one place, then improved
/// with nearest points both ways.
inline Pose align(const std::vector<Vec3>& points, const std::vector<Vec3>& target, const Vec3& up)
{
  const std::vector<Vec3> few = thinned(points, 1000), seen = thinned(target, 1000);
  const pcs::neighborhood::Nearest_neighbors in_seen(seen);
  std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> found;
  constexpr int starts = 24, steps = 30;
  const auto center = [](const std::vector<Vec3>& all) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : all)
      sum += p;
    return Vec3(sum / static_cast<double>(all.size()));
  };
  Pose best;
  double least = chamfer(few, seen);
  for (int k = 0; k < starts; ++k) {
    Pose pose;
    pose.rotation = Eigen::AngleAxisd(2 * CGAL_PI * k / starts, up).toRotationMatrix();
    pose.shift = center(seen) - pose.rotation * center(few);
    for (int step = 0; step < steps; ++step) {
      const std::vector<Vec3> now = pose(few);
      const pcs::neighborhood::Nearest_neighbors in_now(now);
      std::vector<std::pair<Vec3, Vec3>> pairs;
      for (std::size_t i = 0; i < now.size(); ++i) {
        in_seen(now[i], 1, found);
        pairs.emplace_back(few[i], seen[found[0].index]);
      }
      for (const Vec3& q : seen) {
        in_now(q, 1, found);
        pairs.emplace_back(few[found[0].index], q);
      }
      Vec3 from = Vec3::Zero(), to = Vec3::Zero();
      for (const auto& [p, q] : pairs) {
        from += p / static_cast<double>(pairs.size());
        to += q / static_cast<double>(pairs.size());
      }
      Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
      for (const auto& [p, q] : pairs)
        covariance += (q - to) * (p - from).transpose();
      pose.rotation = pcs::shape_space::best_turn(covariance, pcs::Quaternion(pose.rotation))
                          .toRotationMatrix();
      pose.shift = to - pose.rotation * from;
    }
    const double distance = chamfer(pose(few), seen);
    if (distance < least) {
      least = distance;
      best = pose;
    }
  }
  return best;
}

/// Chamfer distances to what was seen in the middle. [L]
struct Prediction
{
  double geodesic, linear, first, last;
};

/// Pots are put down anew every day: the ends are aligned before, and each prediction before it is measured, all alike.
inline Prediction predict(const Seen_plant& a,
                          const Seen_plant& middle,
                          const Seen_plant& b,
                          double lambda,
                          const Vec3& up)
{
  const std::vector<Vec3> one = to_eigen(a.scan), seen = to_eigen(middle.scan);
  const Pose pose = align(to_eigen(b.scan), one, up);
  const std::vector<Vec3> two = pose(to_eigen(b.scan));
  std::vector<Point> turned;
  for (const Vec3& p : two)
    turned.push_back(to_cgal(p));
  pcs::Orl_shape_space<Kernel> space;
  space.add(a.tree, a.scan);
  space.add(moved(b.tree, pose.rotation, pose.shift), turned);
  space.build();
  std::vector<Point> points;
  space.points(space.geodesic(0, 1, lambda), points);
  const auto measure = [&](const std::vector<Vec3>& p) {
    return chamfer(align(p, seen, up)(p), seen);
  };
  return {measure(to_eigen(points)),
          measure(morph_linearly(one, two, lambda)),
          measure(one),
          measure(two)};
}

} // namespace orl_test

#endif // PCS_TEST_SUPPORT_GROWTH_SERIES_H
