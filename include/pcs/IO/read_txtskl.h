// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a tree skeleton from a file that lists branches layer by layer.

#ifndef PCS_IO_READ_TXTSKL_H
#define PCS_IO_READ_TXTSKL_H

#include <pcs/IO/internal/Word_reader.h>
#include <pcs/core/Tree_skeleton.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {
namespace IO {
/*!
  \ingroup PkgPcsIORef
  \brief reads a tree skeleton from a `.txtskl` file.

  The first line is the number of layers. A layer is a line `Layer <index>`, the number of its
  branches, and for each of these a line `<father branch> <father point>` (counted from 0 in the
  layer above; `-1 -1` for the trunk), the number of points, and one line `x y z radius` per point.
  Every branch keeps its own first node: the edge that leads to it has the length 0 where the file
  repeats the father's point.

  \tparam Kernel a kernel of CGAL
  \param path name of the file
  \param tree is replaced; unchanged when an exception is thrown
  \throws pcs::IO_error naming the line and the expected content
*/
template <class Kernel>
void read_txtskl(const std::string& path, Tree_skeleton<Kernel>& tree)
{
  using FT = typename Kernel::FT;
  internal::Word_reader file(path);
  Tree_skeleton<Kernel> result;
  Tree_bundle& bundle = result[boost::graph_bundle];
  std::vector<std::vector<std::size_t>> above, layer; // nodes of each branch
  std::vector<std::size_t> above_id, layer_id;
  const std::size_t number_of_layers = file.count("the number of layers");
  for (std::size_t l = 0; l < number_of_layers; ++l) {
    file.expect("Layer");
    file.count("the index of the layer");
    const std::size_t number_of_branches = file.count("the number of branches");
    if (l == 0 && number_of_branches != 1)
      file.fail("expected 1 branch in the first layer, found " +
                std::to_string(number_of_branches));
    layer.clear();
    layer_id.clear();
    for (std::size_t b = 0; b < number_of_branches; ++b) {
      const auto father = file.number<std::int64_t>("the number of the father branch");
      const auto point = file.number<std::int64_t>("the number of the father point");
      const bool is_root = l == 0;
      if (is_root ? father != -1 || point != -1
                  : father < 0 || static_cast<std::size_t>(father) >= above.size() || point < 0 ||
                        static_cast<std::size_t>(point) >=
                            above[static_cast<std::size_t>(father)].size())
        file.fail("there is no father " + std::to_string(father) + " " + std::to_string(point) +
                  " in the layer above");
      const std::size_t n = file.count("the number of points");
      if (n == 0)
        file.fail("a branch has no points");
      std::size_t previous =
          is_root ? npos : above[static_cast<std::size_t>(father)][static_cast<std::size_t>(point)];
      bundle.branches.push_back({is_root ? npos : above_id[static_cast<std::size_t>(father)],
                                 static_cast<int>(l),
                                 bundle.branches.size()});
      layer.emplace_back();
      layer_id.push_back(bundle.branches.size() - 1);
      for (std::size_t i = 0; i < n; ++i) {
        std::array<double, 4> v{};
        for (double& value : v)
          value = file.real("coordinate or radius");
        if (v[3] < 0)
          file.fail("a radius is negative");
        Tree_node<Kernel> node;
        node.point = typename Kernel::Point_3(FT(v[0]), FT(v[1]), FT(v[2]));
        node.radius = node.major_radius = node.minor_radius = FT(v[3]);
        node.branch = layer_id.back();
        const std::size_t id = add_vertex(node, result);
        if (previous != npos)
          add_edge(previous, id, result);
        else
          bundle.root = id;
        previous = id;
        layer.back().push_back(id);
      }
    }
    above.swap(layer);
    above_id.swap(layer_id);
  }
  if (!file.is_at_end())
    file.fail("expected the end of the file behind " + std::to_string(number_of_layers) +
              " layers");
  tree = result;
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_READ_TXTSKL_H
