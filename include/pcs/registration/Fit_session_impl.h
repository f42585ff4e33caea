// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Stages of a nonrigid registration on plain coordinates: rigid alignment, soft matches, closest
// matches. Compiled in `pcs::compiled_deformation`, otherwise included by `Fit_session.h`.

#ifndef PCS_REGISTRATION_FIT_SESSION_IMPL_H
#define PCS_REGISTRATION_FIT_SESSION_IMPL_H

#include <pcs/core/Deformation_report.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/Status.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/body/Sampled_body_impl.h>
#include <pcs/deformation/model/Sampling_options.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/registration/Deformable_shape.h>
#include <pcs/registration/Elastic_edges.h>
#include <pcs/registration/Fit_options.h>
#include <pcs/registration/Fit_session.h>
#include <pcs/registration/Fit_target.h>
#include <pcs/registration/Gauss_newton.h>
#include <pcs/registration/Stretch_field.h>
#include <pcs/registration/Surface_points.h>
#include <pcs/registration/align_rigidly.h>
#include <pcs/registration/closest_attractions.h>
#include <pcs/registration/closest_matches.h>
#include <pcs/registration/soft_matches.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace registration {

/// Least number of points of each cloud that are compared in the last stage. [count]
constexpr std::size_t least_number_of_fine_points = 6000;
/// Edge length at which bending has the weight `stiffness`. [extents]
constexpr double reference_spacing = 0.03;
/// Weight of a landmark relative to all matches together. [-]
constexpr double landmark_weight = 0.5;

/// Standard deviations of the soft matches at the beginning and the end of their stage [extents],
/// the largest ratio of two consecutive variances [-], and the length of the features that are
/// followed [standard deviations].
constexpr double first_drift = 0.1, last_drift = 0.015, drift_rate = 0.85, drift_length = 3;

/// Length of the features that are followed, and largest distance of a match, at the beginning of
/// the last stage [extents], and their ratio in consecutive iterations. [-]
constexpr double first_fine_length = 0.1, first_gate = 0.1, fine_rate = 0.85;
/// Lower bound of the scale of the robust weights. With 0.05, where most of the shape fits early,
/// the rest counts as outliers and is not fitted; with 2, sparse targets with outliers pull parts
/// that have no target. Chosen among 0.05 to 2 on bench_fit_point_set. [reaches]
constexpr double least_scale = 0.7;
/// Largest distance of a match in the last iterations. [scales, reaches]
constexpr double gate_of_scale = 4, gate_of_reach = 2;
/// Smoothing length [extents] and resistance [-] of the stretch, see `Stretch_field`.
constexpr double stretch_length = 0.07, stretch_resistance = 0.05;
/// Damping of the rotations, relative to the edges. [-]
constexpr double rotation_damping = 1e-3;

/// Shape and stages of a `Fit_session`.
template <class ConcurrencyTag>
class Fit_stages
{
public:
  using Body = deformation::Sampled_body<ConcurrencyTag>;

  /// Prepares the source. Returns `false` if cancelled.
  /// \param points in the caller's coordinates
  /// \param normals one for each point, or empty: they are estimated
  bool build(std::vector<Vec3> points,
             std::vector<Vec3> normals,
             const deformation::Sampling_options& sampling,
             pcs::internal::Progress& progress)
  {
    Deformation_report::Seconds seconds;
    m_rest = points;
    if (!m_body.build(std::move(points), sampling, seconds, progress))
      return false;
    for (Vec3& p : m_rest)
      p = m_body.frame.to_local(p);
    m_extent = extent_of(m_rest);
    m_shape.start(m_body.network);
    find_carriers();
    choose_points(std::move(normals));
    return true;
  }

  const Body& body() const { return m_body; }
  const Deformable_shape& shape() const { return m_shape; }
  const deformation::Local_frame& frame() const { return m_body.frame; }
  /// Diagonal of the bounding box of the source, in local coordinates. [L]
  double extent() const { return m_extent; }
  std::size_t number_of_points() const { return m_rest.size(); }
  /// Number of points that look for matches in the last stage. [count]
  std::size_t number_of_fine_points() const { return m_fine.size(); }
  const Vec3& rest(std::size_t i) const { return m_rest[i]; }
  const Carriers& carriers(std::size_t i) const { return m_carriers[m_body.site_of_input[i]]; }
  Vec3 position(std::size_t i) const { return m_shape.move(m_rest[i], carriers(i)); }

  void put_at_rest() { m_shape.start(m_body.network); }
  void restore(const Shape_state& state) { m_shape.state = state; }

  /*!
    Deforms the current shape towards the target. The shape is kept if the status is `cancelled` or
    `numerical_failure`.
    \param is_warm whether the shape is near its target: the stages with soft matches are shorter
  */
  Status fit(const Fit_target& target,
             const std::vector<Local_landmark>& landmarks,
             const Fit_options& options,
             bool is_warm,
             Fit_report& report,
             pcs::internal::Progress& progress)
  {
    m_options = options;
    const Deformable_shape before = m_shape;
    Status status = Status::converged;
    start_solver(landmarks);
    if (!is_warm) {
      const pcs::internal::Stage_timer timer(report.seconds.rigid);
      const pcs::internal::Progress_stage stage(progress, 0.2, 0.3);
      status = align(target, report, progress);
    }
    if (is_kept(status)) {
      const pcs::internal::Stage_timer timer(report.seconds.coarse);
      const pcs::internal::Progress_stage stage(progress, 0.3, 0.6);
      status = drift(target, is_warm, report, progress);
    }
    if (is_kept(status)) {
      const pcs::internal::Stage_timer timer(report.seconds.fine);
      const pcs::internal::Progress_stage stage(progress, 0.6, 0.95);
      status = refine(target, report, progress);
    }
    if (!is_kept(status))
      m_shape = before;
    return status;
  }

  /// Finds the closest target point of each source point after `fit()`, with weight 0 for those
  /// that have none.
  void match_all(const Fit_target& target, std::vector<Closest_match>& matches) const
  {
    matches.resize(m_rest.size());
    const Match_limits limits = limits_of(m_gate);
    pcs::internal::for_each_index<ConcurrencyTag>(
        m_rest.size(),
        [&](std::size_t i) {
          const Vec3 normal = moved_normal(m_shape.linear(carriers(i)), m_normals[i]);
          matches[i] = find_closest(target.all, position(i), normal, limits);
        },
        256);
  }

  /// Completes the report after `fit()`. Returns the closest target point of each source point, by
  /// its position in the target range, or -1.
  std::vector<std::ptrdiff_t> describe(const Fit_target& target,
                                       const std::vector<Local_landmark>& landmarks,
                                       Fit_report& report) const
  {
    const double unit = m_body.frame.unit;
    std::vector<Closest_match> matches;
    match_all(target, matches);
    std::vector<double> residuals;
    std::vector<std::ptrdiff_t> index(matches.size());
    double squares = 0, moved_by = 0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const bool is_matched = matches[i].weight > 0;
      if (is_matched) {
        residuals.push_back(std::abs(matches[i].plane_distance));
        squares += residuals.back() * residuals.back();
      }
      moved_by += (position(i) - m_rest[i]).squaredNorm();
      index[i] = is_matched ? static_cast<std::ptrdiff_t>(target.input[matches[i].index]) : -1;
    }
    report.number_of_samples = m_body.network.size();
    report.number_of_matched = residuals.size();
    if (residuals.empty())
      report.rms_residual = report.median_residual = std::numeric_limits<double>::quiet_NaN();
    else {
      report.rms_residual = unit * std::sqrt(squares / static_cast<double>(residuals.size()));
      report.median_residual = unit * pcs::internal::lower_median(residuals);
    }
    report.rms_displacement = unit * std::sqrt(moved_by / static_cast<double>(matches.size()));
    for (const auto& l : landmarks)
      report.largest_landmark_gap =
          std::max(report.largest_landmark_gap, unit * (position(l.index) - l.target).norm());
    const double extent = unit * m_extent;
    report.is_plausible = report.matched_share() >= Fit_report::least_matched_share &&
                          report.median_residual <= Fit_report::largest_plausible_residual * extent;
    return index;
  }

private:
  static bool is_kept(Status status)
  {
    return status != Status::cancelled && status != Status::numerical_failure;
  }

  static double extent_of(const std::vector<Vec3>& points)
  {
    Vec3 low = points.front(), high = low;
    for (const Vec3& p : points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    return (high - low).norm();
  }

  // ---- preparation

  /// Finds the carriers of all sites. Sites of fragments without samples follow the sample that is
  /// nearest in space.
  void find_carriers()
  {
    const neighborhood::Nearest_neighbors nodes(m_body.network.rest);
    std::vector<neighborhood::Nearest_neighbors::Neighbor> nearest;
    m_carriers.resize(m_body.number_of_sites());
    for (std::size_t site = 0; site < m_carriers.size(); ++site) {
      Carriers& c = m_carriers[site] = carriers_of_site(m_body, site);
      if (c.count > 0)
        continue;
      nodes(m_body.rest_of_site(site), 1, nearest);
      c.node[0] = nearest.front().index;
      c.weight[0] = 1;
      c.count = 1;
    }
  }

  void choose_points(std::vector<Vec3> normals)
  {
    Surface_points all;
    all.template build<ConcurrencyTag>(m_rest, std::move(normals));
    m_normals = all.normals();
    const std::size_t count = std::max(least_number_of_fine_points, 4 * m_body.network.size());
    m_fine = spread_points<ConcurrencyTag>(m_rest, count);
    std::vector<Vec3> positions, fine_normals;
    for (const auto i : m_fine) {
      positions.push_back(m_rest[i]);
      fine_normals.push_back(m_normals[i]);
    }
    m_soft = spread_points<ConcurrencyTag>(positions, number_of_soft_points);
    m_surface.template build<ConcurrencyTag>(std::move(positions), std::move(fine_normals));
  }

  void start_solver(const std::vector<Local_landmark>& landmarks)
  {
    std::vector<Carried_point> points;
    for (const auto i : m_fine)
      points.push_back({m_rest[i], carriers(i)});
    m_landmark_targets.clear();
    for (const Local_landmark& l : landmarks) {
      points.push_back({m_rest[l.index], carriers(l.index)});
      m_landmark_targets.push_back(l.target);
    }
    m_solver.start(m_shape,
                   collect_edges(m_body.network, m_body.component_of_sample()),
                   std::move(points));
  }

  // ---- steps of the stages

  Vec3 moved(std::size_t p) const
  {
    const Carried_point& point = m_solver.points()[p];
    return m_shape.move(point.rest, point.carriers);
  }

  void soft_positions(std::vector<Vec3>& result) const
  {
    result.resize(m_soft.size());
    for (std::size_t k = 0; k < m_soft.size(); ++k)
      result[k] = moved(m_soft[k]);
  }

  double number_of_nodes() const { return static_cast<double>(m_body.network.size()); }

  void attract_landmarks(std::vector<Attraction>& attractions) const
  {
    const double w = landmark_weight * number_of_nodes();
    for (std::size_t l = 0; l < m_landmark_targets.size(); ++l) {
      Attraction& attraction = attractions[m_fine.size() + l];
      attraction.a = w * Eigen::Matrix3d::Identity();
      attraction.pull = w * (m_landmark_targets[l] - moved(m_fine.size() + l));
    }
  }

  /// Weights of an iteration that follows features of the size `length` [L].
  Energy_weights weights(double length) const
  {
    const double h = m_shape.spacing, reference = reference_spacing * m_extent;
    return {m_options.stiffness * reference * reference / (h * h),
            h * h / (length * length),
            rotation_damping};
  }

  bool go_on(std::size_t iteration, pcs::internal::Progress& progress) const
  {
    return progress(static_cast<double>(iteration) /
                    static_cast<double>(m_options.number_of_iterations));
  }

  // ---- stages

  /// Moves the shape rigidly, if that is wanted: by the landmarks if there are three or more at
  /// different places, otherwise by soft matches.
  Status align(const Fit_target& target, Fit_report& report, pcs::internal::Progress& progress)
  {
    Rigid_motion motion;
    std::vector<Vec3> source;
    for (std::size_t l = 0; l < m_landmark_targets.size(); ++l)
      source.push_back(moved(m_fine.size() + l));
    if (m_options.do_align && have_three_places(source)) {
      motion = fit_motion(source, m_landmark_targets, std::vector<double>(source.size(), 1));
    } else if (m_options.do_align) {
      soft_positions(source);
      motion = align_rigidly<ConcurrencyTag>(source,
                                             target.soft,
                                             {last_alignment * m_extent,
                                              m_options.tolerance * m_extent,
                                              m_options.outlier_share,
                                              m_options.number_of_iterations},
                                             [&](std::size_t k) {
                                               ++report.number_of_iterations;
                                               return go_on(k, progress);
                                             });
    }
    m_shape.transform(motion.r, motion.t);
    const deformation::Local_frame& f = m_body.frame;
    Eigen::Matrix<double, 3, 4> world;
    world << motion.r, f.origin - motion.r * f.origin + f.unit * motion.t;
    report.rigid_motion = Similarity::from_matrix(world);
    return progress.is_cancelled() ? Status::cancelled : Status::converged;
  }

  static bool have_three_places(const std::vector<Vec3>& points)
  {
    std::vector<Vec3> places; // at most 3
    for (const Vec3& p : points)
      if (places.size() < 3 && std::find(places.begin(), places.end(), p) == places.end())
        places.push_back(p);
    return places.size() == 3;
  }

  /// Standard deviation of the soft matches at the end of the rigid alignment. [extents]
  static constexpr double last_alignment = 0.02;

  /// Coherent point drift with the elastic energy.
  Status drift(const Fit_target& target,
               bool is_warm,
               Fit_report& report,
               pcs::internal::Progress& progress)
  {
    std::vector<Vec3> source;
    std::vector<Attraction> attractions;
    Soft_matches matches;
    soft_positions(source);
    const double volume = common_volume(source, target.soft);
    const double last = std::pow(last_drift * m_extent, 2);
    const double first = std::pow((is_warm ? 0.5 : 1) * first_drift * m_extent, 2);
    double variance = std::min(first, mean_variance(source, target.soft));
    for (std::size_t k = 0; k < m_options.number_of_iterations; ++k) {
      if (!go_on(k, progress))
        return Status::cancelled;
      find_soft_matches<ConcurrencyTag>(source,
                                        target.soft,
                                        variance,
                                        m_options.outlier_share,
                                        volume,
                                        matches);
      attract_softly(source, matches, attractions);
      ++report.number_of_iterations;
      if (m_solver.template step<ConcurrencyTag>(attractions,
                                                 weights(drift_length * std::sqrt(variance)),
                                                 m_shape) < 0)
        return Status::numerical_failure;
      soft_positions(source);
      if (variance <= last)
        break;
      variance = std::min(drift_rate * variance, std::max(matches.variance, 0.6 * variance));
      variance = std::max(last, variance);
    }
    return Status::converged;
  }

  void attract_softly(const std::vector<Vec3>& source,
                      const Soft_matches& matches,
                      std::vector<Attraction>& attractions) const
  {
    constexpr double largest_weight = 2; // where many target points share a source point
    const double unit = number_of_nodes() / static_cast<double>(source.size());
    attractions.assign(m_solver.points().size(), Attraction());
    for (std::size_t i = 0; i < source.size(); ++i) {
      const double w = unit * std::min(largest_weight, matches.weight[i]);
      attractions[m_soft[i]].a = w * Eigen::Matrix3d::Identity();
      attractions[m_soft[i]].pull = w * (matches.target[i] - source[i]);
    }
    attract_landmarks(attractions);
  }

  /// Closest matches in both directions, with robust distances from tangent planes.
  Status refine(const Fit_target& target, Fit_report& report, pcs::internal::Progress& progress)
  {
    const double reach = target.all.median_reach();
    const double last_length = m_options.fitting_length * m_extent;
    double length = std::max(last_length, first_fine_length * m_extent);
    m_gate = first_gate * m_extent;
    if (!m_stretch.start(m_shape,
                         m_solver.edges().surface,
                         stretch_length * m_extent,
                         stretch_resistance))
      return Status::numerical_failure;
    for (std::size_t k = 0; k < m_options.number_of_iterations; ++k) {
      if (!go_on(k, progress))
        return Status::cancelled;
      const double scale = attract_closely(target);
      m_stretch.template update<ConcurrencyTag>(m_shape);
      const double step =
          m_solver.template step<ConcurrencyTag>(m_attractions, weights(length), m_shape);
      ++report.number_of_iterations;
      if (step < 0)
        return Status::numerical_failure;
      m_gate = std::max({fine_rate * m_gate, gate_of_scale * scale, gate_of_reach * reach});
      if (length <= last_length && step < m_options.tolerance * m_extent)
        return Status::converged;
      length = std::max(last_length, fine_rate * length);
    }
    return Status::iteration_limit;
  }

  Match_limits limits_of(double gate) const
  {
    Match_limits limits;
    limits.distance = gate;
    limits.is_oriented = m_options.is_oriented;
    return limits;
  }

  /// Finds the matches in both directions and their attractions. Returns the scale of the
  /// distances. [L]
  double attract_closely(const Fit_target& target)
  {
    const std::size_t n = m_fine.size();
    std::vector<Vec3> positions(n), normals(n);
    pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t p) {
      positions[p] = moved(p);
      normals[p] =
          moved_normal(m_shape.linear(m_solver.points()[p].carriers), m_normals[m_fine[p]]);
    });
    const Match_limits limits = limits_of(m_gate);
    find_closest_matches<ConcurrencyTag>(target.all, positions, normals, limits, m_forward);
    m_surface.move(std::move(positions), std::move(normals));
    find_closest_matches<ConcurrencyTag>(m_surface,
                                         target.fine,
                                         target.fine_normals,
                                         limits,
                                         m_backward);
    const double scale = robust_scale(m_forward, least_scale * target.all.median_reach());
    add_matches(target, scale);
    attract_landmarks(m_attractions);
    return scale;
  }

  void add_matches(const Fit_target& target, double scale)
  {
    m_attractions.assign(m_solver.points().size(), Attraction());
    const auto& x = m_surface.points();
    const double forward = number_of_nodes() / static_cast<double>(m_forward.size());
    for (std::size_t p = 0; p < m_forward.size(); ++p) {
      const Closest_match& m = m_forward[p];
      if (m.weight > 0)
        add_match(x[p],
                  target.all.points()[m.index],
                  target.all.normals()[m.index],
                  m,
                  forward,
                  scale,
                  m_attractions[p]);
    }
    const double backward = number_of_nodes() / static_cast<double>(m_backward.size());
    for (std::size_t j = 0; j < m_backward.size(); ++j) {
      const Closest_match& m = m_backward[j];
      if (m.weight > 0)
        add_match(x[m.index],
                  target.fine[j],
                  target.fine_normals[j],
                  m,
                  backward,
                  scale,
                  m_attractions[m.index]);
    }
  }

  Body m_body;
  Deformable_shape m_shape;
  Gauss_newton m_solver;
  Stretch_field m_stretch;
  Fit_options m_options;
  double m_extent = 1;                  ///< [L]
  double m_gate = 0;                    ///< largest distance of a match [L]
  std::vector<Vec3> m_rest, m_normals;  ///< by input index
  std::vector<Carriers> m_carriers;     ///< by site
  std::vector<std::uint32_t> m_fine;    ///< points that take part, by input index
  std::vector<std::uint32_t> m_soft;    ///< those of the soft stages, in `m_fine`
  Surface_points m_surface;             ///< the points `m_fine`, moved
  std::vector<Vec3> m_landmark_targets; ///< [L]
  std::vector<Closest_match> m_forward, m_backward;
  std::vector<Attraction> m_attractions;
};

// ---- the session

template <class ConcurrencyTag>
Fit_session<ConcurrencyTag>::Fit_session()
  : m_stages(std::make_unique<Fit_stages<ConcurrencyTag>>())
{
}

template <class ConcurrencyTag>
Fit_session<ConcurrencyTag>::~Fit_session() = default;

template <class ConcurrencyTag>
bool Fit_session<ConcurrencyTag>::build(std::vector<Vec3> points,
                                        std::vector<Vec3> normals,
                                        const deformation::Sampling_options& sampling,
                                        pcs::internal::Progress& progress)
{
  return m_stages->build(std::move(points), std::move(normals), sampling, progress);
}

template <class ConcurrencyTag>
const deformation::Local_frame& Fit_session<ConcurrencyTag>::frame() const
{
  return m_stages->frame();
}

template <class ConcurrencyTag>
double Fit_session<ConcurrencyTag>::extent() const
{
  return m_stages->extent();
}

template <class ConcurrencyTag>
std::size_t Fit_session<ConcurrencyTag>::number_of_points() const
{
  return m_stages->number_of_points();
}

template <class ConcurrencyTag>
std::size_t Fit_session<ConcurrencyTag>::number_of_samples() const
{
  return m_stages->body().network.size();
}

template <class ConcurrencyTag>
Vec3 Fit_session<ConcurrencyTag>::position(std::size_t i) const
{
  return m_stages->frame().to_world(m_stages->position(i));
}

template <class ConcurrencyTag>
Eigen::Matrix3d Fit_session<ConcurrencyTag>::gradient(std::size_t i) const
{
  return m_stages->shape().linear(m_stages->carriers(i));
}

template <class ConcurrencyTag>
void Fit_session<ConcurrencyTag>::put_at_rest()
{
  m_stages->put_at_rest();
}

template <class ConcurrencyTag>
std::vector<std::ptrdiff_t> Fit_session<ConcurrencyTag>::fit(const Fit_input& input,
                                                             const Fit_options& options,
                                                             bool is_warm,
                                                             const std::function<void()>& write,
                                                             Fit_report& report,
                                                             pcs::internal::Progress& progress)
{
  Fit_target target;
  {
    const pcs::internal::Stage_timer timer(report.seconds.preparation);
    target.template build<ConcurrencyTag>(input.points,
                                          input.normals,
                                          m_stages->number_of_fine_points());
  }
  report.status = Status::cancelled;
  if (!progress(0.2))
    return {};
  const Shape_state before = m_stages->shape().state;
  if (!is_warm)
    m_stages->put_at_rest();
  report.status = m_stages->fit(target, input.landmarks, options, is_warm, report, progress);
  const bool is_solved =
      report.status == Status::converged || report.status == Status::iteration_limit;
  if (is_solved && !progress(1)) // the last call: afterwards, points are written
    report.status = Status::cancelled;
  if (report.status == Status::cancelled || report.status == Status::numerical_failure) {
    m_stages->restore(before);
    return {};
  }
  const pcs::internal::Stage_timer timer(report.seconds.writing);
  write();
  return m_stages->describe(target, input.landmarks, report);
}

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_FIT_SESSION_IMPL_H
