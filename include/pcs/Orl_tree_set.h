// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees of one topology: what they are, how far they are from each other, and what became of their
// branches.

#ifndef PCS_ORL_TREE_SET_H
#define PCS_ORL_TREE_SET_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_tree.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/errors.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/text.h>
#include <pcs/shape_space/Space_engine.h>
#include <pcs/shape_space/family/Tree_family.h>
#include <pcs/shape_space/measures/Tree_descriptors.h>
#include <pcs/shape_space/measures/change_table.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief The trees of an `Orl_shape_space`, as points: distances, figures, changes.

  The base of `Orl_tree_family`; everything here needs a space that was built, and throws
  `pcs::Invalid_input` otherwise.
*/
template <class ConcurrencyTag>
class Orl_tree_set
{
public:
  //! names an added tree
  using Handle = std::size_t;

  //! trees that were added when the space was built [count]
  std::size_t number_of_trees() const { return m_family.x.size(); }

  //! an added tree as a tree of the space
  Orl_tree tree(Handle h) const
  {
    check_handle(h, "tree");
    std::vector<double> share(number_of_trees(), 0);
    share[h] = 1;
    return make(m_family.x[h], h == 1 ? 1 : 0, std::move(share));
  }

  //! whether tree `h` has branch `b` of the topology
  bool has_branch(Handle h, std::size_t b) const
  {
    check_handle(h, "has_branch");
    return b < m_family.has[h].size() && m_family.has[h][b] != 0;
  }

  //! the number of the vertex at the tip of branch `b` in the graph of tree `h`, `npos` if it does
  //! not have it
  std::size_t tip_of_branch(Handle h, std::size_t b) const
  {
    return has_branch(h, b) ? m_family.tip[h][b] : npos;
  }

  /*!
    \brief the distance between two trees of the space.

    \npbegin
      \np{metric} sum of differences as in (4.7), root of their squares, or edges as vectors
        \nptype `Orl_metric`
        \npdefault `sum`
    \npend
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  double distance(const Orl_tree& a,
                  const Orl_tree& b,
                  const NamedParameters& np = NamedParameters()) const
  {
    check_tree(a, "distance");
    check_tree(b, "distance");
    return distance_of(a.m_x, b.m_x, np);
  }
  //! the same between two added trees
  template <class NamedParameters = parameters::Default_named_parameters>
  double distance(Handle a, Handle b, const NamedParameters& np = NamedParameters()) const
  {
    check_handle(a, "distance");
    check_handle(b, "distance");
    return distance_of(m_family.x[a], m_family.x[b], np);
  }

  //! distances of all pairs of added trees, row by row: that of `a` and `b` is at `a *
  //! number_of_trees() + b` [L]
  template <class NamedParameters = parameters::Default_named_parameters>
  std::vector<double> distances(const NamedParameters& np = NamedParameters()) const
  {
    check_family("distances");
    const std::size_t n = number_of_trees();
    std::vector<double> result(n * n, 0);
    pcs::internal::for_each_index<ConcurrencyTag>(
        n,
        [&](std::size_t a) {
          for (std::size_t b = 0; b < a; ++b)
            result[a * n + b] = distance_of(m_family.x[a], m_family.x[b], np);
        },
        1);
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < a; ++b)
        result[b * n + a] = result[a * n + b];
    return result;
  }

  /*!
    \brief what became of each branch from tree `a` to tree `b`: new, lost, longer, thicker, turned.

    \npbegin
      \np{change_limits} when a difference counts
        \nptype `Change_limits`
    \npend
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  std::vector<shape_space::Branch_change>
  changes(Handle a, Handle b, const NamedParameters& np = NamedParameters()) const
  {
    check_handle(a, "changes");
    check_handle(b, "changes");
    const auto limits = pcs::internal::choose(np, pcs::internal_np::change_limits, Change_limits());
    for (const double x : {limits.length, limits.radius, limits.angle})
      if (!(x >= 0))
        throw Invalid_input("pcs::Orl_shape_space::changes(): a limit is " +
                            pcs::internal::to_text(x) + ", expected at least 0");
    return Engine::find_changes(m_family, m_family.x[a], m_family.x[b], limits);
  }

  //! length, height, width, branches and angles of a tree; height is measured along
  //! `growth_direction()`
  shape_space::Tree_descriptors figures(const Orl_tree& t) const
  {
    check_tree(t, "figures");
    return Engine::measure(m_family, t.m_x, t.m_geometry);
  }

  //! unit vector from the roots to the middle of the trees: upwards, if they grow that way
  const shape_space::Vec3& growth_direction() const { return m_family.up; }
  //! the topology, for callers who look inside; \pre it was built
  const shape_space::Orl_layout& layout() const { return m_family.layout; }
  //! weights of the metric; \pre it was built
  const shape_space::Orl_weights& weights() const { return m_family.weights; }

protected:
  using Engine = shape_space::Space_engine<ConcurrencyTag>;

  void check_family(const char* caller) const
  {
    if (m_family.x.empty())
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller +
                          "(): call build() first");
  }
  void check_handle(Handle h, const char* caller) const
  {
    check_family(caller);
    if (h >= number_of_trees())
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller + "(): there is no tree " +
                          std::to_string(h));
  }
  void check_tree(const Orl_tree& t, const char* caller) const
  {
    check_family(caller);
    if (t.m_x.length.size() != m_family.layout.number_of_edges() ||
        t.m_x.attachment.size() != m_family.layout.branches.size() ||
        (!t.m_share.empty() && t.m_share.size() != number_of_trees()))
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller +
                          "(): the tree is of another space");
  }

  /// `lambda` is the share of the second of two trees; negative: as the coordinates tell.
  Orl_tree make(shape_space::Orl_coordinates x,
                double lambda = -1,
                std::vector<double> share = std::vector<double>()) const
  {
    Orl_tree result;
    for (double& s : share) // beyond the inputs there is no detail
      s = std::max(0.0, s);
    if (number_of_trees() > 2)
      result.m_share = std::move(share);
    result.m_x = std::move(x);
    result.m_lambda = lambda >= 0              ? lambda
                      : number_of_trees() == 2 ? Engine::share_of_second(m_family, result.m_x)
                                               : 0;
    Engine::build_geometry(m_family, result.m_x, result.m_geometry);
    for (const shape_space::Vec3& p : result.m_geometry.node)
      if (!p.allFinite())
        throw Invalid_input("pcs::Orl_shape_space: a step, weight or score leads to lengths that "
                            "are no finite numbers");
    m_family.find_offsets(result.m_x, result.m_offset);
    return result;
  }

  /// Shares of scans in a tree between others.
  void mix_shares(const std::vector<const Orl_tree*>& trees,
                  const std::vector<double>& weights,
                  Orl_tree& result) const
  {
    if (number_of_trees() == 2)
      return;
    const auto n = static_cast<double>(number_of_trees());
    result.m_share.assign(number_of_trees(), 0);
    for (std::size_t i = 0; i < trees.size(); ++i) {
      const std::vector<double>& share = trees[i]->m_share;
      double sum = 0;
      for (const double s : share)
        sum += s;
      for (std::size_t h = 0; h < number_of_trees(); ++h)
        result.m_share[h] += weights[i] * (share.empty() ? 1 / n : share[h] / sum);
    }
  }

  shape_space::Tree_family m_family;

private:
  template <class NamedParameters>
  double distance_of(const shape_space::Orl_coordinates& a,
                     const shape_space::Orl_coordinates& b,
                     const NamedParameters& np) const
  {
    return Engine::distance(m_family,
                            a,
                            b,
                            pcs::internal::choose(np, pcs::internal_np::metric, Orl_metric::sum));
  }
};

} // namespace pcs

#endif // PCS_ORL_TREE_SET_H
