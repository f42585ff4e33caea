// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A bounding volume hierarchy of triangles, and the first hits of the rays of a beam.

#ifndef PCS_GENERATORS_INTERNAL_RAY_TREE_H
#define PCS_GENERATORS_INTERNAL_RAY_TREE_H

#include <pcs/generators/internal/Ray_lanes.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

using Vector3f = Eigen::Vector3f;

struct Triangle
{
  Vector3f corner, edge_1, edge_2;
};

constexpr std::uint32_t no_triangle = std::numeric_limits<std::uint32_t>::max();

/// Rays from one point in almost the same direction. Directions are unit vectors.
struct Beam
{
  Vector3f origin;
  std::array<Vector3f, number_of_lanes> direction;
};

/// The first hit of each ray of a beam; infinity and `no_triangle` if there is none.
struct Beam_hits
{
  std::array<float, number_of_lanes> range;
  std::array<std::uint32_t, number_of_lanes> triangle;
};

/*
  A bounding volume hierarchy. Boxes are split at the cheapest of 16 positions per axis, according
  to the surface area heuristic (Wald 2007). The four rays of a beam traverse the hierarchy
  together, because they visit nearly the same boxes. If two triangles have the same range, the one
  with the lower number is hit, so the result depends neither on the shape of the hierarchy nor on
  the threads that built it.
*/
class Ray_tree
{
public:
  template <class ConcurrencyTag>
  void build(std::vector<Triangle> triangles)
  {
    m_triangles = std::move(triangles);
    const std::size_t n = m_triangles.size();
    m_nodes.assign(2 * n, Node());
    m_order.resize(n);
    if (n == 0)
      return;
    std::vector<Item> items(n);
    pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
      const Triangle& t = m_triangles[i];
      const Vector3f b = t.corner + t.edge_1, c = t.corner + t.edge_2;
      items[i].low = t.corner.cwiseMin(b).cwiseMin(c);
      items[i].high = t.corner.cwiseMax(b).cwiseMax(c);
      items[i].index = static_cast<std::uint32_t>(i);
    });
    split<ConcurrencyTag>(items, 0, n, 0, 0);
    // the triangles of a leaf are adjacent in memory
    std::vector<Triangle> sorted(n);
    pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
      m_order[i] = items[i].index;
      sorted[i] = m_triangles[items[i].index];
    });
    m_triangles = std::move(sorted);
  }

  Beam_hits first_hits(const Beam& beam) const
  {
    Beam_hits hits;
    hits.range.fill(std::numeric_limits<float>::infinity());
    hits.triangle.fill(no_triangle);
    if (m_triangles.empty())
      return hits;
    Rays rays(beam);
    std::array<std::uint32_t, stack_size> stack;
    std::size_t top = 0;
    std::uint32_t index = 0;
    for (;;) {
      const Node& node = m_nodes[index];
      if (rays.meet(node.low, node.high)) {
        if (node.count == 0) {
          const std::uint32_t right = node.link & index_mask, axis = node.link >> index_bits;
          const std::uint32_t left = index + 1;
          const bool is_forward = rays.first_direction[axis] >= 0;
          stack[top++] = is_forward ? right : left;
          index = is_forward ? left : right;
          continue;
        }
        for (std::uint32_t i = node.link; i < node.link + node.count; ++i)
          rays.hit(m_triangles[i], m_order[i], hits);
      }
      if (top == 0)
        return hits;
      index = stack[--top];
    }
  }

private:
  struct Node
  {
    Vector3f low = Vector3f::Zero(), high = Vector3f::Zero();
    std::uint32_t link =
        0; // leaf: first triangle; otherwise: axis and right child; the left child is the next node
    std::uint32_t count = 0; // number of triangles; 0: not a leaf
  };

  struct Item
  {
    Vector3f low, high;
    std::uint32_t index;
    float center(int axis) const { return low[axis] + high[axis]; } // twice the center
  };

  struct Box
  {
    Vector3f low = Vector3f::Constant(std::numeric_limits<float>::infinity());
    Vector3f high = Vector3f::Constant(-std::numeric_limits<float>::infinity());
    void extend(const Item& item)
    {
      low = low.cwiseMin(item.low);
      high = high.cwiseMax(item.high);
    }
    void extend(const Box& box)
    {
      low = low.cwiseMin(box.low);
      high = high.cwiseMax(box.high);
    }
    float area() const
    {
      const Vector3f d = high - low;
      return d.x() < 0 ? 0 : d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
    }
  };

  /// The rays of a beam, one per lane.
  struct Rays
  {
    explicit Rays(const Beam& beam)
      : origin(beam.origin),
        first_direction(beam.direction[0]),
        best(Ray_lanes::of(std::numeric_limits<float>::infinity()))
    {
      for (int axis = 0; axis < 3; ++axis) {
        float d[number_of_lanes], inverse[number_of_lanes];
        for (std::size_t lane = 0; lane < number_of_lanes; ++lane) {
          d[lane] = beam.direction[lane][axis];
          // prevents 0 * infinity, which is not a number
          const float safe = std::abs(d[lane]) > 1e-18f ? d[lane] : std::copysign(1e-18f, d[lane]);
          inverse[lane] = 1 / safe;
        }
        direction[axis] = Ray_lanes::from(d);
        m_inverse[axis] = Ray_lanes::from(inverse);
      }
    }

    /// Returns whether any ray enters the box before its nearest hit so far.
    bool meet(const Vector3f& low, const Vector3f& high) const
    {
      Ray_lanes enter = Ray_lanes::of(0), leave = best;
      for (int axis = 0; axis < 3; ++axis) {
        const Ray_lanes a = Ray_lanes::of(low[axis] - origin[axis]) * m_inverse[axis];
        const Ray_lanes b = Ray_lanes::of(high[axis] - origin[axis]) * m_inverse[axis];
        enter = max(enter, min(a, b));
        leave = min(leave, max(a, b));
      }
      // flat boxes must be found in spite of rounding
      return mask_of_at_most(enter, leave * Ray_lanes::of(1.000001f)) != 0;
    }

    /// Intersects all rays with a triangle (Möller and Trumbore 1997). Triangles are slightly
    /// enlarged, so that no ray passes between adjacent ones.
    void hit(const Triangle& triangle, std::uint32_t index, Beam_hits& hits)
    {
      constexpr float margin = 1e-5f;
      const Vector3f& e1 = triangle.edge_1;
      const Vector3f& e2 = triangle.edge_2;
      const Vector3f s = origin - triangle.corner;
      const Vector3f q = s.cross(e1);
      const auto lanes = [](float x) { return Ray_lanes::of(x); };
      const Ray_lanes px = direction[1] * lanes(e2.z()) - direction[2] * lanes(e2.y());
      const Ray_lanes py = direction[2] * lanes(e2.x()) - direction[0] * lanes(e2.z());
      const Ray_lanes pz = direction[0] * lanes(e2.y()) - direction[1] * lanes(e2.x());
      const Ray_lanes det = px * lanes(e1.x()) + py * lanes(e1.y()) + pz * lanes(e1.z());
      const Ray_lanes scale = lanes(1) / det; // infinite if the ray is in the plane: no hit
      const Ray_lanes u = (px * lanes(s.x()) + py * lanes(s.y()) + pz * lanes(s.z())) * scale;
      const Ray_lanes v = (direction[0] * lanes(q.x()) + direction[1] * lanes(q.y()) +
                           direction[2] * lanes(q.z())) *
                          scale;
      const Ray_lanes t = lanes(e2.dot(q)) * scale;
      const int mask =
          mask_of_at_most(lanes(-margin), min(u, v)) & mask_of_at_most(u + v, lanes(1 + margin)) &
          mask_of_at_most(lanes(std::numeric_limits<float>::min()), t) & mask_of_at_most(t, best);
      if (mask == 0)
        return;
      float range[number_of_lanes];
      t.to(range);
      for (std::size_t lane = 0; lane < number_of_lanes; ++lane)
        if ((mask >> lane & 1) != 0 &&
            (range[lane] < hits.range[lane] || index < hits.triangle[lane])) {
          hits.range[lane] = range[lane];
          hits.triangle[lane] = index;
        }
      best = Ray_lanes::from(hits.range.data());
    }

    Vector3f origin, first_direction;
    Ray_lanes direction[3];
    Ray_lanes best;

  private:
    Ray_lanes m_inverse[3];
  };

  static constexpr std::size_t leaf_size = 4, number_of_bins = 16, stack_size = 128;
  static constexpr std::size_t deepest_search = 64; // below this depth, nodes are halved
  static constexpr std::uint32_t index_bits = 30, index_mask = (std::uint32_t(1) << index_bits) - 1;

  /// Fills node `index` and its descendants: at most 2 (end - begin) - 1 consecutive nodes.
  template <class ConcurrencyTag>
  void split(std::vector<Item>& items,
             std::size_t begin,
             std::size_t end,
             std::size_t index,
             std::size_t depth)
  {
    Box box, centers;
    for (std::size_t i = begin; i < end; ++i) {
      box.extend(items[i]);
      const Vector3f center = items[i].low + items[i].high;
      centers.low = centers.low.cwiseMin(center);
      centers.high = centers.high.cwiseMax(center);
    }
    Node& node = m_nodes[index];
    node.low = box.low;
    node.high = box.high;
    const std::size_t n = end - begin;
    if (n <= leaf_size) {
      node.link = static_cast<std::uint32_t>(begin);
      node.count = static_cast<std::uint32_t>(n);
      return;
    }
    int axis = 0;
    std::size_t middle = begin + n / 2;
    if (depth >= deepest_search || !partition(items, begin, end, centers, axis, middle)) {
      const Vector3f extent = centers.high - centers.low;
      axis = extent.x() >= extent.y() ? (extent.x() >= extent.z() ? 0 : 2)
                                      : (extent.y() >= extent.z() ? 1 : 2);
      const auto at = [&](std::size_t i) { return items.begin() + std::ptrdiff_t(i); };
      std::nth_element(at(begin), at(middle), at(end), [&](const Item& a, const Item& b) {
        return std::make_pair(a.center(axis), a.index) < std::make_pair(b.center(axis), b.index);
      });
    }
    const std::size_t left = index + 1, right = index + 2 * (middle - begin);
    node.link = static_cast<std::uint32_t>(right) | static_cast<std::uint32_t>(axis) << index_bits;
    const auto do_left = [&] { split<ConcurrencyTag>(items, begin, middle, left, depth + 1); };
    const auto do_right = [&] { split<ConcurrencyTag>(items, middle, end, right, depth + 1); };
    if (n > 8192) {
      pcs::internal::invoke_both<ConcurrencyTag>(do_left, do_right);
    } else {
      do_left();
      do_right();
    }
  }

  /// Finds the cheapest boundary between bins, and partitions the items there. Returns `false` if
  /// there is no boundary.
  static bool partition(std::vector<Item>& items,
                        std::size_t begin,
                        std::size_t end,
                        const Box& centers,
                        int& best_axis,
                        std::size_t& middle)
  {
    float best_cost = std::numeric_limits<float>::infinity();
    std::size_t best_bin = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float low = centers.low[axis], extent = centers.high[axis] - low;
      if (!(extent > 0))
        continue;
      std::array<Box, number_of_bins> boxes;
      std::array<std::size_t, number_of_bins> counts{};
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t b = bin(items[i], axis, low, extent);
        boxes[b].extend(items[i]);
        ++counts[b];
      }
      std::array<float, number_of_bins> right_cost{};
      Box right;
      std::size_t count = 0;
      for (std::size_t b = number_of_bins; b-- > 1;) {
        right.extend(boxes[b]);
        count += counts[b];
        right_cost[b] = right.area() * static_cast<float>(count);
      }
      Box left;
      count = 0;
      for (std::size_t b = 1; b < number_of_bins; ++b) {
        left.extend(boxes[b - 1]);
        count += counts[b - 1];
        const float cost = left.area() * static_cast<float>(count) + right_cost[b];
        if (count > 0 && count < end - begin && cost < best_cost) {
          best_cost = cost;
          best_axis = axis;
          best_bin = b;
        }
      }
    }
    if (best_bin == 0)
      return false;
    const float low = centers.low[best_axis], extent = centers.high[best_axis] - low;
    const auto first = items.begin() + std::ptrdiff_t(begin);
    const auto split_at =
        std::partition(first, items.begin() + std::ptrdiff_t(end), [&](const Item& item) {
          return bin(item, best_axis, low, extent) < best_bin;
        });
    middle = begin + static_cast<std::size_t>(split_at - first);
    return true;
  }

  static std::size_t bin(const Item& item, int axis, float low, float extent)
  {
    const float share = (item.center(axis) - low) / extent;
    return std::min(number_of_bins - 1, static_cast<std::size_t>(share * float(number_of_bins)));
  }

  std::vector<Triangle> m_triangles;  // in the order of the leaves
  std::vector<std::uint32_t> m_order; // their indices in the input
  std::vector<Node> m_nodes;
};

} // namespace internal
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_INTERNAL_RAY_TREE_H
