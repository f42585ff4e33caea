// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tropism, sag and bends, by regression of the changes of direction along the axes.

#ifndef PCS_GENERATORS_HABIT_FIT_BENDS_H
#define PCS_GENERATORS_HABIT_FIT_BENDS_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/fit_profiles.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

/*
  Per `bend_length`, a direction d changes by the part of b + (T - s x) z that is perpendicular to
  d: b is a random bend, T the tropism, s the sag and x the fraction of the length. T and s follow
  from linear regression on the perpendicular part of z. The residuals are the bends; steps apart
  by k have the covariance b^2 (1 - p)^k, p being the probability of a new bend. Errors of
  positions affect the covariances up to k = 2 only, so those are left out. The size b of the bends
  follows from the wandering of the whole axis, which errors of positions change little.
*/
class Bend_fit
{
public:
  Bend_fit(const Samples& trees, const Tree_habit& habit) : m_bend_length(habit.bend_length)
  {
    for (const Tree_sample* tree : trees)
      for (std::size_t i = 0; i < tree->axes.size(); ++i)
        if (tree->axes[i].kind != Axis_kind::stub && tree->axes[i].points.size() >= 3)
          add(*tree, i);
  }

  /// Sets tropism, sag, bends and their renewal. Returns the numbers of changes by row.
  std::array<std::size_t, 3> fit(Tree_habit& habit) const
  {
    fit_tropism(habit);
    std::array<std::array<double, number_of_lags>, 3> sum{}, count{};
    std::array<std::size_t, 3> number{};
    for (const Series& s : m_series) {
      std::vector<Vector3> rest;
      for (const Change& c : s.changes)
        rest.push_back(c.bend - (habit.tropism[s.row] - s.sag(habit.sag, c.x)) * c.upwards);
      for (std::size_t k = 0; k < number_of_lags; ++k)
        for (std::size_t i = 0; i + first_lag + k < rest.size(); ++i) {
          sum[s.row][k] += rest[i].dot(rest[i + first_lag + k]) / 2;
          count[s.row][k] += 1;
        }
      number[s.row] += rest.size();
    }
    fit_renewal(sum, count, habit);
    fit_bends(habit);
    return number;
  }

  /// The standard errors of the tropism of each row. The sum of u_i u_j q^|i - j| over all pairs of
  /// steps of an axis is found recursively.
  std::array<double, 3> tropism_errors(const Tree_habit& habit) const
  {
    std::array<double, 3> sum{}, squares{}, errors{};
    for (const Series& s : m_series) {
      Vector3 past = Vector3::Zero();
      for (const Change& c : s.changes) {
        const Vector3 now = c.step * c.upwards;
        past = now + (1 - habit.bend_renewal) * past;
        sum[s.row] += 2 * now.dot(past) - now.squaredNorm();
        squares[s.row] += c.step * c.upwards.squaredNorm();
      }
    }
    for (std::size_t row = 0; row < 3; ++row)
      errors[row] = squares[row] > 0 ? habit.bend[row] * std::sqrt(sum[row]) / squares[row] : 0;
    return errors;
  }

private:
  static constexpr std::size_t first_lag = 3, number_of_lags = 12;

  struct Change
  {
    Vector3 bend, upwards; // per bend length; the part of z across the axis
    double x, step;
  };
  struct Series
  {
    std::size_t row = 0;
    bool is_stem = false;
    std::vector<Change> changes;
    std::vector<Vector3> chords; // directions
    double length = 0;
    std::size_t number_of_edges = 0;

    double sag(double of_habit, double x) const { return is_stem ? 0 : of_habit * x; }

    /// The variance of the directions in one dimension.
    double wandering() const
    {
      Vector3 mean = Vector3::Zero();
      for (const Vector3& c : chords)
        mean += c / static_cast<double>(chords.size());
      const Vector3 side = Vector3::UnitZ().cross(mean).normalized();
      std::vector<double> squares;
      for (const Vector3& c : chords)
        squares.push_back(is_stem ? (c - mean).head<2>().squaredNorm() / 2
                                  : std::pow((c - mean).dot(side), 2));
      if (is_stem)
        return quantile(squares, 0.5);
      double sum = 0;
      for (const double q : squares)
        sum += q / static_cast<double>(squares.size());
      return sum;
    }
  };

  void add(const Tree_sample& tree, std::size_t number)
  {
    const Axis& axis = tree.axes[number];
    Series series;
    series.row = axis.row();
    series.is_stem = axis.kind == Axis_kind::stem;
    series.length = axis.length();
    series.number_of_edges = axis.points.size() - 1;
    add_chords(axis, std::max(axis.first_outside(), first_after_fork(tree, number)), series);
    Vector3 before = (axis.points[1] - axis.points[0]).normalized();
    for (std::size_t i = 1; i + 1 < axis.points.size(); ++i) {
      const bool is_inside = axis.at[i - 1] < axis.place_radius; // drawn, not measured
      const Vector3 edge = axis.points[i + 1] - axis.points[i];
      const double step = edge.norm();
      const Vector3 direction = edge / step, middle = (before + direction).normalized();
      const Vector3 up = Vector3::UnitZ() - middle.z() * middle;
      const bool is_fork = axis.order == 0 && forks_at(tree, i);
      if (!is_fork && !is_inside && middle.allFinite())
        series.changes.push_back(
            {m_bend_length / step * (direction - before), up, axis.at[i] / axis.length(), step});
      before = direction;
    }
    m_series.push_back(std::move(series));
  }

  /// The first point of an axis above its fork, or 0.
  static std::size_t first_after_fork(const Tree_sample& tree, std::size_t number)
  {
    std::size_t first = 0;
    if (number == 0)
      for (const Axis& a : tree.axes)
        if (a.kind == Axis_kind::stem && a.parent == 0)
          first = std::max(first, a.place + 2);
    return first;
  }

  /// Adds the directions of up to eight chords of at least three edges.
  static void add_chords(const Axis& axis, std::size_t first, Series& series)
  {
    if (first + 7 > axis.points.size())
      return;
    const std::size_t edges = axis.points.size() - 1 - first;
    const std::size_t n = std::min<std::size_t>(8, edges / 3);
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t from = first + k * edges / n, to = first + (k + 1) * edges / n;
      series.chords.push_back((axis.points[to] - axis.points[from]).normalized());
    }
    series.length = axis.at.back() - axis.at[first];
    series.number_of_edges = edges;
  }

  /// Whether a leader begins near a point of the trunk, where its direction changes suddenly.
  static bool forks_at(const Tree_sample& tree, std::size_t point)
  {
    return std::any_of(tree.axes.begin(), tree.axes.end(), [&](const Axis& a) {
      return a.kind == Axis_kind::stem && a.parent == 0 && a.place + 1 >= point &&
             a.place <= point + 1;
    });
  }

  void fit_tropism(Tree_habit& habit) const
  {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const Series& s : m_series)
      for (const Change& c : s.changes) {
        const auto row = static_cast<Eigen::Index>(s.row);
        const double x = -s.sag(1, c.x), square = c.step * c.upwards.squaredNorm();
        const double turn = c.step * c.bend.dot(c.upwards);
        normal(row, row) += square;
        normal(row, 3) += x * square;
        normal(3, row) += x * square;
        normal(3, 3) += x * x * square;
        right[row] += turn;
        right[3] += x * turn;
      }
    for (Eigen::Index i = 0; i < 4; ++i) // rows without branches
      normal(i, i) += 1e-9;
    const Eigen::Vector4d solution = normal.ldlt().solve(right);
    habit.tropism = {solution[0], solution[1], solution[2]};
    habit.sag = solution[3];
  }

  /// Fits b^2 q^k to the covariances of each row, with one q for all of them.
  template <class Table>
  static void fit_renewal(const Table& sum, const Table& count, Tree_habit& habit)
  {
    double best = -1;
    for (double log_p = std::log(0.003); log_p < std::log(0.4); log_p += 0.02) {
      const double q = 1 - std::exp(log_p);
      double gain = 0; // of the sum of squares, relative to no covariance
      for (std::size_t row = 0; row < 3; ++row) {
        double a = 0, b = 0, scale = 0;
        for (std::size_t k = 0; k < number_of_lags; ++k) {
          const double model = std::pow(q, static_cast<double>(first_lag + k));
          a += sum[row][k] * model;
          b += count[row][k] * model * model;
          scale += sum[row][k] * sum[row][k] / std::max(1.0, count[row][k]);
        }
        if (a > 0 && scale > 0)
          gain += a * a / b / scale * count[row][0];
      }
      if (gain > best) {
        best = gain;
        habit.bend_renewal = 1 - q;
      }
    }
  }

  /// The direction of an axis is the sum of its bends. Its variance about the mean direction, by
  /// chords of a few edges, is about b^2 c L / (6 l^2), with the correlation length c and the bend
  /// length l. Of branches, only the horizontal part counts, which tropism does not change. Medians
  /// ignore single kinks and axes that lead astray.
  void fit_bends(Tree_habit& habit) const
  {
    std::array<std::vector<double>, 3> ratios;
    for (const Series& s : m_series) {
      if (s.chords.size() < 2)
        continue;
      const double step = s.length / static_cast<double>(s.number_of_edges);
      const double expected = 2 * step / habit.bend_renewal * s.length / 6;
      const double ratio = s.wandering() / expected;
      if (std::isfinite(ratio))
        ratios[s.row].push_back(ratio);
    }
    for (std::size_t row = 0; row < 3; ++row)
      if (!ratios[row].empty())
        habit.bend[row] = m_bend_length * std::sqrt(quantile(ratios[row], 0.5));
  }

  double m_bend_length;
  std::vector<Series> m_series;
};

/*
  Tropism of the trunks, from the tilt of their chords. The tilt q of a direction follows
  q' = -k q + w along the trunk, with k = T / l for tropism T and bend length l, and random bends w
  of the intensity D. The variance of the mean tilt of a trunk of length L, which begins with the
  lean q0, is q0^2 e^2 + D (L - 2 e L + (1 - exp(-2 k L)) / (2 k)) / (k L)^2, where e is
  (1 - exp(-k L)) / (k L).
*/
inline double
fit_trunk_tropism(const Samples& trees, const Tree_habit& habit, double variance_factor = 1)
{
  double observed = 0, length = 0, step = 0;
  const double n = static_cast<double>(trees.size());
  for (const Tree_sample* tree : trees) {
    const Axis& trunk = tree->axes.front();
    const Vector3 chord = trunk.points.back() - trunk.points.front();
    observed += chord.head<2>().squaredNorm() / chord.squaredNorm() / (2 * n);
    length += trunk.length() / n;
    step += trunk.length() / static_cast<double>(trunk.points.size() - 1) / n;
  }
  observed *= variance_factor; // of the measured trees, for bounds of the result
  const double bend = habit.bend[0] / habit.bend_length;
  const double intensity = 2 * bend * bend * step / habit.bend_renewal;
  const auto variance = [&](double k) {
    const double kl = std::max(1e-3, k * length), e = -std::expm1(-kl) / kl;
    const double walk = 1 - 2 * e - std::expm1(-2 * kl) / (2 * kl);
    return std::pow(habit.lean * e, 2) + intensity * length * walk / (kl * kl);
  };
  double least = 0, largest = 0.5 / habit.bend_length;
  if (variance(least) <= observed)
    return 0;
  for (int round = 0; round < 40; ++round) {
    const double middle = (least + largest) / 2;
    (variance(middle) > observed ? least : largest) = middle;
  }
  return least * habit.bend_length;
}

/// The standard deviation of the directions of the trunks at their bases, about the vertical.
inline double fit_lean(const Samples& trees)
{
  double sum = 0;
  for (const Tree_sample* tree : trees) {
    const Axis& trunk = tree->axes.front();
    // the bends change the direction, so that of two chords is extrapolated to the base
    const std::size_t n = std::min<std::size_t>(3, (trunk.points.size() - 1) / 2);
    Vector3 direction = trunk.points[1] - trunk.points[0];
    if (n > 0) {
      const Vector3 low = (trunk.points[n] - trunk.points[0]).normalized();
      const Vector3 high = (trunk.points[2 * n] - trunk.points[n]).normalized();
      direction = low - (high - low) * (static_cast<double>(n) + 1) / (2 * static_cast<double>(n));
    }
    const double height = std::max(1e-300, std::abs(direction.z()));
    sum += direction.head<2>().squaredNorm() / (2 * height * height);
  }
  return std::sqrt(sum / static_cast<double>(trees.size()));
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_FIT_BENDS_H
