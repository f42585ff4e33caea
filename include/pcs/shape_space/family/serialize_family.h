// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Serialisation of a family, with checks of numbers that come from a file.

#ifndef PCS_SHAPE_SPACE_FAMILY_SERIALIZE_FAMILY_H
#define PCS_SHAPE_SPACE_FAMILY_SERIALIZE_FAMILY_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/core/errors.h>
#include <pcs/shape_space/family/make_family.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/model/Tree_family.h>
#include <pcs/shape_space/pair/Embedded_pair.h>
#include <pcs/shape_space/pair/serialize_topology.h>
#include <pcs/shape_space/points/Point_instances_impl.h>
#include <pcs/shape_space/points/surface_patches.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

namespace pcs {
namespace shape_space {
namespace internal {

inline Orl_space_data::Tree store(const Orl_coordinates& x)
{
  Orl_space_data::Tree result;
  result.root = to_array(x.root);
  for (const Quaternion& q : x.orientation)
    result.orientation.push_back({q.x(), q.y(), q.z(), q.w()});
  result.length = x.length;
  result.radius = x.radius;
  result.base_radius = x.base_radius;
  result.attachment = x.attachment;
  return result;
}

inline Orl_coordinates restore(const Orl_space_data::Tree& stored)
{
  Orl_coordinates x;
  x.root = to_vector(stored.root);
  for (const auto& q : stored.orientation)
    x.orientation.emplace_back(q[3], q[0], q[1], q[2]);
  x.length = stored.length;
  x.radius = stored.radius;
  x.base_radius = stored.base_radius;
  x.attachment = stored.attachment;
  return x;
}

} // namespace internal

/// Stores everything but points.
inline Orl_space_data store_family(const Tree_family& family)
{
  Orl_space_data result;
  result.orientation = static_cast<int>(family.orientation);
  result.origin = internal::to_array(family.origin);
  for (std::size_t i = 0; i < family.layout.branches.size(); ++i) {
    const Orl_layout::Branch& b = family.layout.branches[i];
    result.branches.push_back({b.parent, b.number_of_edges, b.reference_edge});
    if (!family.confidence.empty())
      result.branches.back().confidence = family.confidence[i];
    for (std::size_t e = b.first_edge + 1; e < b.first_edge + b.number_of_edges; ++e)
      if (family.layout.edge_before[e] + 1 != e)
        result.references.push_back({e, family.layout.edge_before[e]});
  }
  for (std::size_t t = 0; t < family.x.size(); ++t) {
    result.trees.push_back(internal::store(family.x[t]));
    result.trees.back().tip = family.tip[t];
    result.trees.back().has = family.has[t];
  }
  result.reference = internal::store(family.reference);
  const Orl_weights& w = family.weights;
  result.weights = {w.orientation, w.length, w.radius, w.base_radius, w.attachment, w.root};
  const Matching_weights& m = family.matching;
  result.matching = {m.curve,
                     m.position,
                     m.unmatched,
                     m.children,
                     m.inherited_rotation,
                     m.is_rotation_inherited ? 1.0 : 0.0,
                     m.is_published ? 1.0 : 0.0,
                     m.fork_ratio,
                     static_cast<double>(m.number_of_paths),
                     static_cast<double>(m.number_of_trials),
                     m.length,
                     m.rotation,
                     m.half_cost_distance,
                     m.trunk_fork_ratio,
                     m.do_keep_whorls ? 1.0 : 0.0};
  return result;
}

namespace internal {

/// Restores a family part by part and checks every number.
class Family_restorer
{
public:
  Family_restorer(const Orl_space_data& stored, const std::string& caller)
    : m_stored(stored), m_caller(caller)
  {
  }

  Tree_family operator()()
  {
    check(m_stored.orientation >= 0 && m_stored.orientation <= 2, "there is no such orientation");
    m_family.orientation = static_cast<Orl_orientation>(m_stored.orientation);
    m_family.origin = to_vector(m_stored.origin);
    check(is_place(m_family.origin), "the origin is not finite, or beyond 1e100");
    check(!m_stored.branches.empty() && m_stored.trees.size() > 1, "there are not two trees");
    restore_layout();
    restore_trees();
    restore_weights();
    restore_matching();
    find_growth_direction(m_family);
    return std::move(m_family);
  }

private:
  void check(bool is_right, const char* what) const
  {
    if (!is_right)
      throw Invalid_input(m_caller + ": " + what);
  }

  std::size_t number_of_edges() const { return m_family.layout.number_of_edges(); }
  std::size_t number_of_branches() const { return m_family.layout.branches.size(); }

  void restore_layout()
  {
    Orl_layout& layout = m_family.layout;
    for (std::size_t i = 0; i < m_stored.branches.size(); ++i)
      add_branch(i);
    for (const auto& [edge, earlier] : m_stored.references) {
      const auto last = std::upper_bound(
          layout.branches.begin(),
          layout.branches.end(),
          edge,
          [](std::size_t e, const Orl_layout::Branch& b) { return e < b.first_edge; });
      check(edge < number_of_edges() && earlier < edge && earlier >= std::prev(last)->first_edge,
            "an edge refers to one that is not before it on its branch");
      layout.edge_before[edge] = earlier;
    }
    set_parent_edges(layout, m_family.orientation);
  }

  void add_branch(std::size_t i)
  {
    Orl_layout& layout = m_family.layout;
    const Orl_space_data::Branch& b = m_stored.branches[i];
    Orl_layout::Branch branch;
    branch.parent = b.parent;
    branch.first_edge = layout.number_of_edges();
    branch.number_of_edges = b.number_of_edges;
    branch.reference_edge = b.reference_edge;
    check(i == 0 ? b.parent == none && b.reference_edge == none : b.parent < i,
          "a branch comes before its parent");
    check(b.number_of_edges > 0, "a branch has no edge");
    // before memory is needed for them
    check(b.number_of_edges <= m_stored.reference.length.size() &&
              branch.first_edge <= m_stored.reference.length.size() - b.number_of_edges,
          "the branches have more edges than the reference");
    if (i > 0) {
      const Orl_layout::Branch& parent = layout.branches[b.parent];
      check(b.reference_edge >= parent.first_edge &&
                b.reference_edge < parent.first_edge + parent.number_of_edges,
            "a branch refers to an edge that is not of its parent");
    }
    for (std::size_t j = 0; j < branch.number_of_edges; ++j)
      layout.edge_before.push_back(j == 0 ? branch.reference_edge : branch.first_edge + j - 1);
    layout.branches.push_back(branch);
    check(!(b.confidence < 0 || b.confidence > 1), "a confidence is not between 0 and 1");
    m_family.confidence.push_back(b.confidence);
  }

  void check_tree(const Orl_space_data::Tree& t) const
  {
    const std::size_t n = number_of_edges(), m = number_of_branches();
    check(t.orientation.size() == n && t.length.size() == n && t.radius.size() == n &&
              t.base_radius.size() == m && t.attachment.size() == m,
          "a tree has another number of edges or branches than the topology");
    check(is_place(to_vector(t.root)), "a root is not finite, or beyond 1e100");
    for (const auto& q : t.orientation)
      check(std::abs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1) < 1e-6,
            "an orientation is not of unit length");
    for (const auto* values : {&t.length, &t.radius, &t.base_radius, &t.attachment})
      for (const double v : *values)
        check(is_length(v), "a length, radius or attachment is not from 0 to 1e100");
    const std::vector<Orl_layout::Branch>& branches = m_family.layout.branches;
    for (std::size_t b = 1; b < m; ++b)
      check(t.attachment[b] <= static_cast<double>(branches[branches[b].parent].number_of_edges),
            "a branch is attached beyond its parent");
  }

  void restore_trees()
  {
    const std::size_t m = number_of_branches();
    for (const Orl_space_data::Tree& t : m_stored.trees) {
      check_tree(t);
      check(t.tip.size() == m && t.has.size() == m && t.has[0], "a tree has no trunk");
      for (std::size_t b = 1; b < m; ++b)
        check(!t.has[b] || t.has[m_stored.branches[b].parent],
              "a tree has a branch without its parent");
      m_family.x.push_back(restore(t));
      m_family.has.push_back(t.has);
      m_family.tip.push_back(t.tip);
    }
    check_tree(m_stored.reference);
    m_family.reference = restore(m_stored.reference);
  }

  void restore_weights()
  {
    const std::size_t n = number_of_edges(), m = number_of_branches();
    const Orl_space_data::Weights& w = m_stored.weights;
    check(w.orientation.size() == n && w.length.size() == n && w.radius.size() == n &&
              w.base_radius.size() == m && w.attachment.size() == m && is_length(w.root),
          "the weights do not fit the topology");
    for (const auto* values : {&w.orientation, &w.length, &w.radius, &w.base_radius, &w.attachment})
      for (const double v : *values)
        check(is_length(v), "a weight is not from 0 to 1e100");
    m_family.weights = {w.orientation, w.length, w.radius, w.base_radius, w.attachment, w.root};
  }

  void restore_matching()
  {
    const auto& stored = m_stored.matching;
    for (const double v : stored)
      check(is_length(v), "a weight of the matching is not from 0 to 1e100");
    for (const std::size_t i : {8u, 9u})
      check(stored[i] >= 1 && stored[i] <= 1e15, "a number of paths or trials is out of range");
    Matching_weights& weights = m_family.matching;
    weights.curve = stored[0];
    weights.position = stored[1];
    weights.unmatched = stored[2];
    weights.children = stored[3];
    weights.inherited_rotation = stored[4];
    weights.is_rotation_inherited = stored[5] != 0;
    weights.is_published = stored[6] != 0;
    weights.fork_ratio = stored[7];
    weights.number_of_paths = static_cast<std::size_t>(stored[8]);
    weights.number_of_trials = static_cast<std::size_t>(stored[9]);
    weights.length = stored[10];
    weights.rotation = stored[11];
    weights.half_cost_distance = stored[12];
    weights.trunk_fork_ratio = stored[13];
    weights.do_keep_whorls = stored[14] != 0;
  }

  const Orl_space_data& m_stored;
  const std::string& m_caller;
  Tree_family m_family;
};

} // namespace internal

/// Throws `pcs::Invalid_input` with a message that begins with `caller` unless the numbers are
/// consistent.
inline Tree_family restore_family(const Orl_space_data& stored, const std::string& caller)
{
  return internal::Family_restorer(stored, caller)();
}

inline std::vector<Vec3> points_of_stored(const std::vector<std::array<double, 3>>& stored,
                                          const std::string& caller)
{
  std::vector<Vec3> result;
  for (const auto& p : stored) {
    result.push_back(internal::to_vector(p));
    if (!is_place(result.back()))
      throw Invalid_input(caller + ": a point or normal is not finite, or beyond 1e100");
  }
  return result;
}

/// Restores points and pairs of a space of two trees; returns the scans, without trees.
template <class ConcurrencyTag>
std::vector<Tree_input> restore_pair(const Orl_space_data& stored,
                                     const Tree_family& family,
                                     const std::string& caller,
                                     Embedded_pair& pair)
{
  Orl_correspondences pairs;
  pairs.pairs = stored.pairs;
  check_pairs(pairs,
              family.layout.number_of_edges(),
              {stored.trees[0].point.size(), stored.trees[1].point.size()},
              caller);
  std::vector<Tree_input> inputs(2);
  std::array<std::vector<Vec3>, 2> points, normals;
  for (std::size_t t = 0; t < 2; ++t) {
    Tree_input& input = inputs[t];
    input.tree.origin = family.origin;
    input.points = points[t] = points_of_stored(stored.trees[t].point, caller);
    input.normals = normals[t] = points_of_stored(stored.trees[t].normal, caller);
    if (!input.normals.empty() && input.normals.size() != input.points.size())
      throw Invalid_input(caller + ": a tree has more points than normals, or less");
    pair.x[t] = family.x[t];
    build_geometry(family.layout, pair.x[t], family.orientation, pair.geometry[t]);
  }
  pair.layout = family.layout;
  pair.is_relative =
      edges_with_radius(family.layout, pair.geometry, [&](std::size_t t, std::size_t b) {
        return family.has[t][b] != 0;
      });
  pair.instances.set(pair.layout,
                     pair.geometry,
                     points,
                     normals,
                     pair.is_relative,
                     stored.pairs,
                     ConcurrencyTag());
  return inputs;
}

inline void check_family_points(const Orl_space_data& stored,
                                std::size_t number_of_edges,
                                const std::string& caller)
{
  std::vector<std::size_t> branch_of;
  for (std::size_t b = 0; b < stored.branches.size(); ++b)
    branch_of.insert(branch_of.end(), stored.branches[b].number_of_edges, b);
  std::uint32_t last = 0, tree = 0;
  for (const Orl_space_data::Point& p : stored.points) {
    const bool is_right =
        p.edge >= last && p.edge < number_of_edges && p.tree < stored.trees.size() &&
        stored.trees[p.tree].has[branch_of[p.edge]] &&
        (&p == stored.points.data() || p.edge != last || p.tree == tree) &&
        is_place(internal::to_vector(p.position)) && is_place(internal::to_vector(p.normal));
    if (!is_right)
      throw Invalid_input(caller + ": a point is not finite, on no edge, or out of order");
    last = p.edge;
    tree = p.tree;
  }
  const Orl_space_data::Partner* before = nullptr;
  for (const Orl_space_data::Partner& p : stored.partners) {
    const bool is_right = p.point < stored.points.size() && p.tree < stored.trees.size() &&
                          p.tree != stored.points[p.point].tree &&
                          stored.trees[p.tree].has[branch_of[stored.points[p.point].edge]] &&
                          (!before || before->point < p.point ||
                           (before->point == p.point && before->tree < p.tree)) &&
                          is_place(internal::to_vector(p.position)) &&
                          is_place(internal::to_vector(p.normal));
    if (!is_right)
      throw Invalid_input(caller +
                          ": a partner of a point is not finite, of no scan, or out of order");
    before = &p;
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_SERIALIZE_FAMILY_H
