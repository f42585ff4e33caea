// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Converts between a tree and the rows of a file. A row has a node and the id of its parent.

#ifndef PCS_IO_INTERNAL_TREE_ROWS_H
#define PCS_IO_INTERNAL_TREE_ROWS_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>

#include <CGAL/number_utils.h>

#include <boost/graph/graph_traits.hpp>
#include <boost/range/iterator_range.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief Counts of the trees of a skeleton file, of which one is read.
*/
struct Tree_selection
{
  std::size_t number_of_trees = 0;         //!< of the file [count]
  std::size_t number_of_nodes = 0;         //!< nodes or cylinders of all trees [count]
  std::size_t number_of_omitted_nodes = 0; //!< nodes or cylinders of the other trees [count]
};

//! \ingroup PkgPcsIORef
//! returns a warning if trees of the file were left out
inline std::vector<std::string> warnings(const Tree_selection& selection)
{
  if (selection.number_of_trees < 2)
    return {};
  const std::size_t others = selection.number_of_trees - 1;
  return {"the file has " + std::to_string(selection.number_of_trees) +
          " trees: " + std::to_string(selection.number_of_omitted_nodes) + " of " +
          std::to_string(selection.number_of_nodes) + " nodes, in the " +
          (others == 1 ? std::string("other tree") : std::to_string(others) + " other trees") +
          ", were left out (root_number selects a tree, 1: the largest)"};
}

namespace internal {

constexpr std::int64_t no_parent = -1; // parent of the root in the file

struct Tree_row
{
  std::int64_t id = 0, parent = no_parent;
  std::uint64_t line = 0;
};

//! converts a word to a number; errors name the line and the column
template <class T>
T required_number(const Input_file& file, std::string_view word, const char* column)
{
  T value{};
  const Parse_result result = parse_number(word, value);
  if (result == Parse_result::out_of_range)
    file.fail_at_line(std::string("'") + column + "' is out of range: " + in_quotes(word));
  if (result != Parse_result::ok)
    file.fail_at_line(std::string("expected ") +
                      (std::is_integral_v<T> ? "an integer" : "a number") + " as '" + column +
                      "', found " + in_quotes(word));
  if constexpr (std::is_floating_point_v<T>)
    if (!std::isfinite(value))
      file.fail_at_line(std::string("expected a finite number as '") + column + "', found " +
                        in_quotes(word));
  return value;
}

inline double required_length(const Input_file& file, std::string_view word, const char* column)
{
  const auto value = required_number<double>(file, word, column);
  if (value < 0)
    file.fail_at_line(std::string("'") + column + "' must not be negative, found " +
                      in_quotes(word));
  return value;
}

enum class Roots { one, several };

/*
  The indices of the parents of all rows; `npos` for roots. The constructor throws unless every row
  descends from a root.
*/
class Tree_links
{
public:
  Tree_links(std::string path, const std::vector<Tree_row>& rows, Roots roots = Roots::one)
    : m_path(std::move(path))
  {
    if (rows.empty())
      throw IO_error(m_path, "the file has no node, expected at least one");
    std::unordered_map<std::int64_t, std::size_t> index;
    index.reserve(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (const auto [first, is_new] = index.emplace(rows[i].id, i); !is_new)
        fail(rows[i],
             "the id " + std::to_string(rows[i].id) + " is used twice, first in line " +
                 std::to_string(rows[first->second].line) +
                 "; give every node an id of its own, or remove one of the lines");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].parent == no_parent) {
        if (!m_roots.empty() && roots == Roots::one)
          fail(rows[i],
               "a second root; the first one is in line " +
                   std::to_string(rows[m_roots.front()].line) +
                   "; split the file into one file per tree");
        m_roots.push_back(i);
        m_parents.push_back(npos);
        continue;
      }
      const auto parent = index.find(rows[i].parent);
      if (parent == index.end())
        fail(rows[i],
             "there is no node with the id " + std::to_string(rows[i].parent) +
                 ", the parent of this one; a root has the parent -1");
      m_parents.push_back(parent->second);
    }
    if (m_roots.empty())
      throw IO_error(m_path, "no node has the parent -1, expected one root");
    refuse_cycles(rows);
  }

  std::size_t root() const { return m_roots.front(); }
  //! returns the roots in the order of the rows
  const std::vector<std::size_t>& roots() const { return m_roots; }
  const std::vector<std::size_t>& parents() const { return m_parents; }

  /*
    Returns the root of every row. Linear in the number of rows.
  */
  std::vector<std::size_t> root_of_rows() const
  {
    std::vector<std::size_t> root(m_parents.size(), npos), path;
    for (std::size_t i = 0; i < root.size(); ++i) {
      std::size_t v = i;
      for (; root[v] == npos && m_parents[v] != npos; v = m_parents[v])
        path.push_back(v);
      root[v] = root[v] == npos ? v : root[v];
      for (const std::size_t w : path)
        root[w] = root[v];
      path.clear();
    }
    return root;
  }

private:
  [[noreturn]] void fail(const Tree_row& row, const std::string& what) const
  {
    throw IO_error(m_path, "line " + std::to_string(row.line) + ": " + what);
  }

  //! throws if parents form a cycle; follows them from each node to a node that was checked before
  void refuse_cycles(const std::vector<Tree_row>& rows) const
  {
    std::vector<std::size_t> walk_of(rows.size(), npos);
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t v = i; v != npos; v = m_parents[v]) {
        if (walk_of[v] == i)
          fail(rows[v], "the parents of this node form a cycle");
        if (walk_of[v] != npos)
          break;
        walk_of[v] = i;
      }
  }

  std::string m_path;
  std::vector<std::size_t> m_roots, m_parents;
};

/*
  Returns the rows of one tree, in the order of the file. Trees are numbered from 1 by decreasing
  number of rows. Trees of the same size are numbered in the order of their roots.
*/
inline std::vector<std::size_t> rows_of_tree(const std::string& path,
                                             const Tree_links& links,
                                             std::size_t root_number,
                                             Tree_selection& selection)
{
  const std::vector<std::size_t> root_of = links.root_of_rows();
  std::vector<std::size_t> size(root_of.size(), 0), roots = links.roots();
  if (root_number == 0 || root_number > roots.size())
    throw IO_error(path,
                   "there is no tree " + std::to_string(root_number) + ": the file has " +
                       std::to_string(roots.size()) + (roots.size() == 1 ? " tree" : " trees") +
                       ", which are numbered from 1 by decreasing size");
  for (const std::size_t root : root_of)
    ++size[root];
  std::stable_sort(roots.begin(), roots.end(), [&](std::size_t a, std::size_t b) {
    return size[a] > size[b];
  });
  const std::size_t root = roots[root_number - 1];
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < root_of.size(); ++i)
    if (root_of[i] == root)
      rows.push_back(i);
  selection = {roots.size(), root_of.size(), root_of.size() - rows.size()};
  return rows;
}

/*
  Returns the nodes of a graph in the order in which they are written. This is the order of their
  numbers if parents then precede their children, otherwise that of a breadth-first traversal.
*/
template <class Graph>
std::vector<std::size_t> writing_order(const Graph& graph, std::size_t root, const char* caller)
{
  const std::size_t n = num_vertices(graph);
  const auto refuse = [&](const std::string& what) {
    throw Invalid_input(std::string("pcs::IO::") + caller + "(): " + what);
  };
  if (n == 0)
    refuse("the tree has no nodes");
  if (root >= n)
    refuse("the root is not a node of the graph");
  std::vector<std::size_t> parent(n, npos), order = {root};
  parent[root] = root;
  bool is_sorted = root == 0;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (const auto e : boost::make_iterator_range(out_edges(order[i], graph))) {
      const std::size_t v = target(e, graph);
      if (parent[v] != npos)
        refuse("node " + std::to_string(v) + " has two parents or is its own ancestor");
      parent[v] = order[i];
      is_sorted = is_sorted && order[i] < v;
      order.push_back(v);
    }
  if (order.size() != n)
    refuse(std::to_string(n - order.size()) + " nodes cannot be reached from the root");
  if (is_sorted)
    for (std::size_t i = 0; i < n; ++i)
      order[i] = i;
  return order;
}

//! converts `value` to double; throws an error that names the node unless it is finite
template <class FT>
double finite_value(const FT& value, const char* what, std::size_t node, const char* caller)
{
  const double result = CGAL::to_double(value);
  if (!std::isfinite(result))
    throw Invalid_input(std::string("pcs::IO::") + caller + "(): " + what + " of node " +
                        std::to_string(node) + " is not finite");
  return result;
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_TREE_ROWS_H
