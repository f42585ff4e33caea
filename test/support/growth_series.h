// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Plants scanned at three times: error of predicting the middle one from the others, in the space
// of trees and by simpler methods.

#ifndef PCS_TEST_SUPPORT_GROWTH_SERIES_H
#define PCS_TEST_SUPPORT_GROWTH_SERIES_H

#include <pcs/IO/read_points.h>
#include <pcs/IO/read_swc.h>
#include <pcs/IO/read_txtskl.h>
#include <pcs/Orl_shape_space.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/shape_space/input/extend_axes.h>
#include <pcs/shape_space/matching/align_vectors.h>
#include <support/orl_trees.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

namespace orl_test {

/// A skeleton and points of its plant.
struct Seen_plant
{
  Tree tree;
  std::vector<Point> scan;
};

/// Reads lines `v x y z` and `e i j`. The root is the lowest node with one edge; radii are unknown.
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

/// Reads a scan with its graph, thinned uniformly in file order. Graphs of some days end before the
/// tips of leaves, so all axes are extended.
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
  pcs::shape_space::extend_axes(result.tree, result.scan);
  return result;
}

/// A skeleton without radii, with points on its axes.
inline Seen_plant read_axes(const std::string& path, std::size_t number_of_points)
{
  Seen_plant result;
  pcs::IO::read_swc<Kernel>(path, result.tree);
  double length = 0;
  const auto for_each_edge = [&](const auto& f) {
    for (const auto e : boost::make_iterator_range(edges(result.tree)))
      f(to_eigen(result.tree[source(e, result.tree)].point),
        to_eigen(result.tree[target(e, result.tree)].point));
  };
  for_each_edge([&](const Vec3& from, const Vec3& to) { length += (to - from).norm(); });
  const double step = length / static_cast<double>(number_of_points);
  double next = 0; // from the beginning of the edge
  for_each_edge([&](const Vec3& from, const Vec3& to) {
    for (; next < (to - from).norm(); next += step)
      result.scan.push_back(to_cgal(from + next * (to - from).normalized()));
    next -= (to - from).norm();
  });
  for (const auto v : boost::make_iterator_range(vertices(result.tree)))
    result.tree[v].radius = 0;
  return result;
}

/// A skeleton shifted to the origin, with points on its tubes.
inline Seen_plant read_model(const std::string& path, std::size_t number_of_points, unsigned seed)
{
  Tree tree;
  pcs::IO::read_txtskl<Kernel>(path, tree);
  const Vec3 root = to_eigen(tree[tree[boost::graph_bundle].root].point);
  Seen_plant result;
  result.tree = moved(tree, Eigen::Matrix3d::Identity(), -root);
  Tree wood = result.tree; // without the edges that connect a branch to its parent
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

/// Mean of the mean distances to the nearest point, in both directions.
inline double chamfer(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
  double result = 0;
  using Clouds = std::pair<const std::vector<Vec3>*, const std::vector<Vec3>*>;
  const Clouds directions[] = {{&a, &b}, {&b, &a}};
  for (const auto& [from, to] : directions) {
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

/// Moves every point of each scan linearly towards the nearest point of the other.
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

/// Keeps the first point in each cell of a grid, so that dense regions and duplicate points have no
/// larger weight.
inline std::vector<Vec3> evened(const std::vector<Vec3>& points, double cell)
{
  std::set<std::array<long, 3>> taken;
  std::vector<Vec3> result;
  for (const Vec3& p : points)
    if (taken
            .insert(
                {std::lround(p.x() / cell), std::lround(p.y() / cell), std::lround(p.z() / cell)})
            .second)
      result.push_back(p);
  return result;
}

/// Aligns `points` with `target` by iterating nearest points in both directions, from an initial
/// pose. Rotates only about `up` if it is not null.
inline Pose improve_pose(Pose pose,
                         const std::vector<Vec3>& points,
                         const std::vector<Vec3>& target,
                         const Vec3& up,
                         int steps)
{
  const pcs::neighborhood::Nearest_neighbors in_target(target);
  std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> found;
  for (int step = 0; step < steps; ++step) {
    const std::vector<Vec3> now = pose(points);
    const pcs::neighborhood::Nearest_neighbors in_now(now);
    std::vector<std::pair<Vec3, Vec3>> pairs;
    for (std::size_t i = 0; i < now.size(); ++i) {
      in_target(now[i], 1, found);
      pairs.emplace_back(points[i], target[found[0].index]);
    }
    for (const Vec3& q : target) {
      in_now(q, 1, found);
      pairs.emplace_back(points[found[0].index], q);
    }
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    for (const auto& [p, q] : pairs) {
      from += p / static_cast<double>(pairs.size());
      to += q / static_cast<double>(pairs.size());
    }
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const auto& [p, q] : pairs)
      covariance += (q - to) * (p - from).transpose();
    if (up.isZero())
      pose.rotation = pcs::shape_space::align_vectors(covariance, pcs::Quaternion(pose.rotation))
                          .toRotationMatrix();
    else {
      const Eigen::Matrix3d skew = covariance.transpose() - covariance;
      const double sine = up.dot(Vec3(skew(1, 2), skew(2, 0), skew(0, 1)));
      const double cosine = covariance.trace() - up.dot(covariance * up);
      pose.rotation = Eigen::AngleAxisd(std::atan2(sine, cosine), up).toRotationMatrix();
    }
    pose.shift = to - pose.rotation * from;
  }
  return pose;
}

/// Finds the pose that aligns `points` with `target`. Initial poses have coincident centers and all
/// turns about `up`, and tilts of 30 degrees unless plants are known to be upright. The best
/// refined pose is returned; the initial poses do not depend on the pose of `points`.
inline Pose align(const std::vector<Vec3>& points,
                  const std::vector<Vec3>& target,
                  const Vec3& up,
                  bool is_upright)
{
  const auto center = [](const std::vector<Vec3>& all) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : all)
      sum += p;
    return Vec3(sum / static_cast<double>(all.size()));
  };
  const Vec3 axis = is_upright ? up : Vec3::Zero();
  const std::vector<Vec3> few = thinned(points, 400), seen = thinned(target, 400);
  const Vec3 side = up.unitOrthogonal();
  constexpr int turns = 24, tilts = 4, best_of = 6;
  std::vector<std::pair<double, Pose>> found;
  for (int k = 0; k < turns; ++k)
    for (int t = 0; t < (is_upright ? 1 : tilts + 1); ++t) {
      Pose pose;
      pose.rotation = Eigen::AngleAxisd(2 * CGAL_PI * k / turns, up).toRotationMatrix();
      if (t > 0)
        pose.rotation =
            Eigen::AngleAxisd(CGAL_PI / 6, Eigen::AngleAxisd(2 * CGAL_PI * t / tilts, up) * side) *
            pose.rotation;
      pose.shift = center(seen) - pose.rotation * center(few);
      pose = improve_pose(pose, few, seen, axis, 15);
      found.emplace_back(chamfer(pose(few), seen), pose);
    }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return a.first < b.first;
  });
  const std::vector<Vec3> more = thinned(points, 2000), more_seen = thinned(target, 2000);
  Pose best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < best_of; ++k) {
    const Pose pose = improve_pose(found[k].second, more, more_seen, axis, 30);
    const double distance = chamfer(pose(more), more_seen);
    if (distance < least) {
      least = distance;
      best = pose;
    }
  }
  return best;
}

/// A plant at three times.
struct Series
{
  Seen_plant first, middle, last;
  double lambda = 0.5; ///< time of the middle
  Vec3 up = Vec3::UnitZ();
  bool is_upright = false;
};

/// Chamfer distances to the scan of the middle time. [L]
struct Prediction
{
  double geodesic;
  double in_order; ///< the same, with branches that emerge in order
  double linear, first, last;
  double attainable;     ///< of two halves of the middle scan
  double unexplained;    ///< fraction of the smaller end that is not matched [-]
  bool is_grown_at_tips; ///< from the matching
  double turn;           ///< from the matching [rad]
};

/// Predicts the middle scan. Pots are repositioned every day, so the ends are aligned first, by
/// their points for linear morphing and by the space for the geodesic. Each prediction is aligned
/// before it is measured. Densities differ and predictions contain duplicates, so all clouds are
/// resampled uniformly first.
inline Prediction predict(const Series& series)
{
  const std::vector<Vec3> one = to_eigen(series.first.scan), seen = to_eigen(series.middle.scan),
                          last = to_eigen(series.last.scan);
  const Pose of_points = align(last, one, series.up, series.is_upright);
  const std::vector<Vec3> two = of_points(last);
  pcs::Orl_shape_space<Kernel> space;
  space.add(series.first.tree, series.first.scan);
  space.add(series.last.tree, series.last.scan);
  const pcs::Orl_report report =
      space.build(pcs::parameters::alignment(pcs::Orl_alignment::rotate_about_up)
                      .up_direction(Kernel::Vector_3(series.up.x(), series.up.y(), series.up.z())));
  std::vector<Point> points, in_order;
  space.points(space.geodesic(0, 1, series.lambda), points);
  space.points(space.geodesic(0,
                              1,
                              series.lambda,
                              pcs::parameters::branch_emergence(pcs::Branch_emergence::sequential)),
               in_order);
  Vec3 low = seen[0], high = seen[0];
  for (const Vec3& p : seen) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double cell = (high - low).norm() / 200;
  const std::vector<Vec3> truth = evened(seen, cell);
  const auto measure = [&](const std::vector<Vec3>& p) {
    const std::vector<Vec3> even = evened(p, cell);
    return chamfer(align(even, truth, series.up, series.is_upright)(even), truth);
  };
  std::array<std::vector<Vec3>, 2> half;
  for (std::size_t k = 0; k < seen.size(); ++k)
    half[k % 2].push_back(seen[k]);
  return {measure(to_eigen(points)),
          measure(to_eigen(in_order)),
          measure(morph_linearly(one, two, series.lambda)),
          measure(one),
          measure(two),
          chamfer(evened(half[0], cell), evened(half[1], cell)),
          report.unexplained_fraction,
          report.is_grown_at_tips,
          report.yaw};
}

} // namespace orl_test

#endif // PCS_TEST_SUPPORT_GROWTH_SERIES_H
