// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Named lists of numbers: what the public functions return, for the comparison of runs and builds.

#ifndef PCS_TEST_DETERMINISM_RESULTS_H
#define PCS_TEST_DETERMINISM_RESULTS_H

#include <pcs/core/Tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/tags.h>

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs_test {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using Tree = pcs::Tree_skeleton<Kernel>;

struct Result
{
  std::string name;
  std::vector<double> values;

  /// FNV-1a of the bytes. Every value that is not a number counts as the same.
  std::uint64_t sum() const
  {
    std::uint64_t sum = 14695981039346656037u;
    for (const double given : values) {
      const double value = std::isnan(given) ? std::numeric_limits<double>::quiet_NaN() : given;
      unsigned char bytes[sizeof value];
      std::memcpy(bytes, &value, sizeof value);
      for (const unsigned char byte : bytes)
        sum = (sum ^ byte) * 1099511628211u;
    }
    return sum;
  }
};

/// Collects the values of one result after the other.
class Results
{
public:
  /// begins a result
  Results& operator()(std::string name)
  {
    m_results.push_back({std::move(name), {}});
    return *this;
  }

  template <class T>
  Results& operator<<(const T& value)
  {
    add(value);
    return *this;
  }

  const std::vector<Result>& all() const { return m_results; }

private:
  template <class T, std::enable_if_t<std::is_arithmetic_v<T> || std::is_enum_v<T>, int> = 0>
  void add(T value)
  {
    m_results.back().values.push_back(static_cast<double>(value));
  }

  /// -1 for `pcs::npos`, which would hide the differences of smaller values
  void add(std::size_t value) { add(value == pcs::npos ? -1 : static_cast<double>(value)); }

  template <class K>
  void add(const CGAL::Point_3<K>& p)
  {
    *this << p.x() << p.y() << p.z();
  }

  template <class K>
  void add(const CGAL::Vector_3<K>& p)
  {
    *this << p.x() << p.y() << p.z();
  }

  template <class Derived>
  void add(const Eigen::DenseBase<Derived>& matrix)
  {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      for (Eigen::Index i = 0; i < matrix.rows(); ++i)
        add(static_cast<double>(matrix(i, j)));
  }

  template <class T>
  void add(const std::vector<T>& list)
  {
    for (const auto& value : list)
      add(value);
  }

  void add(const std::vector<bool>& list)
  {
    for (const bool value : list)
      add(value);
  }

  template <class T, std::size_t n>
  void add(const std::array<T, n>& list)
  {
    for (const T& value : list)
      add(value);
  }

  template <class A, class B>
  void add(const std::pair<A, B>& both)
  {
    add(both.first);
    add(both.second);
  }

  void add(const Tree& tree)
  {
    *this << num_vertices(tree) << tree[boost::graph_bundle].root;
    for (std::size_t v = 0; v < num_vertices(tree); ++v) {
      const auto& node = tree[v];
      *this << pcs::parent_node(v, tree) << node.point << node.radius << node.radius_error
            << node.is_measured << node.major_radius << node.minor_radius << node.major_axis
            << node.branch;
    }
    for (const pcs::Tree_branch& branch : tree[boost::graph_bundle].branches)
      *this << branch.parent << branch.order << branch.id;
  }

  std::vector<Result> m_results;
};

/// compare_builds.py defines the macro, because one tag compiles in half the time.
#ifdef PCS_TEST_ONE_TAG
using Sequential = CGAL::Parallel_if_available_tag;
#else
using Sequential = CGAL::Sequential_tag;
#endif

/// Every function is called with the tag `Sequential`, or else with
/// `CGAL::Parallel_if_available_tag`.
void record_deformations(bool is_sequential, Results& results);
void record_skeletons(bool is_sequential, Results& results);
void record_shape_spaces(bool is_sequential, Results& results);
void record_generators(bool is_sequential, Results& results);

/// A small fruit tree with two orders of branches.
Tree small_tree(std::uint64_t seed);

} // namespace pcs_test

#endif // PCS_TEST_DETERMINISM_RESULTS_H
