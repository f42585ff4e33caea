// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A virtual scan from beginning to end: scene, stations, outliers, thinning, labels.

#ifndef PCS_GENERATORS_INTERNAL_SCAN_SESSION_H
#define PCS_GENERATORS_INTERNAL_SCAN_SESSION_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/generators/Virtual_scan.h>
#include <pcs/generators/Virtual_scanner.h>
#include <pcs/generators/internal/Ray_tree.h>
#include <pcs/generators/internal/Scan_station.h>
#include <pcs/generators/internal/Scene.h>
#include <pcs/generators/internal/normal_vector.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>

#include <CGAL/number_utils.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace internal {

//! extends a branch to its parent node, with the section of the branch
inline void add_base(Scan_wood& wood, std::size_t b, std::size_t carrier)
{
  Scan_node base = wood.nodes[wood.branches[b][0]];
  base.point = wood.nodes[carrier].point;
  wood.nodes.push_back(base);
  wood.added.push_back(static_cast<int>(wood.branches[b][0]));
  wood.branches[b].insert(wood.branches[b].begin(), wood.nodes.size() - 1);
}

//! returns the tree with its root at the origin; checks all numbers
template <class Kernel>
Scan_wood scan_wood(const Tree_skeleton<Kernel>& tree, Eigen::Vector3d& origin)
{
  const auto fail = [](const std::string& what) {
    throw Invalid_input("pcs::scan_tree(): " + what);
  };
  const auto& bundle = tree[boost::graph_bundle];
  const std::size_t n = num_vertices(tree);
  if (n < 2 || bundle.root >= n)
    fail("the tree has no edge, or no root");
  if (n > std::size_t(std::numeric_limits<int>::max()))
    fail("the tree has more nodes than labels can number");
  const auto vector = [](const auto& p) {
    return Eigen::Vector3d(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
  };
  origin = vector(tree[bundle.root].point);
  Scan_wood wood;
  wood.nodes.resize(n);
  double extent = 0;
  for (std::size_t v = 0; v < n; ++v) {
    Scan_node& node = wood.nodes[v];
    node.point = vector(tree[v].point) - origin;
    node.major_axis = vector(tree[v].major_axis);
    node.radius = CGAL::to_double(tree[v].radius);
    node.major_radius = CGAL::to_double(tree[v].major_radius);
    node.minor_radius = CGAL::to_double(tree[v].minor_radius);
    if (!node.point.allFinite() || !node.major_axis.allFinite())
      fail("a coordinate of node " + std::to_string(v) + " is not finite");
    for (const double r : {node.radius, node.major_radius, node.minor_radius})
      if (!(r >= 0) || !std::isfinite(r))
        fail("a radius of node " + std::to_string(v) + " is negative or not finite");
    if (tree[v].branch >= bundle.branches.size())
      fail("the branch of node " + std::to_string(v) + " does not exist");
    extent = std::max({extent, node.point.norm(), node.major_radius});
  }
  // rays are traced in single precision
  if (!(extent > 1e-12 && extent < 1e12))
    fail("the tree must be larger than 1e-12 and smaller than 1e12");
  wood.branches = nodes_by_branch<Kernel>(tree);
  for (std::size_t b = 0; b < wood.branches.size(); ++b) {
    wood.carriers.push_back(
        wood.branches[b].empty() ? npos : parent_node<Kernel>(wood.branches[b][0], tree));
    wood.orders.push_back(bundle.branches[b].order);
    // a base that does not coincide with its parent node is connected to it
    const std::size_t carrier = wood.carriers.back();
    if (carrier != npos && wood.nodes[carrier].point != wood.nodes[wood.branches[b][0]].point)
      add_base(wood, b, carrier);
  }
  return wood;
}

template <class Kernel>
class Scan_session
{
public:
  Scan_session(const Tree_skeleton<Kernel>& tree,
               const Virtual_scanner& scanner,
               std::uint64_t seed)
    : m_scanner(scanner),
      m_seed(seed),
      m_number_of_nodes(num_vertices(tree)),
      m_wood(scan_wood<Kernel>(tree, m_origin))
  {
    place_stations();
    check_stations();
  }

  template <class ConcurrencyTag>
  Scan_report run(Virtual_scan<Kernel>& scan, pcs::internal::Progress& progress)
  {
    Scene scene(m_scanner, m_seed);
    Ray_tree tree;
    for (std::size_t s = 0; s < m_stations.size(); ++s) {
      const double n = static_cast<double>(m_stations.size());
      progress.stage(double(s) / n, double(s + 1) / n);
      if (s == 0 || m_scanner.wind > 0) {
        scene = make_scene(s);
        m_report.seconds.surface += m_watch.lap();
        tree.build<ConcurrencyTag>(scene.triangles);
        m_report.seconds.tree += m_watch.lap();
      }
      m_report.number_of_triangles = scene.triangles.size();
      const Scan_station station(m_scanner, m_seed, s, m_stations[s], scene.triangles);
      if (!scan_from<ConcurrencyTag>(station, tree, scene, s, progress)) {
        m_report.status = Status::cancelled;
        return m_report;
      }
      m_report.seconds.beams += m_watch.lap();
    }
    add_outliers();
    if (m_scanner.voxel_size > 0)
      thin();
    count();
    deliver(scan);
    m_report.seconds.output += m_watch.lap();
    progress.finish();
    return m_report;
  }

private:
  static constexpr double two_pi = 2 * pcs::internal::pi;

  void place_stations()
  {
    for (const auto& p : m_scanner.positions)
      m_stations.push_back(Eigen::Vector3d(p[0], p[1], p[2]) - m_origin);
    if (!m_stations.empty())
      return;
    Random_stream random(m_seed, 30);
    const std::size_t n = m_scanner.number_of_stations;
    const bool is_full = m_scanner.azimuth_range > 0.999 * two_pi;
    for (std::size_t i = 0; i < n; ++i) {
      const double share = (double(i) + (is_full ? 0.0 : 0.5)) / double(n);
      const double step = m_scanner.azimuth_range / double(n);
      const double azimuth = m_scanner.first_azimuth + share * m_scanner.azimuth_range +
                             0.15 * step * random.uniform(-1, 1);
      const double distance =
          m_scanner.distance * (1 + m_scanner.distance_spread * random.uniform(-1, 1));
      m_stations.emplace_back(distance * std::cos(azimuth),
                              distance * std::sin(azimuth),
                              m_scanner.station_height);
    }
  }

  //! throws if a station is inside a trunk, which hides all else
  void check_stations() const
  {
    for (std::size_t s = 0; s < m_stations.size(); ++s)
      for (std::size_t b = 0; b < m_wood.branches.size(); ++b)
        if (m_wood.orders[b] == 0 && is_inside(m_wood.branches[b], m_stations[s]))
          throw Invalid_input("pcs::scan_tree(): station " + std::to_string(s) +
                              " is inside the trunk; `distance` and `positions` are in the unit of "
                              "the tree");
  }

  //! returns whether a point is inside a frustum between consecutive nodes
  bool is_inside(const std::vector<std::size_t>& branch, const Eigen::Vector3d& point) const
  {
    for (std::size_t i = 1; i < branch.size(); ++i) {
      const Scan_node &a = m_wood.nodes[branch[i - 1]], &b = m_wood.nodes[branch[i]];
      const Eigen::Vector3d axis = b.point - a.point;
      const double share = (point - a.point).dot(axis) / std::max(axis.squaredNorm(), 1e-300);
      if (share >= 0 && share <= 1 &&
          (point - a.point - share * axis).norm() < (1 - share) * a.radius + share * b.radius)
        return true;
    }
    return false;
  }

  //! returns the scene at the time of one station; without wind, it is the same for all stations
  Scene make_scene(std::size_t station) const
  {
    Scene scene(m_scanner, m_seed);
    const Scan_wood wood = m_scanner.wind > 0 ? blown(station) : m_wood;
    scene.add_wood(wood);
    if (m_scanner.leaves_per_length > 0)
      scene.add_leaves(wood, label_leaf);
    if (m_scanner.ground_radius > 0)
      scene.add_ground(label_ground);
    for (const Scan_post& post : m_scanner.posts)
      scene.add_post(post, label_post);
    return scene;
  }

  //! displaces branches of order 2 and more about their bases, with their descendants
  Scan_wood blown(std::size_t station) const
  {
    Scan_wood wood = m_wood;
    std::vector<Eigen::Vector3d> shift(wood.nodes.size(), Eigen::Vector3d::Zero());
    std::vector<std::size_t> by_order(wood.branches.size());
    for (std::size_t b = 0; b < by_order.size(); ++b)
      by_order[b] = b;
    std::stable_sort(by_order.begin(), by_order.end(), [&](std::size_t a, std::size_t b) {
      return wood.orders[a] < wood.orders[b];
    });
    for (const std::size_t b : by_order) {
      Random_stream random(m_seed, 31, station, b);
      Eigen::Vector3d sway = normal_vector(random);
      sway.z() *= 0.3;
      sway *= m_scanner.wind * random.uniform(1.0 / 3, 1) / std::max(sway.norm(), 1e-12);
      const std::vector<std::size_t>& branch = wood.branches[b];
      const Eigen::Vector3d base =
          wood.carriers[b] == npos ? Eigen::Vector3d::Zero() : shift[wood.carriers[b]];
      for (std::size_t i = 0; i < branch.size(); ++i) {
        const double share =
            wood.orders[b] >= 2 && branch.size() > 1 ? double(i) / double(branch.size() - 1) : 0.0;
        shift[branch[i]] = base + share * sway;
      }
    }
    for (std::size_t v = 0; v < wood.nodes.size(); ++v)
      wood.nodes[v].point += shift[v];
    return wood;
  }

  //! scans rows in groups, which limits the memory; progress is reported between groups
  template <class ConcurrencyTag>
  bool scan_from(const Scan_station& station,
                 const Ray_tree& tree,
                 const Scene& scene,
                 std::size_t number,
                 pcs::internal::Progress& progress)
  {
    constexpr std::size_t group = 64;
    const std::size_t n = station.number_of_rows();
    for (std::size_t first = 0; first < n; first += group) {
      const std::size_t rows = std::min(group, n - first);
      std::vector<std::vector<Scan_return>> returns(rows);
      pcs::internal::for_each_index<ConcurrencyTag>(
          rows,
          [&](std::size_t i) { station.scan_row(tree, scene, first + i, returns[i]); },
          1);
      for (const std::vector<Scan_return>& row : returns)
        for (const Scan_return& r : row)
          m_returns.push_back({r.point, own_label(r.label), static_cast<int>(number)});
      if (!progress(double(first + rows) / double(n)))
        return false;
    }
    m_report.number_of_beams += n * station.number_of_columns();
    return true;
  }

  //! maps additional base nodes to the first node of their branch
  int own_label(int label) const
  {
    if (label < static_cast<int>(m_number_of_nodes))
      return label;
    return m_wood.added[static_cast<std::size_t>(label) - m_number_of_nodes];
  }

  void add_outliers()
  {
    if (m_returns.empty())
      return;
    Eigen::Vector3d low = m_returns[0].point, high = low;
    for (const Return& r : m_returns) {
      low = low.cwiseMin(r.point);
      high = high.cwiseMax(r.point);
    }
    m_number_of_outliers = static_cast<std::size_t>(
        std::llround(m_scanner.outlier_share * static_cast<double>(m_returns.size())));
    Random_stream random(m_seed, 32);
    for (std::size_t i = 0; i < m_number_of_outliers; ++i) {
      Eigen::Vector3d p;
      for (int axis = 0; axis < 3; ++axis)
        p[axis] = random.uniform(low[axis], high[axis]);
      m_returns.push_back({p, label_ghost, static_cast<int>(random.bits() % m_stations.size())});
    }
  }

  //! keeps in each cube the point nearest to its center, or the first of several
  void thin()
  {
    const double size = m_scanner.voxel_size;
    struct Entry
    {
      std::array<std::int64_t, 3> cell;
      double distance;
      std::size_t index;
      bool operator<(const Entry& o) const
      {
        return std::tie(cell, distance, index) < std::tie(o.cell, o.distance, o.index);
      }
    };
    std::vector<Entry> entries(m_returns.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      Eigen::Vector3d middle;
      for (int axis = 0; axis < 3; ++axis) {
        const double cell = std::floor(m_returns[i].point[axis] / size);
        if (!(std::abs(cell) < 9e15))
          throw Invalid_input("pcs::scan_tree(): `voxel_size` is too small for this tree");
        entries[i].cell[std::size_t(axis)] = static_cast<std::int64_t>(cell);
        middle[axis] = (cell + 0.5) * size;
      }
      entries[i].distance = (m_returns[i].point - middle).squaredNorm();
      entries[i].index = i;
    }
    std::sort(entries.begin(), entries.end());
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < entries.size(); ++i)
      if (i == 0 || entries[i].cell != entries[i - 1].cell)
        kept.push_back(entries[i].index);
    std::sort(kept.begin(), kept.end());
    m_report.number_of_thinned_points = m_returns.size() - kept.size();
    std::size_t outliers = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      outliers += kept[i] >= m_returns.size() - m_number_of_outliers ? 1 : 0;
      m_returns[i] = m_returns[kept[i]];
    }
    m_returns.resize(kept.size());
    m_number_of_outliers = outliers;
  }

  void count()
  {
    m_hits.assign(m_number_of_nodes, 0);
    for (const Return& r : m_returns)
      switch (r.label) {
      case label_ghost:
        ++m_report.number_of_ghosts;
        break;
      case label_ground:
        ++m_report.number_of_ground_points;
        break;
      case label_leaf:
        ++m_report.number_of_leaf_points;
        break;
      case label_post:
        ++m_report.number_of_post_points;
        break;
      default:
        ++m_report.number_of_wood_points;
        ++m_hits[static_cast<std::size_t>(r.label)];
      }
    m_report.number_of_outliers = m_number_of_outliers;
    m_report.number_of_ghosts -= m_number_of_outliers;
    m_report.number_of_points = m_returns.size();
    m_report.number_of_hidden_nodes =
        static_cast<std::size_t>(std::count(m_hits.begin(), m_hits.end(), std::size_t(0)));
    m_report.status = m_returns.empty() ? Status::nothing_to_do : Status::converged;
  }

  void deliver(Virtual_scan<Kernel>& scan)
  {
    using FT = typename Kernel::FT;
    const auto point = [&](const Eigen::Vector3d& local) {
      const Eigen::Vector3d p = local + m_origin;
      return typename Kernel::Point_3(FT(p.x()), FT(p.y()), FT(p.z()));
    };
    Virtual_scan<Kernel> result;
    result.points.reserve(m_returns.size());
    result.node.reserve(m_returns.size());
    result.station.reserve(m_returns.size());
    for (const Return& r : m_returns) {
      result.points.push_back(point(r.point));
      result.node.push_back(r.label);
      result.station.push_back(r.station);
    }
    for (const Eigen::Vector3d& station : m_stations)
      result.stations.push_back(point(station));
    result.hits = std::move(m_hits);
    std::swap(scan, result);
  }

  struct Return
  {
    Eigen::Vector3d point;
    int label, station;
  };

  const Virtual_scanner& m_scanner;
  std::uint64_t m_seed;
  std::size_t m_number_of_nodes;
  Eigen::Vector3d m_origin = Eigen::Vector3d::Zero(); // declared before m_wood, which sets it
  Scan_wood m_wood;
  std::vector<Eigen::Vector3d> m_stations;
  std::vector<Return> m_returns;
  std::vector<std::size_t> m_hits;
  std::size_t m_number_of_outliers = 0;
  Scan_report m_report;
  pcs::internal::Stopwatch m_watch;
};

} // namespace internal
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_INTERNAL_SCAN_SESSION_H
