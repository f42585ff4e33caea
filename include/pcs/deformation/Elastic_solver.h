// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rotations and positions of an elastic network under handles: constant factors, alternating solves.

#ifndef PCS_DEFORMATION_ELASTIC_SOLVER_H
#define PCS_DEFORMATION_ELASTIC_SOLVER_H

#include <pcs/core/Similarity.h>
#include <pcs/core/Status.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/Anderson_mixing.h>
#include <pcs/deformation/Elastic_network.h>
#include <pcs/deformation/Harmonic_system.h>
#include <pcs/deformation/rotation_field.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/linear_algebra/small_symmetric.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// Weight of the local fit against its neighbours' when rotations are smoothed, at stiffness 1, of a node that stands for
/// one part in `reference_size` of the surface. [-]
/// Chosen among 0.004 ... 2 on the bars, tubes and plates of benchmark/quality: smaller values hold back bending
/// that a dragged handle asks for, larger ones let surfaces buckle.
constexpr double default_fit_weight = 0.3;
/// Smoothing reaches a few edges of a network of so many nodes, whatever the size of the network: otherwise a body would
/// bend the more easily the denser its points. Chosen on the same cases, where it trades even bends for short edges.
constexpr double reference_size = 10000;
/// Networks of fewer nodes than one in this many of it bend the more stiffly: with a few hundred samples, rotations that
/// are hardly smoothed would buckle.
constexpr double largest_relative_area = 5;
constexpr double smallest_relative_area = 1e-9;
/// Passes end when the energy falls by less than this share. Smaller values bring the cases of benchmark/quality no nearer
/// to their exact shapes. [-]
constexpr double default_tolerance = 0.05;
constexpr int default_maximal_number_of_passes = 20;
/// Each pass turns nodes towards their best rotation by one damped step of Newton's method. Without damping, passes
/// converge faster, and the coarsest networks fold up under large twists. Chosen on the same cases among 0 ... 0.8.
constexpr double fit_damping = 0.2;
/// Passes are accelerated from this one on if they start from the field of the handles: where that explains the motion,
/// fewer are needed. Those that start from a guess are accelerated as soon as two states are known.
constexpr int first_accelerated_pass = 4;
/// A guess from a coarser network is taken if it has less than this share of the energy after one pass. [-]
constexpr double guess_advantage = 0.5;

struct Elastic_options
{
  int maximal_number_of_passes = default_maximal_number_of_passes;
  double tolerance = default_tolerance;
  double stiffness = 1;     ///< resistance against bending relative to stretching [-]
  double poisson_ratio = 0; ///< transverse contraction under stretch, in [-1, 0.5] [-]
  Rotation_field rotation_field = Rotation_field::geodesic;
};

struct Elastic_result
{
  Status status = Status::nothing_to_do;
  int number_of_passes = 0;
  double energy = 0;         ///< [L^2]
  double initial_energy = 0; ///< after the first positions, before any pass [L^2]
  /// Whether the guess turned out clearly better than the field of the handles, here or on a coarser network.
  bool is_far_from_field = false;
};

/// Deviations of the first nodes from the field, found on a coarser network.
struct Deviation_guess
{
  std::vector<Vec3> deviations;
  bool is_far_from_field = false; ///< tried there against the field, which need not be tried again
};

/*!
  Alternates

  - the rotation field `B` of the handles (`Rotation_field_solver`) and a harmonic logarithm of scale,
  - positions: `L x = b`, `b_i = sum_j w_ij (G_i + G_j)/2 (x0_i - x0_j)` with `G_i = s_i R_i S_i`,
  - passes, the text's equation (2.2): best local rotations `R_fit`, their deviation from the field
    `d = log(R_fit B^-1)` smoothed by `(L + mu D) d' = mu D d`, `R = exp(d') B`, positions again.

  All matrices are constant while the constraints are; the three factors are made in `constrain()`. Of all states
  that the passes go through, the one with the least energy is kept, so more passes never make it worse.
*/
template <class ConcurrencyTag>
class Elastic_solver
{
public:
  const Elastic_network& network() const { return *m_network; }
  const Node_constraints& constraints() const { return m_constraints; }
  const std::vector<Vec3>& positions() const { return m_position; }
  /// `s_i R_i` of every node: the local similarity without its translation.
  const std::vector<Eigen::Matrix3d>& frames() const { return m_frame; }
  bool is_finite() const
  {
    for (std::size_t i = 0; i < m_position.size(); ++i)
      if (!m_position[i].allFinite() || !m_frame[i].allFinite())
        return false;
    return true;
  }
  /// Rotation of every node relative to the field of the handles. [rad]
  const std::vector<Vec3>& deviations() const { return m_smooth; }

  /// Takes a network, which must outlive its use here, and constraints, and factorises. Returns `false` if a matrix is
  /// singular (a free part without handle).
  bool constrain(const Elastic_network& network, Node_constraints constraints, double stiffness)
  {
    m_network = &network;
    m_constraints = std::move(constraints);
    m_rows = Free_rows(m_constraints);
    m_fit_weight.resize(m_rows.size());
    std::vector<double> soft(m_rows.size(), 0), smoothing(m_rows.size(), 0);
    for (std::size_t r = 0; r < m_rows.size(); ++r) {
      const std::size_t i = m_rows.node_of_row[r];
      const double degree = node_degree(m_network->surface, i);
      if (m_constraints.is_soft(i))
        soft[r] = m_constraints.soft_weight(i, degree);
      m_fit_weight[r] = default_fit_weight / stiffness * relative_area(i) * degree;
      smoothing[r] = soft[r] + m_fit_weight[r];
    }
    const auto assemble = [&](std::vector<const Weighted_graph*> graphs,
                              const std::vector<double>& extra) {
      return linear_algebra::free_laplacian(graphs, m_rows.row_of_node, m_rows.node_of_row, extra);
    };
    const Weighted_graph* surface = &m_network->surface;
    const bool has_links = !m_network->links.neighbor.empty();
    bool field_ok = false, smoothing_ok = false, position_ok = true;
    const Eigen::SparseMatrix<double> of_field = assemble({surface}, soft);
    std::shared_ptr<const linear_algebra::Cholesky_pattern> pattern;
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] {
          pattern = std::make_shared<const linear_algebra::Cholesky_pattern>(
              of_field,
              rank_of_rows(m_network->surface_rank, m_rows));
        },
        [&] {
          if (has_links)
            position_ok = m_link_factor.factorize(assemble({surface, &m_network->links}, soft),
                                                  rank_of_rows(m_network->rank, m_rows));
        });
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] { field_ok = m_field_factor.factorize(of_field, pattern); },
        [&] {
          smoothing_ok = m_smoothing_factor.factorize(assemble({surface}, smoothing), pattern);
        });
    m_position = network.rest;
    m_frame.assign(network.size(), Eigen::Matrix3d::Identity());
    return field_ok && smoothing_ok && position_ok;
  }

  /// Solves for one transformation per handle, from the rest shape. The guess is the first state, or tried after the
  /// first pass, when that is not known to be worth it.
  Elastic_result solve(const std::vector<Similarity>& transforms,
                       const Elastic_options& options,
                       pcs::internal::Progress& progress,
                       const Deviation_guess& guess = {})
  {
    Elastic_result result;
    m_transforms = &transforms;
    m_field_solver(options.rotation_field,
                   m_field_factor,
                   m_network->surface,
                   m_constraints,
                   m_rows,
                   transforms,
                   m_field);
    m_rotation = m_field;
    blend_scales();
    m_stretch_is_used = options.poisson_ratio != 0;
    if (m_stretch_is_used)
      m_stretch.assign(m_network->size(), Eigen::Matrix3d::Identity());
    m_smooth.assign(m_network->size(), Vec3::Zero());
    m_best_smooth.assign(m_network->size(), Vec3::Zero());
    result.is_far_from_field = guess.is_far_from_field && options.maximal_number_of_passes > 0;
    if (result.is_far_from_field) {
      take(guess);
      turn_by_deviations();
    }
    update_frames();
    place_constrained_nodes();
    solve_positions(true);
    result.energy = result.initial_energy = fit_and_measure(options);
    result.status =
        options.maximal_number_of_passes == 0 ? Status::iteration_limit : Status::converged;
    if (m_rows.size() == 0)
      return result;
    m_mixing.restart();
    for (int pass = 0; pass < options.maximal_number_of_passes; ++pass) {
      if (!progress(static_cast<double>(pass) / options.maximal_number_of_passes)) {
        result.status = Status::cancelled;
        return result;
      }
      const double before = result.energy;
      const bool has_improved =
          improve(options, pass >= (result.is_far_from_field ? 1 : first_accelerated_pass), result);
      if (pass == 0 && !guess.deviations.empty() && !guess.is_far_from_field)
        result.is_far_from_field = start_from(guess, options, result);
      result.number_of_passes = pass + 1;
      result.status = Status::converged;
      if (!has_improved || before - result.energy <= options.tolerance * before)
        break;
      result.status = Status::iteration_limit;
    }
    return result;
  }

private:
  using Vec1 = Eigen::Matrix<double, 1, 1>;
  static constexpr std::size_t block = 512;

  /// The area of a node in units of the reference network's.
  double relative_area(std::size_t node) const
  {
    const double area = node < m_network->area.size() ? reference_size * m_network->area[node] : 1;
    return std::min(largest_relative_area, std::max(smallest_relative_area, area));
  }

  std::size_t handle(std::size_t node) const
  {
    return static_cast<std::size_t>(m_constraints.handle_of_node[node]);
  }

  /// The next state is written beside this one: all of it but the positions, which it starts from.
  void keep_state()
  {
    m_best_position = m_position;
    m_best_frame.resize(m_frame.size());
    m_best_frame.swap(m_frame);
    m_best_smooth.swap(m_smooth);
  }

  void swap_state()
  {
    m_position.swap(m_best_position);
    m_frame.swap(m_best_frame);
    m_smooth.swap(m_best_smooth);
  }

  /// One pass: accelerated if that lowers the energy, else plain; `false` if neither does (rounding at the optimum).
  bool improve(const Elastic_options& options, bool is_accelerated, Elastic_result& result)
  {
    keep_state();
    smooth_deviations();
    m_plain = m_smooth;
    m_mixing.mix(m_best_smooth, m_smooth, is_accelerated);
    double energy = apply_deviations(options);
    if (is_accelerated && !(energy < result.energy)) {
      m_mixing.restart();
      m_smooth = m_plain;
      energy = apply_deviations(options);
    }
    if (!(energy < result.energy)) {
      swap_state();
      return false;
    }
    result.energy = energy;
    return true;
  }

  void take(const Deviation_guess& guess)
  {
    for (const auto i : m_rows.node_of_row)
      m_smooth[i] = i < guess.deviations.size() ? guess.deviations[i] : Vec3(Vec3::Zero());
  }

  /// A guess replaces the present state if it is clearly better: where the field of the handles explains the motion,
  /// it is more exact than a coarse network, and what folds up there is no shape here. Returns whether it did.
  bool
  start_from(const Deviation_guess& guess, const Elastic_options& options, Elastic_result& result)
  {
    keep_state();
    m_best_deviation = m_deviation;
    m_best_rotation = m_rotation;
    take(guess);
    const double energy = apply_deviations(options);
    if (energy < guess_advantage * result.energy) {
      result.energy = energy;
      m_mixing.restart();
      return true;
    }
    swap_state();
    m_deviation.swap(m_best_deviation);
    m_rotation.swap(m_best_rotation);
    return false;
  }

  /// Rotations `exp(d) B` from the present deviations, then positions; returns the energy.
  double apply_deviations(const Elastic_options& options)
  {
    turn_by_deviations();
    update_frames();
    solve_positions(false);
    return fit_and_measure(options);
  }

  void turn_by_deviations()
  {
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_rows.size(),
        [&](std::size_t r) {
          const std::size_t i = m_rows.node_of_row[r];
          m_rotation[i] = (rotation_exp(m_smooth[i]) * m_field[i]).normalized();
        },
        block);
  }

  const linear_algebra::Sparse_cholesky& position_factor() const
  {
    return m_network->links.neighbor.empty() ? m_field_factor : m_link_factor;
  }

  void blend_scales()
  {
    m_log_scale.assign(m_network->size(), Vec1::Zero());
    bool any = false;
    for (const Similarity& t : *m_transforms)
      any = any || t.scale() != 1;
    if (!any)
      return;
    const auto value = [&](std::size_t i) {
      return Vec1(std::log((*m_transforms)[handle(i)].scale()));
    };
    solve_harmonic(m_field_factor,
                   m_network->surface,
                   m_constraints,
                   m_rows,
                   value,
                   m_rhs1,
                   m_work1,
                   m_log_scale);
    for (std::size_t i = 0; i < m_network->size(); ++i)
      if (m_constraints.is_prescribed(i))
        m_log_scale[i] = value(i);
  }

  void update_frames()
  {
    if (m_stretch_is_used)
      m_target.resize(m_network->size());
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_network->size(),
        [&](std::size_t i) {
          if (m_constraints.is_prescribed(i)) {
            const Similarity& t = (*m_transforms)[handle(i)];
            m_frame[i] = t.scale() * t.rotation();
          } else
            m_frame[i] = std::exp(m_log_scale[i][0]) * m_rotation[i].toRotationMatrix();
          if (m_stretch_is_used)
            m_target[i] = m_frame[i] * m_stretch[i];
        },
        block);
  }

  /// What the edges at each node aim at: the frame, times the stretch that the material allows.
  const std::vector<Eigen::Matrix3d>& targets() const
  {
    return m_stretch_is_used ? m_target : m_frame;
  }

  void place_constrained_nodes()
  {
    for (std::size_t i = 0; i < m_network->size(); ++i)
      if (m_constraints.is_prescribed(i))
        m_position[i] = (*m_transforms)[handle(i)](m_network->rest[i]);
      else if (m_constraints.handle_of_node[i] == unreached_node)
        m_position[i] = m_network->rest[i];
  }

  /// Links keep their turned direction at first; later they are springs of their rest length, because a link through
  /// a twisted bar must not turn with either end.
  void solve_positions(bool links_turn)
  {
    m_rhs3.resize(m_rows.size());
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_rows.size(),
        [&](std::size_t r) {
          const std::size_t i = m_rows.node_of_row[r];
          Vec3 b;
          const double degree = sum_edges(i, b);
          const auto& links = m_network->links;
          if (!links.neighbor.empty())
            for (std::size_t e = links.first[i]; e < links.first[i + 1]; ++e) {
              const std::size_t j = links.neighbor[e];
              b += links.weight[e] * link_target(i, j, links_turn);
              if (m_constraints.is_prescribed(j))
                b += links.weight[e] * m_position[j];
            }
          if (m_constraints.is_soft(i))
            b += m_constraints.soft_weight(i, degree) *
                 (*m_transforms)[handle(i)](m_network->rest[i]);
          m_rhs3[r] = b;
        },
        block);
    position_factor().solve(m_rhs3, m_work3);
    for (std::size_t r = 0; r < m_rows.size(); ++r)
      m_position[m_rows.node_of_row[r]] = m_rhs3[r];
  }

  /// Right side of node `i` from its surface edges; returns its degree. Number by number, as in `newton_turn()`.
  double sum_edges(std::size_t i, Vec3& b) const
  {
    const auto& graph = m_network->surface;
    const double *own = targets()[i].data(), *xi = m_network->rest[i].data();
    double degree = 0, edges[3] = {}, sum[3] = {};
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const double *other = targets()[j].data(), *xj = m_network->rest[j].data();
      const double w = graph.weight[e];
      double edge[3];
      for (int k = 0; k < 3; ++k) {
        edge[k] = w * (xi[k] - xj[k]);
        edges[k] += edge[k];
      }
      for (int k = 0; k < 3; ++k)
        sum[k] += 0.5 * (other[k] * edge[0] + other[3 + k] * edge[1] + other[6 + k] * edge[2]);
      if (m_constraints.is_prescribed(j))
        for (int k = 0; k < 3; ++k)
          sum[k] += w * m_position[j][k];
      degree += w;
    }
    for (int k = 0; k < 3; ++k)
      b[k] = sum[k] + 0.5 * (own[k] * edges[0] + own[3 + k] * edges[1] + own[6 + k] * edges[2]);
    return degree;
  }

  double scale_between(std::size_t i, std::size_t j) const
  {
    return std::exp(0.5 * (m_log_scale[i][0] + m_log_scale[j][0]));
  }

  Vec3 link_target(std::size_t i, std::size_t j, bool links_turn) const
  {
    const Vec3 edge = m_network->rest[i] - m_network->rest[j];
    if (links_turn)
      return 0.5 * (m_frame[i] * edge + m_frame[j] * edge);
    const Vec3 present = m_position[i] - m_position[j];
    const double length = present.norm();
    return length > 0 ? Vec3(scale_between(i, j) * edge.norm() / length * present)
                      : Vec3(Vec3::Zero());
  }

  /// One sweep: the energy of the present state, and the deviation of each node's best rotation from the field.
  double fit_and_measure(const Elastic_options& options)
  {
    m_deviation.resize(m_network->size());
    return pcs::internal::blocked_reduce<ConcurrencyTag>(
        m_network->size(),
        0.0,
        [&](std::size_t i) {
          if (m_constraints.handle_of_node[i] == unreached_node)
            return 0.0;
          Eigen::Matrix3d covariance;
          double energy = measure_edges(i, covariance);
          energy += link_energy(i);
          if (!m_constraints.is_prescribed(i)) {
            m_deviation[i] = deviation(covariance, m_rotation[i], m_field[i]);
            if (m_stretch_is_used)
              m_stretch[i] = transverse_stretch(i, options.poisson_ratio);
          }
          return energy;
        },
        [](double a, double b) { return a + b; },
        block);
  }

  /// Half the energy of the surface edges of node `i`, and `sum_j w_ij (x_j - x_i) (x0_j - x0_i)^T`.
  /// Number by number, as in `newton_turn()`.
  double measure_edges(std::size_t i, Eigen::Matrix3d& covariance) const
  {
    const auto& graph = m_network->surface;
    const double *own = targets()[i].data(), *xi = m_network->rest[i].data(),
                 *pi = m_position[i].data();
    double energy = 0, sum[9] = {};
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const double *other = targets()[j].data(), *xj = m_network->rest[j].data(),
                   *pj = m_position[j].data();
      double rest[3], now[3], squared = 0;
      for (int k = 0; k < 3; ++k) {
        rest[k] = xj[k] - xi[k];
        now[k] = pj[k] - pi[k];
      }
      for (int k = 0; k < 3; ++k) {
        const double aim = (own[k] + other[k]) * rest[0] + (own[3 + k] + other[3 + k]) * rest[1] +
                           (own[6 + k] + other[6 + k]) * rest[2];
        const double error = now[k] - 0.5 * aim;
        squared += error * error;
      }
      const double w = graph.weight[e];
      energy += 0.5 * w * squared;
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
          sum[3 * c + r] += w * now[r] * rest[c];
    }
    covariance = Eigen::Map<const Eigen::Matrix3d>(sum);
    return energy;
  }

  /// Of the rotation that fits best, one step from the present one, from the field. [rad]
  static Vec3
  deviation(const Eigen::Matrix3d& covariance, const Quaternion& present, const Quaternion& field)
  {
    const Quaternion q = present * field.conjugate();
    const Eigen::Matrix3d turned = covariance.lazyProduct(present.toRotationMatrix().transpose());
    const Vec3 u = newton_turn(turned, fit_damping);
    const double x = 0.5 * u.x(), y = 0.5 * u.y(), z = 0.5 * u.z();
    const Quaternion fit(q.w() - x * q.x() - y * q.y() - z * q.z(),
                         q.x() + x * q.w() + y * q.z() - z * q.y(),
                         q.y() + y * q.w() + z * q.x() - x * q.z(),
                         q.z() + z * q.w() + x * q.y() - y * q.x());
    return rotation_log(fit.normalized());
  }

  double link_energy(std::size_t i) const
  {
    const auto& links = m_network->links;
    double energy = 0;
    if (!links.neighbor.empty())
      for (std::size_t e = links.first[i]; e < links.first[i + 1]; ++e) {
        const std::size_t j = links.neighbor[e];
        if (j < i)
          continue;
        const double error = (m_position[i] - m_position[j]).norm() -
                             scale_between(i, j) * (m_network->rest[i] - m_network->rest[j]).norm();
        energy += links.weight[e] * error * error;
      }
    return energy;
  }

  /// `(L + mu D) d' = mu D d`.
  void smooth_deviations()
  {
    m_rhs3.resize(m_rows.size());
    for (std::size_t r = 0; r < m_rows.size(); ++r)
      m_rhs3[r] = m_fit_weight[r] * m_deviation[m_rows.node_of_row[r]];
    m_smoothing_factor.solve(m_rhs3, m_work3);
    for (std::size_t r = 0; r < m_rows.size(); ++r)
      m_smooth[m_rows.node_of_row[r]] = m_rhs3[r];
  }

  /// The rest shape that a material of the given Poisson's ratio takes under the present main stretch `s1` along
  /// `v`: `S = s1 v v^T + s1^-nu (I - v v^T)`.
  Eigen::Matrix3d transverse_stretch(std::size_t i, double poisson_ratio) const
  {
    const Eigen::Matrix3d in_rest = m_frame[i].inverse() * deformation_gradient(i);
    const auto eigen = linear_algebra::symmetric_eigen<3>(0.5 * (in_rest + in_rest.transpose()));
    if (!(eigen.values.minCoeff() > 0) || !eigen.values.allFinite())
      return Eigen::Matrix3d::Identity();
    int main = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(std::log(eigen.values[k])) > std::abs(std::log(eigen.values[main])))
        main = k;
    // Beyond a factor of ten the network is torn, not stretched.
    const double s1 = std::min(10.0, std::max(0.1, eigen.values[main]));
    const Vec3 v = eigen.vectors.col(main);
    const double across = std::pow(s1, -poisson_ratio);
    return (s1 - across) * v * v.transpose() + across * Eigen::Matrix3d::Identity();
  }

public:
  /// Weight of the frame in `deformation_gradient()`, relative to the spread of the edges: it decides where the
  /// edges say nothing, across a surface.
  static constexpr double frame_share = 0.05;
  /// Of shorter edges, relative to the coordinates, rounding leaves too little to measure a gradient. [-]
  static constexpr double shortest_measured_edge = 1e-10;

  /// Best linear map of the edges at node `i` from rest to now, completed by the frame across the surface. [-]
  Eigen::Matrix3d deformation_gradient(std::size_t i) const
  {
    const auto& graph = m_network->surface;
    double longest = 0, farthest = m_position[i].lpNorm<Eigen::Infinity>();
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      longest =
          std::max(longest, (m_network->rest[j] - m_network->rest[i]).lpNorm<Eigen::Infinity>());
      farthest = std::max(farthest, m_position[j].lpNorm<Eigen::Infinity>());
    }
    if (!(longest > shortest_measured_edge * farthest))
      return m_frame[i];
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero(), spread = Eigen::Matrix3d::Zero();
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const Vec3 edge = (m_network->rest[j] - m_network->rest[i]) / longest;
      const Vec3 present = (m_position[j] - m_position[i]) / longest;
      covariance += graph.weight[e] * present * edge.transpose();
      spread += graph.weight[e] * edge * edge.transpose();
    }
    const double share = frame_share * spread.trace();
    if (!(share > 0))
      return m_frame[i];
    covariance += share * m_frame[i];
    spread += share * Eigen::Matrix3d::Identity();
    return covariance * spread.inverse();
  }

private:
  const Elastic_network* m_network = nullptr;
  Node_constraints m_constraints;
  Free_rows m_rows;
  linear_algebra::Sparse_cholesky m_field_factor, m_link_factor, m_smoothing_factor;
  Rotation_field_solver m_field_solver;
  std::vector<double> m_fit_weight; ///< of each row, its degree included
  bool m_stretch_is_used = false;

  const std::vector<Similarity>* m_transforms = nullptr;
  Anderson_mixing<ConcurrencyTag> m_mixing;
  std::vector<Quaternion> m_field, m_rotation, m_best_rotation;
  std::vector<Eigen::Matrix3d> m_frame, m_best_frame, m_stretch, m_target;
  std::vector<Vec1> m_log_scale, m_rhs1, m_work1;
  std::vector<Vec3> m_position, m_best_position, m_rhs3, m_work3;
  std::vector<Vec3> m_deviation, m_best_deviation; ///< of the best local rotations from the field
  std::vector<Vec3> m_smooth, m_best_smooth, m_plain; ///< the same, smoothed: what is used
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ELASTIC_SOLVER_H
