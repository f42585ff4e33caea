// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Transformation of many splats, whose attributes are stored by columns as in files.

#ifndef PCS_SPLATS_TRANSFORM_SPLATS_H
#define PCS_SPLATS_TRANSFORM_SPLATS_H

#include <pcs/core/errors.h>
#include <pcs/internal/lanes.h>
#include <pcs/internal/parallel.h>
#include <pcs/splats/Splat_transformation.h>
#include <pcs/splats/rotate_harmonics.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace pcs {
namespace splats {

/*!
  \ingroup PkgPcsDeformationRef
  \brief The attributes of `n` splats: pointers to `n` values each.

  \tparam FT `float` or `double`, or one of them with `const`
*/
template <class FT>
struct Splat_columns
{
  std::array<FT*, 4> rotation = {};  //!< w, x, y, z
  std::array<FT*, 3> log_scale = {}; //!< the third is null if the splats are flat
  std::vector<FT*> harmonics;        //!< `f_rest_0`, ...; see `degree_of_harmonics()`

  //! converts to columns that are only read
  operator Splat_columns<const FT>() const
  {
    Splat_columns<const FT> result;
    std::copy(rotation.begin(), rotation.end(), result.rotation.begin());
    std::copy(log_scale.begin(), log_scale.end(), result.log_scale.begin());
    result.harmonics.assign(harmonics.begin(), harmonics.end());
    return result;
  }
};

namespace internal {

/// The splats of one call. Splats are transformed in groups of `most_splats`, whose colours are
/// copied to the stack: columns of the same size often begin at addresses that a cache cannot hold
/// at the same time.
template <class FT>
class Column_transformation
{
  using Doubles = pcs::internal::Double2;
  static constexpr std::size_t lanes = sizeof(Doubles) / sizeof(double);

public:
  static constexpr std::size_t most_splats = 32; ///< a multiple of the lanes

  Column_transformation(const std::vector<Eigen::Matrix3d>& gradients,
                        const Splat_columns<const FT>& rest,
                        const Splat_columns<FT>& moved)
    : m_gradients(gradients),
      m_rest(rest),
      m_moved(moved),
      m_degree(degree_of_harmonics(rest.harmonics.size()))
  {
  }

  /// Transforms the splats `first` to `end - 1`, at most `most_splats`. Returns how many are not
  /// valid.
  std::size_t operator()(std::size_t first, std::size_t end) const
  {
    Group group;
    std::size_t number_of_invalid = 0;
    for (std::size_t i = first; i < end; ++i)
      if (!transform_shape(i, i - first, group))
        ++number_of_invalid;
    if (group.is_any_turned && m_degree > 0)
      rotate_colors(first, end, group);
    else
      for (std::size_t k = 0; k < m_rest.harmonics.size(); ++k)
        copy(m_rest.harmonics[k], first, end, m_moved.harmonics[k]);
    return number_of_invalid;
  }

private:
  /// The rotations of a group, row by row, and which splats they apply to.
  struct Group
  {
    double rotation[9][most_splats] = {};
    bool is_turned[most_splats] = {}, is_any_turned = false;
  };

  /// Transforms the shape of splat `i`. Returns `false` if it is not valid.
  bool transform_shape(std::size_t i, std::size_t place, Group& group) const
  {
    if (m_gradients[i].allFinite()) {
      const Splat_transformation transformation(m_gradients[i]);
      Splat_shape shape = shape_of(i);
      if (shape.is_valid() && !transformation.is_identity()) {
        transformation.transform(shape);
        store_shape(shape, i);
        for (int k = 0; k < 9; ++k)
          group.rotation[k][place] = transformation.rotation()(k / 3, k % 3);
        group.is_turned[place] = group.is_any_turned = true;
        return true;
      }
      copy_shape(i);
      return shape.is_valid();
    }
    copy_shape(i);
    return false;
  }

  Splat_shape shape_of(std::size_t i) const
  {
    Splat_shape shape;
    const auto& q = m_rest.rotation;
    shape.rotation = Quaternion(static_cast<double>(q[0][i]),
                                static_cast<double>(q[1][i]),
                                static_cast<double>(q[2][i]),
                                static_cast<double>(q[3][i]));
    for (std::size_t k = 0; k < 3; ++k)
      shape.log_scale[static_cast<Eigen::Index>(k)] =
          m_rest.log_scale[k] ? static_cast<double>(m_rest.log_scale[k][i])
                              : -std::numeric_limits<double>::infinity();
    return shape;
  }

  void store_shape(const Splat_shape& shape, std::size_t i) const
  {
    const double q[4] = {shape.rotation.w(),
                         shape.rotation.x(),
                         shape.rotation.y(),
                         shape.rotation.z()};
    for (std::size_t k = 0; k < 4; ++k)
      m_moved.rotation[k][i] = static_cast<FT>(q[k]);
    for (std::size_t k = 0; k < 3; ++k)
      if (m_moved.log_scale[k])
        m_moved.log_scale[k][i] = static_cast<FT>(shape.log_scale[static_cast<Eigen::Index>(k)]);
  }

  void copy_shape(std::size_t i) const
  {
    for (std::size_t k = 0; k < 4; ++k)
      copy(m_rest.rotation[k], i, i + 1, m_moved.rotation[k]);
    for (std::size_t k = 0; k < 3; ++k)
      if (m_moved.log_scale[k])
        copy(m_rest.log_scale[k], i, i + 1, m_moved.log_scale[k]);
  }

  static void copy(const FT* from, std::size_t first, std::size_t end, FT* to)
  {
    if (from != to)
      std::copy(from + first, from + end, to + first);
  }

  void rotate_colors(std::size_t first, std::size_t end, const Group& group) const
  {
    const std::size_t count = m_rest.harmonics.size();
    FT colors[most_coefficients][most_splats] = {};
    for (std::size_t k = 0; k < count; ++k)
      std::copy(m_rest.harmonics[k] + first, m_rest.harmonics[k] + end, colors[k]);
    for (std::size_t place = 0; place < end - first; place += lanes) {
      Doubles rotation[9], in[most_coefficients], out[most_coefficients];
      for (int k = 0; k < 9; ++k)
        pcs::internal::load(group.rotation[k] + place, rotation[k]);
      for (std::size_t k = 0; k < count; ++k)
        for (std::size_t lane = 0; lane < lanes; ++lane)
          in[k][lane] = static_cast<double>(colors[k][place + lane]);
      rotate_bands(rotation, m_degree, in, out);
      for (std::size_t k = 0; k < count; ++k)
        for (std::size_t lane = 0; lane < lanes; ++lane)
          if (group.is_turned[place + lane])
            colors[k][place + lane] = static_cast<FT>(out[k][lane]);
    }
    for (std::size_t k = 0; k < count; ++k)
      std::copy(colors[k], colors[k] + (end - first), m_moved.harmonics[k] + first);
  }

  const std::vector<Eigen::Matrix3d>& m_gradients;
  const Splat_columns<const FT>& m_rest;
  const Splat_columns<FT>& m_moved;
  int m_degree;
};

/// Throws `Invalid_input` unless both columns have the same attributes.
template <class FT>
void check_columns(const Splat_columns<const FT>& rest, const Splat_columns<FT>& moved)
{
  const std::string function = "pcs::splats::transform_splats(): ";
  for (std::size_t k = 0; k < 4; ++k)
    if (!rest.rotation[k] || !moved.rotation[k])
      throw Invalid_input(function + "a column of the rotation is null");
  for (std::size_t k = 0; k < 3; ++k)
    if ((k < 2 && !rest.log_scale[k]) || !rest.log_scale[k] != !moved.log_scale[k])
      throw Invalid_input(function + "a column of the scales is null; only the third may be, in "
                                     "both arguments");
  if (rest.harmonics.size() != moved.harmonics.size())
    throw Invalid_input(function + "there are " + std::to_string(rest.harmonics.size()) +
                        " coefficients of colours at rest and " +
                        std::to_string(moved.harmonics.size()) + " of the result");
  for (std::size_t k = 0; k < rest.harmonics.size(); ++k)
    if (!rest.harmonics[k] || !moved.harmonics[k])
      throw Invalid_input(function + "column " + std::to_string(k) + " of the colours is null");
}

} // namespace internal

/*!
  \ingroup PkgPcsDeformationRef
  \brief transforms the shapes and the colours of splats by the deformation gradients at their
      centres.

  See `Splat_transformation` for the formulas. `Point_set_deformation` writes the gradients to the
  named parameter `gradient_map`. The opacity and the constant part of the colours do not change.
  Splats whose gradient is the identity keep their bits.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
          `CGAL::Parallel_if_available_tag`
  \tparam FT `float` or `double`; the calculation is in double precision
  \param gradients one per splat [-]
  \param rest the splats before the deformation
  \param moved where the result is written; may be the same columns as `rest`
  \return the number of splats that remain as they are because a rotation, a scale or the gradient
          is not a number, or a scale or the gradient is infinite
  \throws Invalid_input if a column is missing, or if no degree from 0 to `largest_degree` has that
          number of coefficients; nothing is changed then
  \par Complexity
  O(n); about a microsecond per splat of degree 3 and thread.
  \par Determinism
  Same bits for every number of threads and for the sequential tag.
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag, class FT>
std::size_t transform_splats(const std::vector<Eigen::Matrix3d>& gradients,
                             const Splat_columns<const FT>& rest,
                             const Splat_columns<FT>& moved)
{
  if (gradients.empty())
    return 0;
  internal::check_columns(rest, moved);
  const internal::Column_transformation<FT> transform(gradients, rest, moved);
  constexpr std::size_t block = 1024, group = internal::Column_transformation<FT>::most_splats;
  const std::size_t n = gradients.size();
  std::vector<std::size_t> number_of_invalid((n + block - 1) / block, 0);
  pcs::internal::for_each_block<ConcurrencyTag>(n, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; i += group)
      number_of_invalid[begin / block] += transform(i, std::min(i + group, end));
  });
  std::size_t sum = 0;
  for (const std::size_t count : number_of_invalid)
    sum += count;
  return sum;
}

//! \ingroup PkgPcsDeformationRef
//! transforms splats in place
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag, class FT>
std::size_t transform_splats(const std::vector<Eigen::Matrix3d>& gradients,
                             const Splat_columns<FT>& splats)
{
  const Splat_columns<const FT> rest = splats;
  return transform_splats<ConcurrencyTag, FT>(gradients, rest, splats);
}

} // namespace splats
} // namespace pcs

#endif // PCS_SPLATS_TRANSFORM_SPLATS_H
