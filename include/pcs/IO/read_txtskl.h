// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a tree skeleton from a file in which the branches are sorted by order.

#ifndef PCS_IO_READ_TXTSKL_H
#define PCS_IO_READ_TXTSKL_H

#include <pcs/IO/internal/Word_reader.h>
#include <pcs/core/Tree_skeleton.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {

namespace internal {

/// Reads the layers of a `.txtskl` file.
template <class Kernel>
class Layer_reader
{
public:
  explicit Layer_reader(const std::string& path) : m_file(path) {}

  Tree_skeleton<Kernel> operator()()
  {
    const std::size_t number_of_layers = m_file.count("the number of layers");
    if (number_of_layers == 0)
      m_file.fail("expected at least 1 layer, found 0");
    for (std::size_t l = 0; l < number_of_layers; ++l)
      read_layer(l);
    if (!m_file.is_at_end())
      m_file.fail("expected the end of the file after " + std::to_string(number_of_layers) +
                  " layers");
    return std::move(m_tree);
  }

private:
  /// Branches of a layer.
  struct Layer
  {
    std::vector<std::vector<std::size_t>> nodes; ///< of each branch
    std::vector<std::size_t> ids;                ///< index of each branch in the tree
  };

  void read_layer(std::size_t l)
  {
    m_file.expect("Layer");
    const std::size_t index = m_file.count("the index of the layer");
    if (l == 0 && index <= 1)
      m_first_index = index;
    if (index != m_first_index + l)
      m_file.fail("expected 'Layer " + std::to_string(m_first_index + l) + "', found 'Layer " +
                  std::to_string(index) + "'");
    const std::size_t number_of_branches = m_file.count("the number of branches");
    if (l == 0 && number_of_branches != 1)
      m_file.fail("expected 1 branch in the first layer, found " +
                  std::to_string(number_of_branches));
    Layer layer;
    for (std::size_t b = 0; b < number_of_branches; ++b)
      read_branch(l, layer);
    m_above = std::move(layer);
  }

  void read_branch(std::size_t l, Layer& layer)
  {
    const auto father = m_file.number<std::int64_t>("the index of the parent branch");
    const auto point = m_file.number<std::int64_t>("the index of the parent point");
    const bool is_root = l == 0;
    if (is_root ? father != -1 || point != -1 : !has_father(father, point))
      m_file.fail("there is no parent " + std::to_string(father) + " " + std::to_string(point) +
                  " in the previous layer");
    const std::size_t n = m_file.count("the number of points");
    if (n == 0)
      m_file.fail("a branch has no points");
    std::size_t previous = npos, parent = npos;
    if (!is_root) {
      parent = m_above.ids[static_cast<std::size_t>(father)];
      previous = m_above.nodes[static_cast<std::size_t>(father)][static_cast<std::size_t>(point)];
    }
    std::vector<Tree_branch>& branches = m_tree[boost::graph_bundle].branches;
    branches.push_back({parent, static_cast<int>(l), branches.size()});
    layer.nodes.emplace_back();
    layer.ids.push_back(branches.size() - 1);
    for (std::size_t i = 0; i < n; ++i) {
      previous = read_node(layer.ids.back(), previous);
      layer.nodes.back().push_back(previous);
    }
  }

  bool has_father(std::int64_t father, std::int64_t point) const
  {
    return father >= 0 && static_cast<std::size_t>(father) < m_above.nodes.size() && point >= 0 &&
           static_cast<std::size_t>(point) < m_above.nodes[static_cast<std::size_t>(father)].size();
  }

  /// Adds a child of node `previous`, or the root if `previous` is `npos`. Returns the index of the
  /// new node.
  std::size_t read_node(std::size_t branch, std::size_t previous)
  {
    using FT = typename Kernel::FT;
    std::array<double, 4> v{};
    for (double& value : v)
      value = m_file.real("coordinate or radius");
    if (v[3] < 0)
      m_file.fail("a radius is negative");
    Tree_node<Kernel> node;
    node.point = typename Kernel::Point_3(FT(v[0]), FT(v[1]), FT(v[2]));
    node.radius = node.major_radius = node.minor_radius = FT(v[3]);
    node.branch = branch;
    const std::size_t id = add_vertex(node, m_tree);
    if (previous != npos)
      add_edge(previous, id, m_tree);
    else
      m_tree[boost::graph_bundle].root = id;
    return id;
  }

  Word_reader m_file;
  Tree_skeleton<Kernel> m_tree;
  Layer m_above;
  std::size_t m_first_index = 0; ///< 0 or 1
};

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief reads a tree skeleton from a `.txtskl` file.

  The first line is the number of layers. A layer contains the branches of one order. It begins with
  a line `Layer <index>`, counted from 0 or 1, and the number of its branches. Each branch has a
  line `<parent branch> <parent point>`, the number of its points, and one line `x y z radius` [L]
  per point. Parent branch and parent point are indices in the previous layer, counted from 0. They
  are `-1 -1` for the trunk, the only branch of the first layer.

  Each point becomes a node with a circular cross-section, in the order of the file. The edge to
  the first node of a branch has the length 0 if the file repeats the parent point.

  \tparam Kernel a kernel of CGAL
  \param path name of the file
  \param tree is replaced; unchanged when an exception is thrown
  \throws pcs::IO_error with the line and the expected content, when the file cannot be read, the
          layers are not in order, a value is missing or not a finite number, a radius is negative,
          a branch has no points, or a parent does not exist
  \par Complexity
  Linear in the size of the file.
*/
template <class Kernel>
void read_txtskl(const std::string& path, Tree_skeleton<Kernel>& tree)
{
  tree = internal::Layer_reader<Kernel>(path)();
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_READ_TXTSKL_H
