// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a tree skeleton with branches and sections from a CSV file.

#ifndef PCS_IO_READ_TREE_CSV_H
#define PCS_IO_READ_TREE_CSV_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/Tree_rows.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Tree_skeleton.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

//! the columns of a tree in a CSV file, in the order in which they are written
constexpr std::array<const char*, 11> tree_columns =
    {"id", "parent", "branch", "order", "x", "y", "z", "r", "a", "b", "hits"};
constexpr std::size_t column_hits = 10; // the only optional column

inline std::vector<std::string_view> split_at_commas(std::string_view line)
{
  std::vector<std::string_view> words;
  for (;;) {
    const std::size_t end = line.find(',');
    words.push_back(trim(line.substr(0, end)));
    if (end == std::string_view::npos)
      return words;
    line.remove_prefix(end + 1);
  }
}

//! returns the index in the header of each of `tree_columns`, `npos` for a missing column
inline std::array<std::size_t, 11> find_tree_columns(const Input_file& file,
                                                     std::string_view header)
{
  std::array<std::size_t, 11> index;
  index.fill(npos);
  if (header.substr(0, 3) == "\xEF\xBB\xBF") // byte order mark
    header.remove_prefix(3);
  const std::vector<std::string_view> names = split_at_commas(header);
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::size_t c = 0;
    while (c < tree_columns.size() && names[i] != tree_columns[c])
      ++c;
    if (c == tree_columns.size())
      file.fail_at_line(
          "unknown column " + in_quotes(names[i]) +
          ", expected id,parent,branch,order,x,y,z,r,a,b,hits; a table of cylinders needs the "
          "columns startX, startY, startZ");
    if (index[c] != npos)
      file.fail_at_line("the column " + in_quotes(names[i]) + " is named twice");
    index[c] = i;
  }
  for (std::size_t c = 0; c < tree_columns.size(); ++c)
    if (index[c] == npos && c != column_hits)
      file.fail_at_line(std::string("there is no column '") + tree_columns[c] +
                        "', expected id,parent,branch,order,x,y,z,r,a,b,hits; a table of "
                        "cylinders needs the columns startX, startY, startZ");
  return index;
}

/// The rows of a file: nodes, ids of parents, branches and numbers of points.
template <class Kernel>
struct Node_rows
{
  std::vector<Tree_row> rows;
  std::vector<Tree_node<Kernel>> nodes;
  std::vector<std::pair<std::int64_t, int>> branches; ///< id and order
  std::vector<std::size_t> hits;                      ///< empty without that column
};

/// Reads the value of each column from a line.
class Field_reader
{
public:
  Field_reader(const Input_file& file, std::string_view header)
    : m_file(file),
      m_index(find_tree_columns(file, header)),
      m_number_of_columns(split_at_commas(header).size())
  {
  }

  void set_line(std::string_view line)
  {
    m_words = split_at_commas(line);
    if (m_words.size() != m_number_of_columns)
      m_file.fail_at_line("expected " + std::to_string(m_number_of_columns) + " columns, found " +
                          std::to_string(m_words.size()));
  }

  bool has_hits() const { return m_index[column_hits] != npos; }

  std::int64_t integer(std::size_t c, std::int64_t least) const
  {
    const auto value = required_number<std::int64_t>(m_file, word(c), tree_columns[c]);
    if (value < least)
      m_file.fail_at_line(std::string("'") + tree_columns[c] + "' must not be less than " +
                          std::to_string(least) + ", found " + std::to_string(value));
    return value;
  }
  double number(std::size_t c) const
  {
    return required_number<double>(m_file, word(c), tree_columns[c]);
  }
  double length(std::size_t c) const { return required_length(m_file, word(c), tree_columns[c]); }

private:
  std::string_view word(std::size_t c) const { return m_words[m_index[c]]; }

  const Input_file& m_file;
  std::array<std::size_t, 11> m_index; // position of each of `tree_columns` in a line
  std::size_t m_number_of_columns;
  std::vector<std::string_view> m_words;
};

template <class Kernel>
void add_row(const Field_reader& field, const Input_file& file, Node_rows<Kernel>& result)
{
  using FT = typename Kernel::FT;
  result.rows.push_back({field.integer(0, 0), field.integer(1, no_parent), file.line_number()});
  const std::int64_t order = field.integer(3, 0);
  if (order > std::numeric_limits<int>::max())
    file.fail_at_line("'order' is out of range: " + std::to_string(order));
  result.branches.emplace_back(field.integer(2, 0), static_cast<int>(order));
  const FT x(field.number(4)), y(field.number(5)), z(field.number(6));
  Tree_node<Kernel> node;
  node.point = typename Kernel::Point_3(x, y, z);
  node.radius = FT(field.length(7));
  node.major_radius = FT(field.length(8));
  node.minor_radius = FT(field.length(9));
  node.is_measured = true;
  result.nodes.push_back(node);
  if (field.has_hits())
    result.hits.push_back(static_cast<std::size_t>(field.integer(column_hits, 0)));
}

template <class Kernel>
Node_rows<Kernel> read_node_rows(const std::string& path)
{
  Input_file file(path);
  std::string_view line;
  if (!file.read_line(line))
    throw IO_error(path, "the file is empty, expected the names of the columns");
  Field_reader field(file, line);
  Node_rows<Kernel> result;
  while (file.read_line(line))
    if (!trim(line).empty()) {
      field.set_line(line);
      add_row(field, file, result);
    }
  return result;
}

//! Assigns branches to rows, in the order of the rows, and checks that each is a chain of nodes.
template <class Kernel>
class Branch_rows
{
public:
  Branch_rows(const std::string& path, Tree_skeleton<Kernel>& tree) : m_path(path), m_tree(tree) {}

  //! sets the branch of node `i` of the tree
  void add(std::size_t i, std::int64_t id, int order, std::uint64_t line)
  {
    auto& branches = m_tree[boost::graph_bundle].branches;
    const auto [found, is_new] = m_index.emplace(id, branches.size());
    if (is_new)
      branches.push_back({npos, order, static_cast<std::size_t>(id)});
    else if (branches[found->second].order != order)
      fail(line, "branch " + std::to_string(id) + " has two different orders");
    m_tree[i].branch = found->second;
    m_lines.push_back(line);
  }

  //! checks that branches are chains and finds their parents
  void link()
  {
    auto& branches = m_tree[boost::graph_bundle].branches;
    std::vector<bool> has_base(branches.size(), false);
    for (std::size_t v = 0; v < num_vertices(m_tree); ++v) {
      const std::size_t p = parent_node<Kernel>(v, m_tree), b = m_tree[v].branch;
      std::size_t followers = 0;
      for (const auto e : boost::make_iterator_range(out_edges(v, m_tree)))
        followers += m_tree[target(e, m_tree)].branch == b ? 1 : 0;
      const bool is_base = p == npos || m_tree[p].branch != b;
      if (followers > 1 || (is_base && has_base[b]))
        fail(m_lines[v],
             "the nodes of branch " + std::to_string(branches[b].id) + " are not a chain");
      if (is_base) {
        has_base[b] = true;
        branches[b].parent = p == npos ? npos : m_tree[p].branch;
      }
    }
  }

private:
  [[noreturn]] void fail(std::uint64_t line, const std::string& what) const
  {
    throw IO_error(m_path, "line " + std::to_string(line) + ": " + what);
  }

  std::string m_path;
  Tree_skeleton<Kernel>& m_tree;
  std::unordered_map<std::int64_t, std::size_t> m_index;
  std::vector<std::uint64_t> m_lines;
};

/// Makes a tree from rows; checks that they form a single tree and that its branches are chains.
template <class Kernel>
Tree_skeleton<Kernel> link_rows(const std::string& path, const Node_rows<Kernel>& from)
{
  const Tree_links links(path, from.rows);
  Tree_skeleton<Kernel> result(from.nodes.size());
  Branch_rows<Kernel> branch_rows(path, result);
  for (std::size_t i = 0; i < from.nodes.size(); ++i) {
    result[i] = from.nodes[i];
    if (links.parents()[i] != npos)
      add_edge(links.parents()[i], i, result);
    branch_rows.add(i, from.branches[i].first, from.branches[i].second, from.rows[i].line);
  }
  branch_rows.link();
  result[boost::graph_bundle].root = links.root();
  return result;
}

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief reads a tree skeleton from a CSV file with the columns
         `id,parent,branch,order,x,y,z,r,a,b,hits`.

  The first line names the columns, in any order. The column `hits` is optional. Each other row is
  one node:

  | columns | contents |
  |---|---|
  | `id`, `parent` | id of the node, and of its parent; -1 for the root |
  | `branch`, `order` | id and order of the branch |
  | `x`, `y`, `z` | position [L] |
  | `r`, `a`, `b` | radius, and half axes of the cross-section [L] |
  | `hits` | number of scan points on its surface [count] |

  Nodes are numbered in the order of the rows, branches in the order of their first rows. All radii
  count as measured.

  \tparam Kernel a kernel of CGAL
  \param path name of the file
  \param tree is replaced; unchanged when an exception is thrown
  \param hits is replaced by one number per node, or cleared if the file has no such column
  \param ids is replaced by the id of each node in the file
  \throws pcs::IO_error when the file cannot be read, a column is unknown, missing or named twice, a
          line has another number of columns, a value is not a finite number or out of its range,
          the nodes do not form one tree with one root, or the nodes of a branch are not a chain
  \par Complexity
  Linear in the size of the file.
*/
template <class Kernel>
void read_tree_csv(const std::string& path,
                   Tree_skeleton<Kernel>& tree,
                   std::vector<std::size_t>& hits,
                   std::vector<std::int64_t>& ids)
{
  internal::Node_rows<Kernel> found = internal::read_node_rows<Kernel>(path);
  tree = internal::link_rows(path, found);
  hits.swap(found.hits);
  ids.clear();
  for (const internal::Tree_row& row : found.rows)
    ids.push_back(row.id);
}

//! \ingroup PkgPcsIORef
//! reads a tree as the first overload, without the ids
template <class Kernel>
void read_tree_csv(const std::string& path,
                   Tree_skeleton<Kernel>& tree,
                   std::vector<std::size_t>& hits)
{
  std::vector<std::int64_t> ids;
  read_tree_csv<Kernel>(path, tree, hits, ids);
}

//! \ingroup PkgPcsIORef
//! reads a tree as the first overload, without the ids and the numbers of points
template <class Kernel>
void read_tree_csv(const std::string& path, Tree_skeleton<Kernel>& tree)
{
  std::vector<std::size_t> hits;
  read_tree_csv<Kernel>(path, tree, hits);
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_READ_TREE_CSV_H
