// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rigid motions after which all stations see the same branches, by robust least squares.

#ifndef PCS_SKELETON_REGISTRATION_ALIGN_STATIONS_H
#define PCS_SKELETON_REGISTRATION_ALIGN_STATIONS_H

#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Index_groups.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/registration/Registration_options.h>
#include <pcs/skeleton/registration/Rigid_motion.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// The estimated motions, in the local coordinates of the scan.
struct Aligned_stations
{
  std::vector<Rigid_motion> motions;
  double size = 0, error = 0; ///< root mean squares of the motions and of their errors [L]
};

namespace internal {

/*!
  Estimates the motions of the stations by the Gauss-Newton method. The distance of a point from a
  straight piece of a branch depends on the motion of its station and on the shape of the piece. The
  axis may be bent, the radius may change, and the section may be oval. The ten shape parameters of
  every piece are eliminated. The remaining residuals determine the motions, since each station sees
  a different side. Only the positions of the pieces are taken from the fitted axes. The bends of
  these axes are not used, because they depend on the unknown motions of the points.
*/
template <class ConcurrencyTag>
class Station_alignment
{
public:
  /// `station` has one entry for each point of the scan: `none` if its station is unknown.
  Station_alignment(const Scan& scan,
                    const Axis_set& axes,
                    const std::vector<Index>& station,
                    std::size_t number_of_stations,
                    const Station_alignment_options& rules)
    : m_scan(scan), m_axes(axes), m_station(station), m_rules(rules), m_count(number_of_stations, 0)
  {
    for (const Index s : station)
      if (s != none)
        m_count[s] += 1;
    cut_pieces();
  }

  /*!
    Estimates the motions from all axes. The difference between separate estimates from the even and
    the odd axes indicates by which factor their variance exceeds the variance for independent
    noise. The weight of the points is divided by this factor. The prior limits motions that the
    points do not determine.
  */
  Aligned_stations run()
  {
    Aligned_stations result;
    result.motions.resize(m_count.size());
    if (m_pieces.empty() || m_count.size() < 2 || !(m_axes.noise > 0))
      return result;
    const Answer even = motions_by([](Index a) { return a % 2 == 0; });
    const std::size_t number_of_even = m_used.size();
    const Answer odd = motions_by([](Index a) { return a % 2 == 1; });
    const std::size_t fewest = std::min(number_of_even, m_used.size());
    const Eigen::VectorXd apart = even.motions - odd.motions;
    const Eigen::MatrixXd expected = inverse(even.matrix) + inverse(odd.matrix);
    const double surprise =
        apart.dot(expected.ldlt().solve(apart)) / double(apart.size() - freedom);
    if (!std::isfinite(surprise))
      return result;
    m_trust = 1 / std::max(1.0, surprise);
    const Answer all = motions_by([](Index) { return true; });
    for (std::size_t s = 0; s < m_count.size(); ++s) {
      const Eigen::Index at = freedom * static_cast<Eigen::Index>(s);
      result.motions[s] = {all.motions.template segment<3>(at),
                           all.motions.template segment<3>(at + 3)};
    }
    // rotations are multiplied by a typical distance, which is the unit of length
    const double mean = 1 / double(m_count.size());
    result.size = std::sqrt(mean * all.motions.squaredNorm());
    result.error = fewest < m_rules.fewest_pieces ? result.size // unknown
                                                  : std::sqrt(mean * 0.25 * apart.squaredNorm());
    return result;
  }

private:
  static constexpr int freedom = 6; ///< of a motion: translation and rotation
  static constexpr int local = 10;  ///< radius (2), lateral position (3 each), oval (2)
  using Motion = Eigen::Matrix<double, freedom, 1>;
  using Local = Eigen::Matrix<double, local, 1>;
  using Local_matrix = Eigen::Matrix<double, local, local>;

  struct Answer
  {
    Eigen::VectorXd motions; ///< translation and rotation of every station
    Eigen::MatrixXd matrix;  ///< of their normal equations
  };

  static Eigen::MatrixXd inverse(const Eigen::MatrixXd& matrix)
  {
    return matrix.ldlt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  }

  struct Piece
  {
    Index axis = 0;
    Vec3 middle = Vec3::Zero(), along = Vec3::UnitZ(); ///< a straight line
    Vec3 e1 = Vec3::Zero(), e2 = Vec3::Zero();         ///< across
    double half_length = 0, radius = 0;
    std::vector<Index> points;
    Local wrong = Local::Zero();
  };

  void cut_pieces()
  {
    const Index_groups points(m_axes.axes.size(), m_axes.axis_of_point);
    for (Index a = 0; a < m_axes.axes.size(); ++a) {
      const Axis& axis = m_axes.axes[a].axis;
      std::vector<std::pair<Index, Index>> sorted; // segment, point
      for (const Index i : points[a]) {
        const Axis_place place = nearest_place(axis, m_axes.segment_of_point[i], m_scan.points[i]);
        const bool is_inside = place.share >= 0 && place.share <= 1;
        if (m_station[i] != none && is_inside &&
            radius_at(axis, place) >= m_rules.thickness * m_axes.noise)
          sorted.emplace_back(place.segment, i);
      }
      std::sort(sorted.begin(), sorted.end());
      std::vector<std::size_t> first(axis.size(), 0); // first point of each segment
      for (const auto& entry : sorted)
        ++first[entry.first + 1];
      for (std::size_t s = 1; s < first.size(); ++s)
        first[s] += first[s - 1];
      cut(a, sorted, first, 0, axis.size() - 1);
    }
  }

  /// Halves the segments [`begin`, `end`) while both halves have enough points. With halving,
  /// a single additional point changes few pieces.
  void cut(Index axis,
           const std::vector<std::pair<Index, Index>>& sorted,
           const std::vector<std::size_t>& first,
           std::size_t begin,
           std::size_t end)
  {
    constexpr std::size_t shortest = 2; // number of segments
    std::size_t middle = 0, fewer = 0;  // points of the smaller half
    for (std::size_t k = begin + shortest; k + shortest <= end; ++k) {
      const std::size_t less = std::min(first[k] - first[begin], first[end] - first[k]);
      if (less > fewer) {
        middle = k;
        fewer = less;
      }
    }
    if (fewer >= m_rules.fewest) {
      cut(axis, sorted, first, begin, middle);
      cut(axis, sorted, first, middle, end);
    } else if (first[end] - first[begin] >= m_rules.fewest)
      add_piece(axis, sorted, first, begin, end);
  }

  void add_piece(Index number,
                 const std::vector<std::pair<Index, Index>>& sorted,
                 const std::vector<std::size_t>& first,
                 std::size_t begin,
                 std::size_t end)
  {
    Piece piece;
    piece.axis = number;
    const Axis& axis = m_axes.axes[number].axis;
    const Vec3 a = axis[begin].point, b = axis[end].point;
    piece.radius = axis[(begin + end) / 2].radius;
    piece.half_length = 0.5 * (b - a).norm();
    if (!(piece.half_length > 0) || piece.half_length > m_rules.longest * piece.radius)
      return;
    piece.middle = 0.5 * (a + b);
    piece.along = (b - a).normalized();
    piece.e1 = piece.along.unitOrthogonal();
    piece.e2 = piece.along.cross(piece.e1);
    for (std::size_t k = first[begin]; k < first[end]; ++k)
      piece.points.push_back(sorted[k].second);
    m_pieces.push_back(std::move(piece));
  }

  /// The distance of a point from the surface, and its derivatives with respect to the motion of
  /// the station and to the shape of the piece.
  struct Sight
  {
    double height;
    Motion motion;
    Local wrong;
  };
  Sight sight(const Piece& piece, Index i) const
  {
    const Vec3 p = m_motions[m_station[i]](m_scan.points[i]), from = p - piece.middle;
    const double at = from.dot(piece.along), share = at / piece.half_length;
    const Vec3 across = from - at * piece.along;
    const double distance = across.norm();
    const Vec3 normal = distance > 0 ? Vec3(across / distance) : piece.e1;
    const double x = normal.dot(piece.e1), y = normal.dot(piece.e2), square = share * share;
    Sight s;
    s.height = distance - piece.radius;
    s.motion << normal, p.cross(normal);
    s.wrong << 1, share, x, y, share * x, share * y, square * x, square * y, x * x - y * y,
        2 * x * y;
    return s;
  }

  double weight(const Sight& s, const Local& wrong) const
  {
    const double x = (s.height - s.wrong.dot(wrong)) / (m_rules.largest_error * m_axes.noise);
    return x * x < 1 ? (1 - x * x) * (1 - x * x) / (m_axes.noise * m_axes.noise) : 0;
  }

  /// Returns the prior precisions (inverse variances) of the shape parameters of a piece.
  Local precision(const Piece& piece) const
  {
    const double fit = std::hypot(m_rules.fit * m_axes.noise, m_rules.relative_fit * piece.radius);
    const double oval = m_rules.oval * piece.radius;
    Local result;
    result.setConstant(1 / (fit * fit));
    result.tail<2>().setConstant(1 / (oval * oval));
    return result;
  }

  /// Adds the normal equations of one piece for the motions. Eliminates and solves for the shape
  /// parameters of the piece.
  void add(Piece& piece, Eigen::MatrixXd& matrix, Eigen::VectorXd& right) const
  {
    std::vector<Index> stations; // of the piece
    for (const Index i : piece.points)
      if (std::find(stations.begin(), stations.end(), m_station[i]) == stations.end())
        stations.push_back(m_station[i]);
    const Eigen::Index size = freedom * static_cast<Eigen::Index>(stations.size());
    Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(size, size);
    Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(size, local);
    Local_matrix own = precision(piece).asDiagonal();
    Eigen::VectorXd motion_right = Eigen::VectorXd::Zero(size);
    Local own_right = Local::Zero();
    for (const Index i : piece.points) {
      const Sight s = sight(piece, i);
      const double w = weight(s, piece.wrong);
      const Eigen::Index at =
          freedom * (std::find(stations.begin(), stations.end(), m_station[i]) - stations.begin());
      motions.block<freedom, freedom>(at, at) += w * s.motion * s.motion.transpose();
      mixed.block<freedom, local>(at, 0) += w * s.motion * s.wrong.transpose();
      own += w * s.wrong * s.wrong.transpose();
      motion_right.segment<freedom>(at) += w * s.height * s.motion;
      own_right += w * s.height * s.wrong;
    }
    Local_matrix inverse;
    linear_algebra::solve_symmetric(own, Local_matrix(Local_matrix::Identity()), inverse);
    piece.wrong = inverse * own_right; // for the current motions
    motions -= mixed * inverse * mixed.transpose();
    motion_right -= mixed * piece.wrong;
    for (std::size_t a = 0; a < stations.size(); ++a) {
      const Eigen::Index ra = freedom * static_cast<Eigen::Index>(stations[a]);
      const Eigen::Index la = freedom * static_cast<Eigen::Index>(a);
      right.segment<freedom>(ra) += motion_right.segment<freedom>(la);
      for (std::size_t b = 0; b < stations.size(); ++b)
        matrix.block<freedom, freedom>(ra, freedom * static_cast<Eigen::Index>(stations[b])) +=
            motions.block<freedom, freedom>(la, freedom * static_cast<Eigen::Index>(b));
    }
  }

  /// Estimates the motions from the axes for which `is_used` holds.
  template <class IsUsed>
  Answer motions_by(const IsUsed& is_used)
  {
    m_motions.assign(m_count.size(), Rigid_motion());
    m_used.clear();
    for (std::size_t k = 0; k < m_pieces.size(); ++k)
      if (is_used(m_pieces[k].axis)) {
        m_pieces[k].wrong.setZero();
        m_used.push_back(k);
      }
    Answer answer;
    for (int round = 0; round < m_rules.rounds; ++round)
      answer.matrix = improve();
    keep_middle();
    answer.motions.resize(answer.matrix.rows());
    for (std::size_t s = 0; s < m_motions.size(); ++s)
      answer.motions.template segment<freedom>(freedom * static_cast<Eigen::Index>(s))
          << m_motions[s].shift,
          m_motions[s].turn;
    return answer;
  }

  /// Performs one Gauss-Newton step. Returns the matrix of its normal equations.
  Eigen::MatrixXd improve()
  {
    const Eigen::Index size = freedom * static_cast<Eigen::Index>(m_motions.size());
    constexpr std::size_t number_of_blocks = 16; // independent of the number of threads
    const std::size_t block = m_used.size() / number_of_blocks + 1;
    std::vector<Eigen::MatrixXd> matrices(number_of_blocks, Eigen::MatrixXd::Zero(size, size));
    std::vector<Eigen::VectorXd> rights(number_of_blocks, Eigen::VectorXd::Zero(size));
    pcs::internal::for_each_block<ConcurrencyTag>(
        m_used.size(),
        block,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k)
            add(m_pieces[m_used[k]], matrices[begin / block], rights[begin / block]);
        });
    const double usual = m_rules.motion * m_axes.noise;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size) / (usual * usual);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (std::size_t s = 0; s < m_motions.size(); ++s)
      right.segment<freedom>(freedom * static_cast<Eigen::Index>(s))
          << m_motions[s].shift / (usual * usual),
          m_motions[s].turn / (usual * usual);
    for (std::size_t b = 0; b < number_of_blocks; ++b) {
      matrix += m_trust * matrices[b];
      right += m_trust * rights[b];
    }
    const Eigen::VectorXd step = -matrix.ldlt().solve(right);
    for (std::size_t s = 0; s < m_motions.size(); ++s) {
      const Eigen::Index at = freedom * static_cast<Eigen::Index>(s);
      m_motions[s].shift += step.segment<3>(at);
      m_motions[s].turn += step.segment<3>(at + 3);
    }
    return matrix;
  }

  /// Removes the mean motion of all points, which the data do not determine.
  void keep_middle()
  {
    double total = 0;
    for (const double count : m_count)
      total += count;
    Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();
    for (std::size_t s = 0; s < m_motions.size() && total > 0; ++s) {
      shift += m_count[s] / total * m_motions[s].shift;
      turn += m_count[s] / total * m_motions[s].turn;
    }
    for (Rigid_motion& motion : m_motions) {
      motion.shift -= shift;
      motion.turn -= turn;
    }
  }

  const Scan& m_scan;
  const Axis_set& m_axes;
  const std::vector<Index>& m_station;
  const Station_alignment_options& m_rules;
  double m_trust = 1;          ///< weight of one point
  std::vector<double> m_count; ///< points of each station
  std::vector<Rigid_motion> m_motions;
  std::vector<Piece> m_pieces;
  std::vector<std::size_t> m_used; ///< indices of the used pieces
};

} // namespace internal

/// Estimates the motions that align the points of all stations with the same branches, in
/// coordinates of the scan. Points without an axis are ignored. O(points rounds).
template <class ConcurrencyTag>
Aligned_stations align_stations(const Scan& scan,
                                const Axis_set& axes,
                                const std::vector<Index>& station_of_point,
                                std::size_t number_of_stations,
                                const Station_alignment_options& rules)
{
  return internal::Station_alignment<ConcurrencyTag>(scan,
                                                     axes,
                                                     station_of_point,
                                                     number_of_stations,
                                                     rules)
      .run();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_ALIGN_STATIONS_H
