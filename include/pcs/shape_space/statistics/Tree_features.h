// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Feature vectors of trees: the shape of each branch relative to its base.

#ifndef PCS_SHAPE_SPACE_STATISTICS_TREE_FEATURES_H
#define PCS_SHAPE_SPACE_STATISTICS_TREE_FEATURES_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/statistics/Modes_of_variation.h>
#include <pcs/shape_space/statistics/Tangent_space.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  Computes the features of trees in blocks; a tree either has all features of a block, or none.

  `Mode_inner_product::branches`: one block per branch. Its features are the directions of its edges
  in the frame of the parent edge, path lengths from its base to its nodes, radii, and its
  attachment, all in units of length. Sums of squares over edges approximate integrals along the
  branch, whatever its number of edges; directions are weighted by length. Directions of the trunk
  refer to the axes of the input, rotated about the trunk with the tree.

  `Mode_inner_product::metric`: one block, the tangent vector at the mean.
*/
class Tree_features
{
public:
  Tree_features(const Orl_layout& layout,
                const Orl_weights& weights,
                Orl_orientation orientation,
                const Orl_coordinates& mean,
                Mode_inner_product measure)
    : m_layout(&layout),
      m_weights(&weights),
      m_orientation(orientation),
      m_mean(&mean),
      m_measure(measure)
  {
    m_first.push_back(0);
    if (measure == Mode_inner_product::metric)
      m_first.push_back(Tangent_space(layout, mean, weights).dimension());
    else
      for (const Orl_layout::Branch& branch : layout.branches)
        m_first.push_back(m_first.back() + static_cast<Eigen::Index>(5 * branch.number_of_edges) +
                          2);
  }

  std::size_t number_of_blocks() const { return m_first.size() - 1; }
  Eigen::Index first(std::size_t block) const { return m_first[block]; }
  Eigen::Index size(std::size_t block) const { return m_first[block + 1] - m_first[block]; }
  Eigen::Index dimension() const { return m_first.back(); }

  /// Returns the features; they are 0 in blocks that the tree lacks. `has`: per block. [L]
  Eigen::VectorXd operator()(const Orl_coordinates& x, std::vector<char>& has) const
  {
    has.assign(number_of_blocks(), 1);
    if (m_measure == Mode_inner_product::metric)
      return Tangent_space(*m_layout, *m_mean, *m_weights).log(x);
    Orl_geometry geometry;
    build_geometry(*m_layout, x, m_orientation, geometry);
    const std::vector<std::size_t> order = orders_of_branches(*m_layout, x);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(dimension());
    for (std::size_t b = 0; b < m_layout->branches.size(); ++b) {
      has[b] = order[b] != none;
      if (!has[b])
        continue;
      const Orl_layout::Branch& branch = m_layout->branches[b];
      const Quaternion to_base = base_frame(branch, geometry).conjugate();
      const double scale = 1 / std::sqrt(static_cast<double>(branch.number_of_edges));
      double usual = 0, path_length = 0;
      for (std::size_t j = 0; j < branch.number_of_edges; ++j)
        usual += m_mean->length[branch.first_edge + j];
      Eigen::Index k = m_first[b];
      for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges;
           ++e, k += 5) {
        path_length += x.length[e];
        z.segment<3>(k) =
            std::sqrt(m_mean->length[e] * usual) * (to_base * (geometry.frame[e] * Vec3::UnitZ()));
        z[k + 3] = scale * path_length;
        z[k + 4] = scale * x.radius[e];
      }
      z[k] = x.base_radius[b];
      z[k + 1] = m_weights->attachment[b] * x.attachment[b];
    }
    return z;
  }

private:
  Quaternion base_frame(const Orl_layout::Branch& branch, const Orl_geometry& geometry) const
  {
    if (branch.parent != none)
      return geometry.frame[branch.reference_edge];
    const Quaternion& own = geometry.frame[branch.first_edge];
    const Vec3 usual = m_mean->orientation[branch.first_edge] * Vec3::UnitZ();
    return shortest_turn((own * Vec3::UnitZ()).normalized(), usual.normalized()) * own;
  }

  const Orl_layout* m_layout;
  const Orl_weights* m_weights;
  Orl_orientation m_orientation;
  const Orl_coordinates* m_mean;
  Mode_inner_product m_measure;
  std::vector<Eigen::Index> m_first; // of each block, and the number of all
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_TREE_FEATURES_H
