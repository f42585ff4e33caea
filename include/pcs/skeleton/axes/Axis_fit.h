// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Robust least-squares fit of a whole axis: positions and radii of all nodes to all points.
//
// The fit minimises the negative log-posterior over the centers c_k [L] and radii r_k [L] of the
// nodes 0 <= k < n of an axis,
//
//   E(c, r) = 1/2 sum_i w_i e_i^2                                                            [-]
//           + 1/2 sum_{0 < k < n-1} h_k / l (|c''_k|^2 / a_k^2 + r''_k^2 / b_k^2)
//           + 1/2 sum_k (r_k - q_k)^2 / d_k^2
//           + 1/2 sum_k |m_k - c_k - r_k f_k|^2 / g_k^2,
//
// by Gauss-Newton steps, before each of which the weights w_i are updated.
//
// - e_i = |p_i - c(i)| - r(i) [L]: residual of the point p_i, with center and radius at its
//   projection; both are linear between adjacent nodes. Points before the base or beyond the tip
//   are left out.
// - w_i = s (1 - (e_i / (4.7 v t_i))^2)^2 / t_i^2 [1/L^2]: biweight (A. E. Beaton, J. W. Tukey,
//   Technometrics 16, 1974), zero beyond 4.7 v t_i, with the deviation t_i = max(noise, bark r(i))
//   [L], the widening v [-], and the stride s of the points in use [count].
// - c''_k, r''_k [1/L]: divided differences over the three adjacent nodes, of mean distance h_k
//   [L], with the length l = correlation [L] and the standard deviations
//   a_k = min(axis_bend, thick_bend / r_k), b_k = (taper_offset + r_k) / taper_scale^2 [1/L].
// - q_k, d_k [L]: radius and deviation of the Radius_prior.
// - m_k [L], f_k [-], g_k [L]: middle, facing and deviation of the Center_prior.
//
// Other names are members of Fit_model.

#ifndef PCS_SKELETON_AXES_AXIS_FIT_H
#define PCS_SKELETON_AXES_AXIS_FIT_H

#include <pcs/linear_algebra/Banded_cholesky.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Statistical assumptions of the fit. Lengths are in the unit of the scan.
struct Fit_model
{
  double noise = 0;         ///< standard deviation of a point from the surface [L]
  double bark = 0.04;       ///< least such deviation, relative to the radius [-]
  double axis_bend = 0;     ///< standard deviation of the curvature of an axis [1/L]
  double thick_bend = 0.05; ///< bound on curvature times radius: thick branches are stiff [-]
  double taper_offset = 0, taper_scale = 1; ///< r'' ~ (taper_offset + r) / taper_scale^2 [L]
  double correlation = 1;                   ///< correlation length of bends [L]
  double lowest_radius = 0;                 ///< lower bound on radii [L]

  /// Returns defaults for a scan of spacing `u` [L] and standard deviation `noise` [L].
  static Fit_model of(double u, double noise)
  {
    Fit_model model;
    model.noise = noise;
    model.axis_bend = 0.007 / u;
    model.taper_offset = 7 * u;
    model.taper_scale = 143 * u;
    model.correlation = 14 * u;
    model.lowest_radius = 0.05 * u;
    return model;
  }

  double deviation(double radius) const { return std::max(noise, bark * radius); }
};

/// Prior of a radius, independent of the distances of the points from the axis.
struct Radius_prior
{
  double radius = 0;
  double deviation = 0; ///< [L]; 0: no prior
  double measured = 0;  ///< portion of 1 / deviation^2 that is measured from the points [1/L^2]
};

/// Combines two independent priors, weighted by their precisions. The second must have a positive
/// deviation.
inline Radius_prior joined(const Radius_prior& a, const Radius_prior& b)
{
  if (!(a.deviation > 0))
    return b;
  const double u = 1 / (a.deviation * a.deviation), v = 1 / (b.deviation * b.deviation);
  return {(u * a.radius + v * b.radius) / (u + v), 1 / std::sqrt(u + v), a.measured + b.measured};
}

/// Prior of the center of a section: the mean of its points is expected at `radius * facing` from
/// the center.
struct Center_prior
{
  Vec3 middle = Vec3::Zero(); ///< mean of the points, projected onto the plane of the center
  Vec3 facing = Vec3::Zero();
  double deviation = 0; ///< [L]; 0: no prior
};

/// Tukey's constant in standard deviations, and the factor by which the first iterations widen
/// it [-].
constexpr double tukey_constant = 4.7, first_widening = 2.5;

/*!
  Fits the centers and radii of all nodes of an axis to points, as stated at the head of this file.

  For points outside, the matrix includes the curvature of `|p_i - c|`. Steps are damped by
  100 / noise^2 along the axis and 0.005 / noise^2 in all directions, and are at most
  `r_k / 2 + noise`. Radii are at least `lowest_radius`; the end segments keep their lengths. An
  iteration costs O(points + nodes), by Cholesky factorization of a band of 8 subdiagonals.
*/
class Axis_fit
{
public:
  Axis_fit(Axis axis, const Fit_model& model) : m_axis(std::move(axis)), m_model(model) {}

  const Axis& axis() const { return m_axis; }
  Axis& axis() { return m_axis; }

  /// Sets the points and an initial segment for each.
  void set_points(std::vector<Vec3> points, std::vector<Index> segments)
  {
    m_points = std::move(points);
    m_segments = std::move(segments);
    m_places.resize(m_points.size());
    m_stride = 1;
  }
  /// Restricts the next iterations to every `stride`-th point, weighted by `stride`. Projects the
  /// points that the previous iterations left out.
  void use_every(std::size_t stride)
  {
    const bool are_known = m_stride == 1 || stride == m_stride;
    m_stride = stride;
    if (!are_known)
      project();
  }
  std::size_t stride() const { return m_stride; }
  void set_priors(std::vector<Radius_prior> priors) { m_priors = std::move(priors); }
  void set_priors(std::vector<Center_prior> priors) { m_center_priors = std::move(priors); }

  const std::vector<Vec3>& points() const { return m_points; }
  const std::vector<Axis_place>& places() const { return m_places; }

  /// Projects the points in use onto the current axis.
  void project()
  {
    const std::vector<Axis_segment> lines = segments_of(m_axis);
    for (std::size_t i = 0; i < m_points.size(); i += m_stride) {
      m_places[i] = nearest_place(lines, m_segments[i], m_points[i]);
      m_segments[i] = m_places[i].segment;
    }
  }

  /// Performs one iteration from the current axis; `widening` scales the width of the weights.
  /// Updates the projections. Returns `false` if the system cannot be solved.
  bool iterate(double widening)
  {
    assemble(widening);
    if (!m_matrix.factorize())
      return false;
    m_step = m_gradient;
    m_matrix.solve(m_step);
    apply_step();
    project();
    return true;
  }

  /// Returns the largest displacement or change of radius of a node in the last iteration [L].
  double largest_change() const { return m_largest_change; }

  /// Estimates standard errors of the radii from the diagonal of the inverse of the last system.
  void estimate_errors();

private:
  //! Second differences couple an unknown (of 4 per node) to the same one two nodes away; points
  //! couple all unknowns of adjacent nodes.
  static constexpr std::size_t bandwidth = 8;
  using Matrix = linear_algebra::Banded_cholesky<bandwidth>;

  /// Contribution of the points of a segment to the system of its two nodes.
  struct Segment_sums
  {
    //! lower triangles, by rows, of three blocks: first node, second with first node, second node
    std::array<std::array<double, 10>, 3> products;
    std::array<std::array<double, 4>, 2> slope;
    std::array<double, 2> weight;
  };

  void assemble(double widening);
  void hold_along_axis();
  void add_points(double widening);
  void add_segment_sums();
  void add_smoothness();
  void add_priors();
  void add_center_priors();
  void apply_step();
  static void keep_length(const Vec3& inner, double length, Vec3& end);

  Axis m_axis;
  Fit_model m_model;
  std::vector<Vec3> m_points;
  std::vector<Index> m_segments;
  std::vector<Axis_place> m_places;
  std::vector<Radius_prior> m_priors;
  std::vector<Center_prior> m_center_priors;
  std::size_t m_stride = 1;
  double m_largest_change = 0;
  Matrix m_matrix; // contains its Cholesky factor after an iteration
  std::vector<double> m_gradient, m_step;
  std::vector<Segment_sums> m_sums;
  std::vector<double> m_information; // weights of the points at each radius
};

inline void Axis_fit::assemble(double widening)
{
  m_matrix.reset(4 * m_axis.size());
  m_gradient.assign(4 * m_axis.size(), 0);
  m_information.assign(m_axis.size(), 0);
  add_points(widening);
  add_smoothness();
  add_priors();
  add_center_priors();
  hold_along_axis();
}

/// Damps displacements along the axis, which the points do not determine. The damping affects the
/// steps but not the result.
inline void Axis_fit::hold_along_axis()
{
  constexpr double everywhere = 0.005, along_axis = 100; // in units of 1 / noise^2
  const double across = everywhere / (m_model.noise * m_model.noise);
  const double along = along_axis / (m_model.noise * m_model.noise);
  const std::size_t n = m_axis.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 chord = m_axis[std::min(n - 1, k + 1)].point - m_axis[k > 0 ? k - 1 : 0].point;
    const double length = chord.norm();
    const Vec3 t = length > 0 ? Vec3(chord / length) : Vec3(Vec3::Zero());
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index j = 0; j <= i; ++j)
        m_matrix(4 * k + static_cast<std::size_t>(i), 4 * k + static_cast<std::size_t>(j)) +=
            along * t[i] * t[j] + (i == j ? across : 0);
    m_matrix(4 * k + 3, 4 * k + 3) += across;
  }
}

inline void Axis_fit::add_points(double widening)
{
  m_sums.assign(m_axis.size(), Segment_sums{});
  const double narrowing = 1 / (tukey_constant * widening);
  for (std::size_t i = 0; i < m_points.size(); i += m_stride) {
    const Axis_place& place = m_places[i];
    if (place.share < 0 || place.share > 1)
      continue; // before the base or beyond the tip
    const double t = place.share;
    const double radius = radius_at(m_axis, place);
    const double precision = 1 / m_model.deviation(radius);
    const double e = place.distance - radius, x = narrowing * e * precision;
    if (x * x >= 1 || !(place.distance > 0))
      continue;
    const double weight = (1 - x * x) * precision, w = double(m_stride) * weight * weight;
    const double inverse = 1 / place.distance;
    const Vec3 n = inverse * (m_points[i] - point_at(m_axis, place));
    // Second-order term: the surface is curved, so that a point outside also constrains the axis
    // perpendicular to n. Without this term, thin axes oscillate between two sides of their points.
    const double hold = std::max(0.0, e * inverse), pull = 1 - hold;
    // The derivatives of e(c, r) = |p - c| - r by the two nodes are -(1 - t) d and -t d with
    // d = (n, 1), since c and r are linear between the nodes.
    const double products[10] = {pull * n.x() * n.x() + hold,
                                 pull * n.y() * n.x(),
                                 pull * n.y() * n.y() + hold,
                                 pull * n.z() * n.x(),
                                 pull * n.z() * n.y(),
                                 pull * n.z() * n.z() + hold,
                                 n.x(),
                                 n.y(),
                                 n.z(),
                                 1};
    const double slope[4] = {n.x() * e, n.y() * e, n.z() * e, e};
    const double w0 = w * (1 - t), w1 = w * t;
    const double w00 = w0 * (1 - t), w10 = w0 * t, w11 = w1 * t;
    Segment_sums& sums = m_sums[place.segment];
    for (std::size_t k = 0; k < 10; ++k) {
      sums.products[0][k] += w00 * products[k];
      sums.products[1][k] += w10 * products[k];
      sums.products[2][k] += w11 * products[k];
    }
    for (std::size_t k = 0; k < 4; ++k) {
      sums.slope[0][k] += w0 * slope[k];
      sums.slope[1][k] += w1 * slope[k];
    }
    sums.weight[0] += w0;
    sums.weight[1] += w1;
  }
  add_segment_sums();
}

inline void Axis_fit::add_segment_sums()
{
  for (std::size_t s = 0; s + 1 < m_axis.size(); ++s) {
    const Segment_sums& sums = m_sums[s];
    const std::size_t first = 4 * s, second = first + 4;
    for (std::size_t a = 0, k = 0; a < 4; ++a) {
      for (std::size_t b = 0; b <= a; ++b, ++k) {
        m_matrix(first + a, first + b) += sums.products[0][k];
        m_matrix(second + a, second + b) += sums.products[2][k];
        m_matrix(second + a, first + b) += sums.products[1][k];
        if (b < a)
          m_matrix(second + b, first + a) += sums.products[1][k];
      }
      m_gradient[first + a] += sums.slope[0][a];
      m_gradient[second + a] += sums.slope[1][a];
    }
    m_information[s] += sums.weight[0];
    m_information[s + 1] += sums.weight[1];
  }
}

inline void Axis_fit::add_smoothness()
{
  for (std::size_t k = 1; k + 1 < m_axis.size(); ++k) {
    const double h0 = (m_axis[k].point - m_axis[k - 1].point).norm();
    const double h1 = (m_axis[k + 1].point - m_axis[k].point).norm();
    const double floor = 1e-3 * m_model.correlation;
    const double a = std::max(h0, floor), b = std::max(h1, floor), h = 0.5 * (a + b);
    // second derivative on a grid of unequal steps
    const double c0 = 1 / (a * h), c2 = 1 / (b * h), c1 = -(c0 + c2);
    const double coefficients[3] = {c0, c1, c2};
    const double share = h / m_model.correlation;
    const double radius_bend =
        (m_model.taper_offset + m_axis[k].radius) / (m_model.taper_scale * m_model.taper_scale);
    const double axis_bend = std::min(m_model.axis_bend, m_model.thick_bend / m_axis[k].radius);
    for (std::size_t d = 0; d < 4; ++d) {
      const double deviation = d < 3 ? axis_bend : radius_bend;
      const double w = share / (deviation * deviation);
      double bend = 0;
      for (std::size_t m = 0; m < 3; ++m) {
        const Axis_node& node = m_axis[k - 1 + m];
        bend += coefficients[m] * (d < 3 ? node.point[static_cast<Eigen::Index>(d)] : node.radius);
      }
      for (std::size_t m = 0; m < 3; ++m) {
        const std::size_t row = 4 * (k - 1 + m) + d;
        m_gradient[row] -= w * coefficients[m] * bend;
        for (std::size_t l = 0; l <= m; ++l)
          m_matrix(row, 4 * (k - 1 + l) + d) += w * coefficients[m] * coefficients[l];
      }
    }
  }
}

inline void Axis_fit::add_priors()
{
  for (std::size_t k = 0; k < m_axis.size() && k < m_priors.size(); ++k) {
    const Radius_prior& prior = m_priors[k];
    if (!(prior.deviation > 0))
      continue;
    const double w = 1 / (prior.deviation * prior.deviation);
    m_matrix(4 * k + 3, 4 * k + 3) += w;
    m_gradient[4 * k + 3] -= w * (m_axis[k].radius - prior.radius);
  }
}

inline void Axis_fit::add_center_priors()
{
  for (std::size_t k = 0; k < m_axis.size() && k < m_center_priors.size(); ++k) {
    const Center_prior& prior = m_center_priors[k];
    if (!(prior.deviation > 0))
      continue;
    const double w = 1 / (prior.deviation * prior.deviation);
    const Vec3 e = prior.middle - m_axis[k].point - m_axis[k].radius * prior.facing;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const std::size_t row = 4 * k + static_cast<std::size_t>(i);
      const double f = prior.facing[i];
      m_matrix(row, row) += w;
      m_matrix(4 * k + 3, row) += w * f;
      m_matrix(4 * k + 3, 4 * k + 3) += w * f * f;
      m_gradient[row] += w * e[i];
      m_gradient[4 * k + 3] += w * f * e[i];
    }
  }
}

/// Applies the step and keeps the lengths of the end segments. Steps overshoot at short segments of
/// thick axes, so that each oscillation would move the end farther outwards.
inline void Axis_fit::apply_step()
{
  m_largest_change = 0;
  const std::size_t n = m_axis.size();
  const double first = n > 1 ? (m_axis[0].point - m_axis[1].point).norm() : 0;
  const double last = n > 1 ? (m_axis[n - 1].point - m_axis[n - 2].point).norm() : 0;
  for (std::size_t k = 0; k < n; ++k) {
    Axis_node& node = m_axis[k];
    Vec3 move(m_step[4 * k], m_step[4 * k + 1], m_step[4 * k + 2]);
    // far from the solution the linear model overshoots
    const double longest = 0.5 * node.radius + m_model.noise, length = move.norm();
    if (length > longest)
      move *= longest / length;
    node.point += move;
    const double change = std::min(longest, std::max(-longest, m_step[4 * k + 3]));
    const double radius = std::max(m_model.lowest_radius, node.radius + change);
    m_largest_change =
        std::max({m_largest_change, std::min(length, longest), std::abs(radius - node.radius)});
    node.radius = radius;
  }
  if (n > 2) {
    keep_length(m_axis[1].point, first, m_axis[0].point);
    keep_length(m_axis[n - 2].point, last, m_axis[n - 1].point);
  }
}

inline void Axis_fit::keep_length(const Vec3& inner, double length, Vec3& end)
{
  const Vec3 d = end - inner;
  const double norm = d.norm();
  if (norm > 0)
    end = inner + length / norm * d;
}

inline void Axis_fit::estimate_errors()
{
  if (m_matrix.size() != 4 * m_axis.size())
    return;
  const std::vector<double> variance = m_matrix.inverse_diagonal();
  for (std::size_t k = 0; k < m_axis.size(); ++k) {
    m_axis[k].radius_error = std::sqrt(std::max(0.0, variance[4 * k + 3]));
    const bool has_prior = k < m_priors.size() && m_priors[k].deviation > 0;
    const double prior = has_prior ? 1 / (m_priors[k].deviation * m_priors[k].deviation) : 0;
    const double measured = has_prior ? m_priors[k].measured : 0;
    m_axis[k].is_measured = m_information[k] + measured > prior - measured && m_information[k] > 0;
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_AXIS_FIT_H
