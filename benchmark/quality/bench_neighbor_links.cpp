// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ablation of the neighbour links of [Aiteanu 2022, chapter 2.2]: links in one direction, mutual
// links only, and links added in the reverse direction, for different numbers of neighbours.

#include <pcs/core/Similarity.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <support/Table.h>
#include <support/deformation_cases.h>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <quality/irregular_cases.h>
#include <quality/quality_measures.h>
#include <string>
#include <vector>

namespace {

using pcs_bench::Deformation_case;
using pcs_bench::Edges;
using pcs_bench::number;
using pcs_bench::Sampling_kind;
using pcs_bench::Vec3;
using Links = std::vector<std::vector<std::uint32_t>>; ///< per point, sorted

enum class Symmetry { none, by_removal, by_addition };

const char* name_of(Symmetry symmetry)
{
  switch (symmetry) {
  case Symmetry::none:
    return "none";
  case Symmetry::by_removal:
    return "by removal";
  case Symmetry::by_addition:
    return "by addition";
  }
  return "";
}

Links nearest_neighbors(const std::vector<Vec3>& points, std::size_t k)
{
  const pcs::neighborhood::Nearest_neighbors search(points);
  std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> found;
  Links links(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    search(points[i], k + 1, found);
    for (const auto& neighbor : found)
      if (neighbor.index != i && links[i].size() < k)
        links[i].push_back(neighbor.index);
    std::sort(links[i].begin(), links[i].end());
  }
  return links;
}

bool has_link(const Links& links, std::size_t i, std::size_t j)
{
  return std::binary_search(links[i].begin(), links[i].end(), static_cast<std::uint32_t>(j));
}

Links symmetrize(const Links& links, Symmetry symmetry)
{
  Links result = links;
  for (std::size_t i = 0; i < links.size(); ++i)
    for (const auto j : links[i])
      if (symmetry == Symmetry::by_addition && !has_link(links, j, i))
        result[j].push_back(static_cast<std::uint32_t>(i));
      else if (symmetry == Symmetry::by_removal && !has_link(links, j, i))
        result[i].erase(std::find(result[i].begin(), result[i].end(), j));
  for (auto& row : result)
    std::sort(row.begin(), row.end());
  return result;
}

/// The handle of each point, or -1.
std::vector<int> handle_of_points(const Deformation_case& c)
{
  std::vector<int> handle(c.points.size(), -1);
  for (std::size_t h = 0; h < c.handles.size(); ++h)
    for (const auto i : c.handles[h])
      handle[i] = static_cast<int>(h);
  return handle;
}

/// Whether links lead from a point to a handle; the equations of other points have no solution.
std::vector<char> find_reached(const Links& links, const std::vector<int>& handle)
{
  Links reverse(links.size());
  for (std::size_t i = 0; i < links.size(); ++i)
    for (const auto j : links[i])
      reverse[j].push_back(static_cast<std::uint32_t>(i));
  std::vector<char> is_reached(links.size(), 0);
  std::vector<std::uint32_t> stack;
  for (std::size_t i = 0; i < links.size(); ++i)
    if (handle[i] >= 0) {
      is_reached[i] = 1;
      stack.push_back(static_cast<std::uint32_t>(i));
    }
  while (!stack.empty()) {
    const std::uint32_t i = stack.back();
    stack.pop_back();
    for (const auto j : reverse[i])
      if (!is_reached[j]) {
        is_reached[j] = 1;
        stack.push_back(j);
      }
  }
  return is_reached;
}

/*!
  The equations of the published method with weights of 1, for links that need not be symmetric: the
  equation of point `i` has its own links only. Rotation vectors are interpolated harmonically
  between the handles. Each iteration solves for the positions, then fits the rotations.
*/
class Link_deformation
{
public:
  Link_deformation(const Deformation_case& c, const Links& links)
    : m_case(c),
      m_links(links),
      m_handle(handle_of_points(c)),
      m_is_reached(find_reached(links, m_handle)),
      m_row(c.points.size(), -1)
  {
    for (std::size_t i = 0; i < m_row.size(); ++i)
      if (m_handle[i] < 0 && m_is_reached[i])
        m_row[i] = m_number_of_rows++;
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < m_row.size(); ++i)
      if (m_row[i] >= 0) {
        entries.emplace_back(m_row[i], m_row[i], double(links[i].size()));
        for (const auto j : links[i])
          if (m_row[j] >= 0)
            entries.emplace_back(m_row[i], m_row[j], -1);
      }
    Eigen::SparseMatrix<double> matrix(m_number_of_rows, m_number_of_rows);
    matrix.setFromTriplets(entries.begin(), entries.end());
    m_factor.compute(matrix);
  }

  bool is_regular() const { return m_factor.info() == Eigen::Success; }
  std::size_t number_of_unreached_points() const
  {
    return std::size_t(std::count(m_is_reached.begin(), m_is_reached.end(), char(0)));
  }

  std::vector<Vec3> solve(int number_of_iterations)
  {
    std::vector<Vec3> turn(m_row.size(), Vec3::Zero()), position = m_case.points;
    for (std::size_t i = 0; i < m_row.size(); ++i)
      if (m_handle[i] >= 0) {
        const pcs::Similarity& motion = m_case.transforms[std::size_t(m_handle[i])];
        const Eigen::AngleAxisd rotation(motion.rotation());
        turn[i] = rotation.angle() * rotation.axis();
        position[i] = motion(m_case.points[i]);
      }
    solve_rows(turn, [](std::size_t) { return Vec3(Vec3::Zero()); });
    std::vector<Eigen::Matrix3d> rotation;
    for (const Vec3& t : turn)
      rotation.push_back(Eigen::AngleAxisd(t.norm(), t.stableNormalized()).toRotationMatrix());
    const std::vector<Vec3>& rest = m_case.points;
    for (int iteration = 0; iteration < number_of_iterations; ++iteration) {
      if (iteration > 0)
        fit(position, rotation);
      solve_rows(position, [&](std::size_t i) {
        Vec3 sum = Vec3::Zero();
        for (const auto j : m_links[i])
          sum += 0.5 * (rotation[i] + rotation[j]) * (rest[i] - rest[j]);
        return sum;
      });
    }
    return position;
  }

private:
  /// Solves the rows of the free points for `values`, whose entries of handles are given.
  template <class Load>
  void solve_rows(std::vector<Vec3>& values, const Load& load)
  {
    Eigen::MatrixX3d rhs(m_number_of_rows, 3);
    for (std::size_t i = 0; i < m_row.size(); ++i)
      if (m_row[i] >= 0) {
        Vec3 b = load(i);
        for (const auto j : m_links[i])
          if (m_row[j] < 0)
            b += values[j];
        rhs.row(m_row[i]) = b.transpose();
      }
    const Eigen::MatrixX3d solution = m_factor.solve(rhs);
    for (std::size_t i = 0; i < m_row.size(); ++i)
      if (m_row[i] >= 0)
        values[i] = solution.row(m_row[i]).transpose();
  }

  void fit(const std::vector<Vec3>& position, std::vector<Eigen::Matrix3d>& rotation) const
  {
    for (std::size_t i = 0; i < m_row.size(); ++i)
      if (m_row[i] >= 0) {
        Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
        for (const auto j : m_links[i])
          covariance +=
              (position[j] - position[i]) * (m_case.points[j] - m_case.points[i]).transpose();
        rotation[i] = pcs_bench::nearest_rotation(covariance);
      }
  }

  const Deformation_case& m_case;
  const Links& m_links;
  std::vector<int> m_handle;
  std::vector<char> m_is_reached;
  std::vector<int> m_row;
  int m_number_of_rows = 0;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> m_factor;
};

double share_of_one_way_links(const Links& links)
{
  std::size_t all = 0, one_way = 0;
  for (std::size_t i = 0; i < links.size(); ++i)
    for (const auto j : links[i]) {
      ++all;
      one_way += has_link(links, j, i) ? 0 : 1;
    }
  return double(one_way) / double(all);
}

void run_case(pcs_bench::Table& table, const Deformation_case& c, const std::string& sampling)
{
  const Edges edges = pcs_bench::neighbor_edges(c.points);
  for (const std::size_t k : {2u, 3u, 4u, 5u, 6u, 8u, 10u, 15u, 20u}) {
    const Links nearest = nearest_neighbors(c.points, k);
    for (const Symmetry symmetry : {Symmetry::none, Symmetry::by_removal, Symmetry::by_addition}) {
      const Links links = symmetrize(nearest, symmetry);
      Link_deformation deformation(c, links);
      std::vector<std::string> row = {sampling,
                                      std::to_string(k),
                                      name_of(symmetry),
                                      number(100 * share_of_one_way_links(links), 2),
                                      std::to_string(deformation.number_of_unreached_points())};
      for (const int iterations : {1, 3}) {
        if (!deformation.is_regular()) {
          row.insert(row.end(), {"singular", "-", "-"});
          continue;
        }
        const auto m = pcs_bench::measure(c, edges, deformation.solve(iterations));
        row.insert(row.end(),
                   {number(m.rms_edge), number(m.largest_edge), number(100 * m.position_error)});
      }
      table.add(row);
    }
    std::cerr << sampling << ", " << k << " neighbours\n";
  }
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Neighbour links that are not symmetric, or made so by removal or addition.");
  std::string csv;
  app.add_option("--csv", csv, "write the table to this file"); // passed by ./run bench
  CLI11_PARSE(app, argc, argv);
  try {
    pcs_bench::Table table({"sampling",
                            "k",
                            "made symmetric",
                            "links in one direction %",
                            "points without a path to a handle",
                            "RMS edge, 1 iteration",
                            "max edge",
                            "position error % of L",
                            "RMS edge, 3 iterations",
                            "max edge",
                            "position error % of L"});
    Deformation_case bar;
    bar.name = "bar";
    pcs_test::make_box({-.5, -.5, 0}, {1, 1, 6}, 12, 12, 72, bar);
    pcs_test::bend(bar, .3, 6, 120 * pcs_test::pi / 180);
    for (const Sampling_kind kind :
         {Sampling_kind::blue_noise, Sampling_kind::random, Sampling_kind::scan_noise})
      run_case(table, pcs_bench::resample(bar, kind), pcs_bench::name_of(kind));
    table.print(std::cout);
    if (!csv.empty())
      table.write_csv(csv);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
  return 0;
}
