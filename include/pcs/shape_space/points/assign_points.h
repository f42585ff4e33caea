// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Assignment of scan points to the edges of a tree by distance and normals.

#ifndef PCS_SHAPE_SPACE_POINTS_ASSIGN_POINTS_H
#define PCS_SHAPE_SPACE_POINTS_ASSIGN_POINTS_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/shape_space/model/Rooted_tree.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// A piece of a branch: a cone around an axis.
struct Tube
{
  Vec3 from, to;                 ///< [L]
  double from_radius, to_radius; ///< [L]
  std::size_t branch;
};

/// A tree of boxes around tubes. Finds the tubes to which a point may belong.
class Tube_tree
{
public:
  Tube_tree(const std::vector<Tube>& tubes, double noise, double absolute_noise)
    : m_tubes(tubes), m_noise(noise), m_absolute(absolute_noise)
  {
    m_order.resize(tubes.size());
    for (std::size_t i = 0; i < tubes.size(); ++i)
      m_order[i] = i;
    if (!tubes.empty())
      build(0, tubes.size());
  }

  /// Returns the distance from the surface of a tube in units of the noise [-], which is negative
  /// inside, and the direction from its axis.
  double offset(std::size_t tube, const Vec3& p, Vec3* radial = nullptr) const
  {
    const Tube& t = m_tubes[tube];
    const Vec3 axis = t.to - t.from;
    const double s = std::min(1.0, std::max(0.0, (p - t.from).dot(axis) / axis.squaredNorm()));
    const Vec3 off = p - t.from - s * axis;
    const double d = off.norm(), r = (1 - s) * t.from_radius + s * t.to_radius;
    if (radial)
      *radial = d > 0 ? Vec3(off / d) : Vec3(Vec3::Zero());
    return (d - r) / (m_noise * r + m_absolute);
  }
  /// Returns the square of `offset()`.
  double misfit(std::size_t tube, const Vec3& p, Vec3* radial = nullptr) const
  {
    const double x = offset(tube, p, radial);
    return x * x;
  }

  /// Calls `visit(tube, misfit)` for all tubes whose misfit can be below the bound that `visit`
  /// returns.
  template <class Visit>
  void search(const Vec3& p, const Visit& visit) const
  {
    if (m_cells.empty())
      return;
    double bound = std::numeric_limits<double>::infinity();
    std::array<std::pair<double, std::size_t>, 128> stack;
    std::size_t size = 0;
    stack[size++] = {least_misfit(m_cells[0], p), 0};
    while (size > 0) {
      const auto [least, c] = stack[--size];
      if (least > bound)
        continue;
      const Cell& cell = m_cells[c];
      if (cell.left == none) {
        for (std::size_t i = cell.begin; i < cell.end; ++i)
          bound = visit(m_order[i], misfit(m_order[i], p));
        continue;
      }
      const double a = least_misfit(m_cells[cell.left], p);
      const double b = least_misfit(m_cells[cell.right], p);
      // the nearer child last, so that it is visited first; the tree is balanced
      stack[size++] = a < b ? std::make_pair(b, cell.right) : std::make_pair(a, cell.left);
      stack[size++] = a < b ? std::make_pair(a, cell.left) : std::make_pair(b, cell.right);
    }
  }

private:
  struct Cell
  {
    Vec3 low, high;
    double radius;
    std::size_t left = none, right = none, begin, end;
  };

  double least_misfit(const Cell& cell, const Vec3& p) const
  {
    const Vec3 off = (cell.low - p).cwiseMax(p - cell.high).cwiseMax(0.0);
    const double outside = std::max(0.0, off.norm() - cell.radius);
    const double x = outside / (m_noise * cell.radius + m_absolute);
    return x * x;
  }

  std::size_t build(std::size_t begin, std::size_t end)
  {
    Cell cell;
    cell.begin = begin;
    cell.end = end;
    cell.low = cell.high = m_tubes[m_order[begin]].from;
    cell.radius = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Tube& t = m_tubes[m_order[i]];
      cell.low = cell.low.cwiseMin(t.from).cwiseMin(t.to);
      cell.high = cell.high.cwiseMax(t.from).cwiseMax(t.to);
      cell.radius = std::max({cell.radius, t.from_radius, t.to_radius});
    }
    const std::size_t index = m_cells.size();
    m_cells.push_back(cell);
    if (end - begin > 4) {
      Eigen::Index axis = 0;
      (cell.high - cell.low).maxCoeff(&axis);
      const std::size_t middle = begin + (end - begin) / 2;
      const auto at = [&](std::size_t i) { return m_tubes[i].from[axis] + m_tubes[i].to[axis]; };
      std::nth_element(
          m_order.begin() + static_cast<std::ptrdiff_t>(begin),
          m_order.begin() + static_cast<std::ptrdiff_t>(middle),
          m_order.begin() + static_cast<std::ptrdiff_t>(end),
          [&](std::size_t a, std::size_t b) { return at(a) != at(b) ? at(a) < at(b) : a < b; });
      const std::size_t left = build(begin, middle), right = build(middle, end);
      m_cells[index].left = left;
      m_cells[index].right = right;
    }
    return index;
  }

  const std::vector<Tube>& m_tubes;
  double m_noise, m_absolute;
  std::vector<std::size_t> m_order;
  std::vector<Cell> m_cells;
};

namespace internal {

/// Returns the direction of least variance of the nearest points; its sign has no meaning.
inline Vec3 estimate_normal(const std::vector<Vec3>& points,
                            const neighborhood::Nearest_neighbors& search,
                            std::size_t i,
                            std::size_t k)
{
  thread_local std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
  search(points[i], k + 1, found);
  Vec3 mean = Vec3::Zero();
  for (const auto& f : found)
    mean += points[f.index];
  mean /= static_cast<double>(found.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& f : found)
    covariance += (points[f.index] - mean) * (points[f.index] - mean).transpose();
  const auto eigen = linear_algebra::symmetric_eigen<3>(covariance);
  return eigen.vectors.col(0);
}

} // namespace internal

/// Chooses between two successive tubes on the outer side of a bend, where both are equally near,
/// by the plane that halves the angle between them. `tube` is one of the two.
inline std::size_t side_of_bend(const std::vector<Tube>& tubes, std::size_t tube, const Vec3& p)
{
  const auto is_next = [&](std::size_t k) {
    return k + 1 < tubes.size() && tubes[k].branch == tubes[k + 1].branch &&
           tubes[k].to == tubes[k + 1].from;
  };
  for (const std::size_t k : {tube, tube - 1})
    if (k < tubes.size() && is_next(k)) {
      const Vec3 one = tubes[k].to - tubes[k].from, two = tubes[k + 1].to - tubes[k + 1].from;
      const Vec3 off = p - tubes[k].to;
      if (off.dot(one) >= 0 && off.dot(two) <= 0)
        return off.dot(one.stableNormalized() + two.stableNormalized()) < 0 ? k : k + 1;
    }
  return tube;
}

namespace internal {

/// Returns the median distance of a sample of points from the nearest tube surface, but at least
/// 1e-6 of the extent of the tree. It is the noise that does not shrink with the radius. [L]
inline double
absolute_noise(const std::vector<Vec3>& points, const std::vector<Tube>& tubes, double extent)
{
  constexpr std::size_t sample_size = 2000;
  const Tube_tree tree(tubes, 0, 1);
  std::vector<double> distances;
  const std::size_t step = std::max<std::size_t>(1, points.size() / sample_size);
  for (std::size_t i = 0; i < points.size(); i += step) {
    double least = std::numeric_limits<double>::infinity();
    tree.search(points[i],
                [&](std::size_t, double misfit) { return least = std::min(least, misfit); });
    distances.push_back(std::sqrt(least));
  }
  return std::max(1e-6 * extent, pcs::internal::upper_median(distances));
}

/// A tube that a point may lie on.
struct Tube_candidate
{
  std::size_t tube;
  double misfit; ///< squared distance in units of the noise [-]
};

/// Keeps the first of successive candidates of each branch.
inline void keep_one_per_branch(const std::vector<Tube>& tubes, std::vector<Tube_candidate>& found)
{
  std::size_t kept = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    bool is_new = true;
    for (std::size_t j = 0; j < kept && is_new; ++j)
      is_new = tubes[found[j].tube].branch != tubes[found[k].tube].branch;
    if (is_new)
      found[kept++] = found[k];
  }
  found.resize(kept);
}

/// Finds the best tube of each branch that is about as near to `p` as the best branch, best first.
inline void find_candidates(const std::vector<Tube>& tubes,
                            const Tube_tree& tree,
                            const Vec3& p,
                            std::vector<Tube_candidate>& found)
{
  // normals matter if misfits differ by less than this from the best: three times the noise
  constexpr double margin = 9;
  found.clear();
  double least = std::numeric_limits<double>::infinity();
  tree.search(p, [&](std::size_t tube, double misfit) {
    if (misfit <= least + margin) {
      found.push_back({tube, misfit});
      least = std::min(least, misfit);
    }
    return least + margin;
  });
  std::sort(found.begin(), found.end(), [](const Tube_candidate& a, const Tube_candidate& b) {
    return a.misfit != b.misfit ? a.misfit < b.misfit : a.tube < b.tube;
  });
  while (found.back().misfit > least + margin)
    found.pop_back();
  keep_one_per_branch(tubes, found);
}

/// Chooses the candidate with the least sum of its misfit and the squared angle between the normal
/// and the direction from its axis, in units of `normal_angle` [rad].
inline std::size_t choose_by_normal(const Tube_tree& tree,
                                    const std::vector<Tube_candidate>& candidates,
                                    const Vec3& p,
                                    const Vec3& normal,
                                    double normal_angle)
{
  std::size_t result = candidates.front().tube;
  double least = std::numeric_limits<double>::infinity();
  for (const Tube_candidate& c : candidates) {
    Vec3 radial;
    tree.misfit(c.tube, p, &radial);
    const double cosine = std::min(1.0, std::abs(radial.dot(normal)));
    const double angle = std::acos(cosine) / normal_angle;
    const double score = c.misfit + angle * angle;
    if (score < least) {
      least = score;
      result = c.tube;
    }
  }
  return result;
}

/// Finds the candidates of section 4.7 of \cite aiteanu2022: the nearest tube of each branch whose
/// axis is at most `1 + noise` radii away from `p`, or else the tube with the nearest surface.
/// Misfits are signed, in units of the radius. `tree`: with a noise of 1.
inline void find_published_candidates(const std::vector<Tube>& tubes,
                                      const Tube_tree& tree,
                                      double noise,
                                      const Vec3& p,
                                      std::vector<Tube_candidate>& found)
{
  found.clear();
  double most = std::numeric_limits<double>::infinity();
  tree.search(p, [&](std::size_t tube, double) {
    if (const double offset = tree.offset(tube, p); offset <= most) {
      found.push_back({tube, offset});
      most = std::min(most, std::max(noise, offset));
    }
    return most * most;
  });
  std::sort(found.begin(), found.end(), [](const Tube_candidate& a, const Tube_candidate& b) {
    return a.misfit != b.misfit ? a.misfit < b.misfit : a.tube < b.tube;
  });
  std::size_t number = 1;
  while (number < found.size() && found[number].misfit <= noise)
    ++number;
  found.resize(number);
  keep_one_per_branch(tubes, found);
}

/// Chooses the candidate whose normal has the least angle to `normal` after projection to the plane
/// of two branches [Aiteanu 2022, figure 4.4]. In this plane, the normal of a branch is
/// perpendicular to its axis, so the axis with the least component of `normal` is taken. The part
/// of `normal` across the plane has no component along either axis. More than two candidates are
/// compared one after the other, from the nearest, which remains if components are equal.
inline std::size_t choose_in_plane(const std::vector<Tube>& tubes,
                                   const std::vector<Tube_candidate>& candidates,
                                   const Vec3& normal)
{
  const auto along = [&](std::size_t tube) {
    return std::abs((tubes[tube].to - tubes[tube].from).stableNormalized().dot(normal));
  };
  constexpr double rounding = 1e-12;
  std::size_t result = candidates.front().tube;
  for (std::size_t k = 1; k < candidates.size(); ++k)
    if (along(candidates[k].tube) < along(result) - rounding)
      result = candidates[k].tube;
  return result;
}

} // namespace internal

/*!
  Assigns each point to a tube of the branch with the nearest surface, in units of the noise. At
  forks, where several branches are about as near, the angle between the normal of the point and the
  direction away from the axis also counts. `normals` may be empty: then they are estimated,
  at forks only. `Point_assignment::by_normal` is the published rule: normals alone decide at forks.
*/
template <class ConcurrencyTag>
std::vector<std::size_t> assign_points(const std::vector<Vec3>& points,
                                       const std::vector<Vec3>& normals,
                                       const std::vector<Tube>& tubes,
                                       double extent,
                                       const Point_assignment_options& options)
{
  std::vector<std::size_t> result(points.size(), none);
  if (points.empty() || tubes.empty())
    return result;
  const bool is_published = options.rule == Point_assignment::by_normal;
  constexpr double least_radius = 1e-9; // of the extent: radii may be 0
  const Tube_tree tree(tubes,
                       is_published ? 1 : options.noise,
                       is_published ? least_radius * extent
                                    : internal::absolute_noise(points, tubes, extent));
  const auto find = [&](const Vec3& p, std::vector<internal::Tube_candidate>& found) {
    if (is_published)
      internal::find_published_candidates(tubes, tree, options.noise, p, found);
    else
      internal::find_candidates(tubes, tree, p, found);
  };
  std::vector<char> is_ambiguous(points.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
    thread_local std::vector<internal::Tube_candidate> found;
    find(points[i], found);
    result[i] = found.front().tube;
    is_ambiguous[i] = found.size() > 1;
  });
  const neighborhood::Nearest_neighbors search(points);
  pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
    if (is_ambiguous[i]) {
      thread_local std::vector<internal::Tube_candidate> found;
      find(points[i], found);
      const Vec3 normal =
          normals.empty()
              ? internal::estimate_normal(points, search, i, options.number_of_neighbors)
              : normals[i];
      result[i] =
          is_published
              ? internal::choose_in_plane(tubes, found, normal)
              : internal::choose_by_normal(tree, found, points[i], normal, options.normal_angle);
    }
    result[i] = side_of_bend(tubes, result[i], points[i]);
  });
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_ASSIGN_POINTS_H
