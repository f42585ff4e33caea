// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Exact optimal transport on a sparse list of arcs: integer network simplex.

#ifndef PCS_SHAPE_SPACE_TRANSPORT_TRANSPORT_SIMPLEX_H
#define PCS_SHAPE_SPACE_TRANSPORT_TRANSPORT_SIMPLEX_H

#include <pcs/shape_space/model/Rooted_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace shape_space {

/// A transport over `arcs` from sources to targets; supplies and demands both sum to one.
struct Transport_problem
{
  struct Arc
  {
    std::uint32_t source, target;
    double cost; ///< >= 0
  };
  std::vector<double> supplies, demands; ///< > 0
  std::vector<Arc> arcs;
};

struct Transport_plan
{
  struct Flow
  {
    std::uint32_t arc;
    double mass;
  };
  std::vector<Flow> flows; ///< by arc
  double cost = 0;         ///< sum of mass times cost
  double violation = 0;    ///< sum over sources and targets of the difference from the given mass
  double remaining = 0;    ///< of a partial transport: mass that is not moved, of 1
  std::vector<char> is_unmet;       ///< per source, then per target: whether some mass is not moved
  bool is_complete = false;         ///< all mass that must move has moved, and the method converged
  std::size_t number_of_pivots = 0; ///< of the network simplex
};

/*!
  Primal network simplex with block search. Its trees are strongly feasible, so the method
  terminates. Weights and costs are rounded to integers (units of 2^-50 of the mass and 2^-32 of the
  largest cost), so pivots are exact and the same on every machine. Mass that the arcs cannot take
  moves over an artificial node and is reported. There are at most n + m - 1 flows.
*/
class Transport_simplex
{
public:
  Transport_plan operator()(const Transport_problem& problem)
  {
    read(problem);
    const bool is_optimal = pivot();
    return plan(problem, is_optimal);
  }

private:
  using Int = std::int64_t;

  static std::vector<Int> to_integers(const std::vector<double>& weights)
  {
    constexpr double total = static_cast<double>(Int(1) << 50);
    double sum = 0;
    for (const double w : weights)
      sum += w;
    std::vector<Int> result;
    Int rest = Int(1) << 50;
    std::size_t largest = 0;
    for (const double w : weights) {
      result.push_back(std::max<Int>(1, static_cast<Int>(w / sum * total)));
      rest -= result.back();
      if (result.back() > result[largest])
        largest = result.size() - 1;
    }
    result[largest] += rest; // a few units; the largest has at least 2^50 / n
    return result;
  }

  void read(const Transport_problem& problem)
  {
    m_n = problem.supplies.size();
    m_root = m_n + problem.demands.size();
    double largest = 0;
    for (const Transport_problem::Arc& a : problem.arcs)
      largest = std::max(largest, a.cost);
    m_unit = largest > 0 ? largest / static_cast<double>(Int(1) << 32) : 1;
    m_arcs.clear();
    for (const Transport_problem::Arc& a : problem.arcs)
      m_arcs.push_back({a.source,
                        static_cast<std::uint32_t>(m_n) + a.target,
                        static_cast<Int>(std::llround(a.cost / m_unit))});
    const Int penalty = (static_cast<Int>(m_root) + 1) * (Int(1) << 32);
    std::vector<Int> mass = to_integers(problem.supplies);
    const std::vector<Int> demands = to_integers(problem.demands);
    mass.insert(mass.end(), demands.begin(), demands.end());
    m_nodes.assign(m_root + 1, Node());
    for (std::size_t v = 0; v < m_root; ++v) {
      Node& node = m_nodes[v];
      node.is_up = v < m_n;
      node.flow = mass[v];
      node.cost = penalty;
      node.potential = node.is_up ? -penalty : penalty;
      node.depth = 1;
      link(v, m_root);
    }
  }

  struct Arc
  {
    std::uint32_t from, to;
    Int cost;
  };
  struct Node
  {
    std::size_t parent = none, child = none, next = none, previous = none;
    std::size_t arc = none; ///< to the parent; `none`: artificial
    bool is_up = false;     ///< whether this arc leads to the parent
    Int flow = 0, cost = 0; ///< of this arc
    Int potential = 0;
    std::size_t depth = 0;
  };

  void link(std::size_t v, std::size_t parent)
  {
    Node& node = m_nodes[v];
    node.parent = parent;
    node.previous = none;
    node.next = m_nodes[parent].child;
    if (node.next != none)
      m_nodes[node.next].previous = v;
    m_nodes[parent].child = v;
  }
  void unlink(std::size_t v)
  {
    const Node& node = m_nodes[v];
    if (node.previous != none)
      m_nodes[node.previous].next = node.next;
    else
      m_nodes[node.parent].child = node.next;
    if (node.next != none)
      m_nodes[node.next].previous = node.previous;
  }

  bool pivot()
  {
    const std::size_t number = m_arcs.size();
    const std::size_t block =
        std::max<std::size_t>(10, static_cast<std::size_t>(std::sqrt(static_cast<double>(number))));
    // not reached in practice with strongly feasible trees; a reported failure is better than an
    // endless loop
    const std::size_t most_pivots = 1000 + 50 * (number + m_root);
    std::size_t position = 0;
    for (m_number_of_pivots = 0; m_number_of_pivots < most_pivots; ++m_number_of_pivots) {
      std::size_t entering = none;
      Int least = 0;
      for (std::size_t seen = 0, in_block = 0; seen < number; ++seen) {
        const Arc& a = m_arcs[position];
        const Int reduced = a.cost + m_nodes[a.from].potential - m_nodes[a.to].potential;
        if (reduced < least) {
          least = reduced;
          entering = position;
        }
        position = position + 1 == number ? 0 : position + 1;
        if (++in_block == block) {
          if (entering != none)
            break;
          in_block = 0;
        }
      }
      if (entering == none)
        return true;
      exchange(entering);
    }
    return false;
  }

  /// The arc that leaves the tree, identified by the node below the arc.
  struct Leaving_arc
  {
    std::size_t node;
    bool is_below_source; ///< below the source of the entering arc, and not below its target
    Int flow;             ///< by which the flow around the cycle changes
  };

  void exchange(std::size_t entering)
  {
    const Arc arc = m_arcs[entering];
    const std::size_t join = find_join(arc.from, arc.to);
    const Leaving_arc leaving = find_leaving_arc(arc, join);
    change_flow(arc, join, leaving.flow);
    const Int shift = leaving.is_below_source
                          ? m_nodes[arc.to].potential - arc.cost - m_nodes[arc.from].potential
                          : m_nodes[arc.from].potential + arc.cost - m_nodes[arc.to].potential;
    attach_subtree(entering, leaving);
    update_subtree(leaving.is_below_source ? arc.from : arc.to, shift);
  }

  /// Returns the lowest common ancestor.
  std::size_t find_join(std::size_t u, std::size_t v) const
  {
    while (u != v)
      if (m_nodes[u].depth >= m_nodes[v].depth)
        u = m_nodes[u].parent;
      else
        v = m_nodes[v].parent;
    return u;
  }

  /// Finds the last blocking arc of the cycle from the join over the entering arc back to the join.
  Leaving_arc find_leaving_arc(const Arc& entering, std::size_t join) const
  {
    Leaving_arc result{none, true, std::numeric_limits<Int>::max()};
    for (std::size_t x = entering.from; x != join; x = m_nodes[x].parent)
      if (m_nodes[x].is_up && m_nodes[x].flow < result.flow) {
        result.flow = m_nodes[x].flow;
        result.node = x;
      }
    for (std::size_t x = entering.to; x != join; x = m_nodes[x].parent)
      if (!m_nodes[x].is_up && m_nodes[x].flow <= result.flow) {
        result.flow = m_nodes[x].flow;
        result.node = x;
        result.is_below_source = false;
      }
    return result;
  }

  void change_flow(const Arc& entering, std::size_t join, Int delta)
  {
    for (std::size_t x = entering.from; x != join; x = m_nodes[x].parent)
      m_nodes[x].flow += m_nodes[x].is_up ? -delta : delta;
    for (std::size_t x = entering.to; x != join; x = m_nodes[x].parent)
      m_nodes[x].flow += m_nodes[x].is_up ? delta : -delta;
  }

  /// Attaches the subtree that the leaving arc cuts off to the entering arc. The arcs between the
  /// entering and the leaving arc are reversed.
  void attach_subtree(std::size_t entering, const Leaving_arc& leaving)
  {
    const Arc& arc = m_arcs[entering];
    std::size_t x = leaving.is_below_source ? arc.from : arc.to;
    std::size_t new_parent = leaving.is_below_source ? arc.to : arc.from;
    Node to_parent; // arc of x to its new parent
    to_parent.arc = entering;
    to_parent.is_up = leaving.is_below_source;
    to_parent.flow = leaving.flow;
    to_parent.cost = arc.cost;
    for (;;) {
      const std::size_t old_parent = m_nodes[x].parent;
      const Node old = m_nodes[x];
      unlink(x);
      link(x, new_parent);
      m_nodes[x].arc = to_parent.arc;
      m_nodes[x].is_up = to_parent.is_up;
      m_nodes[x].flow = to_parent.flow;
      m_nodes[x].cost = to_parent.cost;
      if (x == leaving.node)
        return;
      to_parent = old;
      to_parent.is_up = !old.is_up; // it becomes the arc of the old parent
      new_parent = x;
      x = old_parent;
    }
  }

  /// Updates potentials and depths of the subtree of `top`.
  void update_subtree(std::size_t top, Int shift)
  {
    m_stack.assign(1, top);
    while (!m_stack.empty()) {
      const std::size_t y = m_stack.back();
      m_stack.pop_back();
      m_nodes[y].potential += shift;
      m_nodes[y].depth = m_nodes[m_nodes[y].parent].depth + 1;
      for (std::size_t c = m_nodes[y].child; c != none; c = m_nodes[c].next)
        m_stack.push_back(c);
    }
  }

  Transport_plan plan(const Transport_problem& problem, bool is_optimal) const
  {
    constexpr double unit = 1.0 / static_cast<double>(Int(1) << 50);
    Transport_plan result;
    result.is_unmet.assign(m_root, 0);
    result.is_complete = is_optimal;
    result.number_of_pivots = m_number_of_pivots;
    for (std::size_t v = 0; v < m_root; ++v) {
      const Node& node = m_nodes[v];
      if (node.flow == 0)
        continue;
      if (node.arc == none) {
        result.is_unmet[v] = 1;
        result.is_complete = false;
      } else
        result.flows.push_back(
            {static_cast<std::uint32_t>(node.arc), static_cast<double>(node.flow) * unit});
    }
    std::sort(result.flows.begin(), result.flows.end(), [](const auto& a, const auto& b) {
      return a.arc < b.arc;
    });
    std::vector<double> defect(problem.supplies);
    defect.insert(defect.end(), problem.demands.begin(), problem.demands.end());
    for (const Transport_plan::Flow& f : result.flows) {
      const Transport_problem::Arc& a = problem.arcs[f.arc];
      result.cost += f.mass * a.cost;
      defect[a.source] -= f.mass;
      defect[m_n + a.target] -= f.mass;
    }
    for (const double d : defect)
      result.violation += std::abs(d);
    return result;
  }

  std::size_t m_n = 0, m_root = 0, m_number_of_pivots = 0;
  double m_unit = 1;
  std::vector<Arc> m_arcs;
  std::vector<Node> m_nodes;
  std::vector<std::size_t> m_stack;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_TRANSPORT_TRANSPORT_SIMPLEX_H
