// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Refinement of a scan grid: position and angular steps of a station.

#ifndef PCS_SKELETON_REGISTRATION_FIT_SCAN_GRID_H
#define PCS_SKELETON_REGISTRATION_FIT_SCAN_GRID_H

#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/registration/Point_pairs.h>
#include <pcs/skeleton/registration/Registration_options.h>
#include <pcs/skeleton/registration/Scan_grid.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Refines a scan grid by gradient ascent, so that more points lie at integer columns and rows.
template <class ConcurrencyTag>
class Scan_grid_fit
{
public:
  Scan_grid_fit(const std::vector<Vec3>& points,
                const Pair_source& source,
                const Scan_grid_options& rules,
                const Scan_grid& guess)
    : m_points(points),
      m_source(source),
      m_rules(rules),
      m_range(guess.position.norm()),
      m_grid(guess)
  {
  }

  /// Fits the grid to pairs of points at increasing distances, then to single points. Returns
  /// `false` if too few points lie on the grid. `step` is the distance between beams [L].
  bool run(double step)
  {
    Grid_place usual = Grid_place::Zero();
    for (double low = 5 * step; low < m_rules.far; low *= 1.7) {
      const std::vector<Point_pair> pairs =
          m_source.template draw<ConcurrencyTag>(low, 2 * low, m_rules.pairs);
      if (pairs.size() < m_rules.fewest_pairs)
        return false;
      constexpr int rounds = 4;
      constexpr double near = 0.003; // distance from the maximum [steps]
      Grid_place cosine = Grid_place::Zero();
      double change = 1;
      for (int round = 0; round < rounds && change > near; ++round)
        cosine = climb(pairs, usual, change);
      if (cosine.minCoeff() < m_rules.significance / std::sqrt(2.0 * double(pairs.size())))
        return false;
      usual = cosine;
    }
    find_phases();
    for (double reach = 0.25; reach > 0.1; reach *= 0.85)
      settle(reach);
    use_longest_steps();
    return find_tolerance() >= m_rules.least_share;
  }

  const Scan_grid& grid() const { return m_grid; }

private:
  static constexpr Eigen::Index size = 7; ///< position [ranges], tilt [rad], log rates
  using Step = Eigen::Matrix<double, size, 1>;
  using Matrix = Eigen::Matrix<double, size, size>;
  using Long_step = Eigen::Matrix<double, size + 2, 1>; ///< including the phases
  using Long_matrix = Eigen::Matrix<double, size + 2, size + 2>;

  /// Column and row of a point, and their derivatives with respect to the grid.
  struct Sighting
  {
    Grid_place at;
    Step column, row;

    Sighting(const Scan_grid& g, double range, const Vec3& p)
    {
      const Vec3 q = g.axes * (p - g.position);
      at = g.place_of_direction(q);
      const double level2 = q.head<2>().squaredNorm(), level = std::sqrt(level2);
      const Vec3 c = g.rate[0] / level2 * Vec3(-q.y(), q.x(), 0);
      const Vec3 r =
          g.rate[1] / q.squaredNorm() * Vec3(-q.z() * q.x() / level, -q.z() * q.y() / level, level);
      const Vec3 cq = q.cross(c), rq = q.cross(r);
      column << -range * c, cq.x(), cq.y(), at[0] - g.phase[0], 0;
      row << -range * r, rq.x(), rq.y(), 0, at[1] - g.phase[1];
    }
  };

  void move(const Step& x)
  {
    m_grid.position += m_range * (m_grid.axes.transpose() * x.head<3>());
    const Vec3 tilt(x[3], x[4], 0);
    if (tilt.norm() > 0)
      m_grid.axes =
          Eigen::AngleAxisd(tilt.norm(), tilt.normalized()).toRotationMatrix() * m_grid.axes;
    m_grid.rate[0] *= std::exp(x[5]);
    m_grid.rate[1] *= std::exp(x[6]);
  }

  /// Calls `add(k, sums)` for each `k` below `count` in fixed blocks, and sums the results.
  template <class Sums, class Add>
  static Sums sum_up(std::size_t count, const Add& add)
  {
    constexpr std::size_t block = 512;
    std::vector<Sums> partial((count + block - 1) / block);
    pcs::internal::for_each_block<ConcurrencyTag>(count,
                                                  block,
                                                  [&](std::size_t begin, std::size_t end) {
                                                    for (std::size_t k = begin; k < end; ++k)
                                                      add(k, partial[begin / block]);
                                                  });
    Sums all;
    for (const Sums& sums : partial)
      all += sums;
    return all;
  }

  struct Pair_sums
  {
    Matrix columns = Matrix::Zero(), rows = Matrix::Zero();
    Step column = Step::Zero(), row = Step::Zero();
    Grid_place cosine = Grid_place::Zero();

    void operator+=(const Pair_sums& other)
    {
      columns += other.columns;
      rows += other.rows;
      column += other.column;
      row += other.row;
      cosine += other.cosine;
    }
  };

  /// Performs one Newton step that maximizes the sum of the cosines of the column and row
  /// differences of pairs; only some pairs belong to the station. Returns the mean cosines before
  /// the step. `change` is the root mean square change of the pairs [steps].
  Grid_place climb(const std::vector<Point_pair>& pairs, const Grid_place& usual, double& change)
  {
    Pair_sums all = sum_up<Pair_sums>(pairs.size(), [&](std::size_t k, Pair_sums& sums) {
      const Sighting a(m_grid, m_range, pairs[k].first()), b(m_grid, m_range, pairs[k].second());
      const Step c = b.column - a.column, r = b.row - a.row;
      const Grid_place angle = two_pi * (b.at - a.at);
      sums.columns += c * c.transpose();
      sums.rows += r * r.transpose();
      sums.column += std::sin(angle[0]) / two_pi * c;
      sums.row += std::sin(angle[1]) / two_pi * r;
      sums.cosine += Grid_place(std::cos(angle[0]), std::cos(angle[1]));
    });
    all.cosine /= double(pairs.size());
    // the curvature at the maximum; on the slope it would be too small
    const Grid_place curvature = all.cosine.cwiseMax(0.7 * usual).cwiseMax(m_rules.least_contrast);
    Matrix m = curvature[0] * all.columns + curvature[1] * all.rows;
    const Step slope = all.column + all.row;
    // a prior stabilizes parameters that such pairs do not determine; a sine has the variance 1/2
    const double variance = 0.5 / (two_pi * two_pi * curvature.mean());
    const double place = m_rules.spacing * m_rules.spacing, tilt = m_rules.tilt * m_rules.tilt;
    for (Eigen::Index k = 0; k < size; ++k)
      m(k, k) += variance / (k == 3 || k == 4 ? tilt : place);
    Step x;
    linear_algebra::solve_symmetric(m, Step(-slope), x);
    change = std::sqrt(x.dot((all.columns + all.rows) * x) / double(pairs.size()));
    move(x);
    return all.cosine;
  }

  /// Returns the number of points in an even sample of the scan.
  std::size_t number_of_samples() const { return std::min(m_points.size(), m_rules.samples); }
  const Vec3& sample(std::size_t k) const
  {
    return m_points[k * m_points.size() / number_of_samples()];
  }

  /// Sums for the circular mean of angles.
  struct Phase_sums
  {
    Grid_place sine = Grid_place::Zero(), cosine = Grid_place::Zero();
    double count = 0;

    void add(const Grid_place& angle)
    {
      sine += Grid_place(std::sin(angle[0]), std::sin(angle[1]));
      cosine += Grid_place(std::cos(angle[0]), std::cos(angle[1]));
      count += 1;
    }
    void operator+=(const Phase_sums& other)
    {
      sine += other.sine;
      cosine += other.cosine;
      count += other.count;
    }
  };

  void find_phases()
  {
    m_grid.phase.setZero();
    const Phase_sums all =
        sum_up<Phase_sums>(number_of_samples(), [&](std::size_t k, Phase_sums& sums) {
          sums.add(two_pi * m_grid.place(sample(k)));
        });
    for (int e = 0; e < 2; ++e)
      m_grid.phase[e] = -std::atan2(all.sine[e], all.cosine[e]) / two_pi;
  }

  struct Point_sums
  {
    Long_matrix matrix = Long_matrix::Zero();
    Long_step slope = Long_step::Zero();

    void operator+=(const Point_sums& other)
    {
      matrix += other.matrix;
      slope += other.slope;
    }
  };

  /// Performs a least-squares step for the points within `reach` of integers.
  void settle(double reach)
  {
    Point_sums all = sum_up<Point_sums>(number_of_samples(), [&](std::size_t k, Point_sums& sums) {
      const Vec3& p = sample(k);
      if (m_grid.misfit(p, reach) > reach)
        return;
      const Sighting s(m_grid, m_range, p);
      Long_step column, row;
      column << s.column, 1, 0;
      row << s.row, 0, 1;
      sums.matrix += column * column.transpose() + row * row.transpose();
      sums.slope += beyond_whole(s.at[0]) * column + beyond_whole(s.at[1]) * row;
    });
    constexpr double ridge = 1e-9;
    all.matrix.diagonal() = (1 + ridge) * all.matrix.diagonal().array() + ridge;
    Long_step x;
    if (!linear_algebra::solve_symmetric(all.matrix, Long_step(-all.slope), x))
      return;
    move(x.head<size>());
    m_grid.phase += x.tail<2>();
  }

  /// Doubles or triples the step if all columns or rows are multiples of 2 or 3.
  void use_longest_steps()
  {
    constexpr double reach = 0.1, sure = 0.8;
    for (const int factor : {3, 2}) {
      const Phase_sums all =
          sum_up<Phase_sums>(number_of_samples(), [&](std::size_t k, Phase_sums& sums) {
            if (m_grid.misfit(sample(k), reach) <= reach)
              sums.add(two_pi / factor * m_grid.place(sample(k)));
          });
      for (int e = 0; e < 2; ++e) {
        // points within reach by chance have random angles
        if (std::hypot(all.sine[e], all.cosine[e]) < sure * all.count)
          continue;
        m_grid.rate[e] /= factor;
        m_grid.phase[e] =
            m_grid.phase[e] / factor - std::atan2(all.sine[e], all.cosine[e]) / two_pi;
      }
    }
  }

  /// Finds the tolerance with the most significant excess of points over chance. Returns this
  /// excess as a fraction of all points, or 0 if it is not significant.
  double find_tolerance()
  {
    std::vector<double> misfits(number_of_samples());
    pcs::internal::for_each_index<ConcurrencyTag>(misfits.size(), [&](std::size_t k) {
      misfits[k] = m_grid.misfit(sample(k));
    });
    const double count = double(misfits.size());
    double best = 0, share = 0;
    for (double width = 0.01; width < 0.25; width *= 1.25) {
      const double inside = double(
          std::count_if(misfits.begin(), misfits.end(), [&](double x) { return x <= width; }));
      const double chance = 4 * width * width * count, more = inside - chance;
      const double evidence = more / std::sqrt(inside + chance + 1);
      if (evidence > best) {
        best = evidence;
        m_grid.tolerance = width;
        share = more / count;
      }
    }
    return best >= m_rules.evidence ? share : 0;
  }

  const std::vector<Vec3>& m_points;
  const Pair_source& m_source;
  const Scan_grid_options& m_rules;
  double m_range;
  Scan_grid m_grid;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_FIT_SCAN_GRID_H
