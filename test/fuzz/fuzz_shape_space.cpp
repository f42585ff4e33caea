// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arbitrary trees have a geodesic with finite nodes, or are refused.

#include "Fuzz_file.h"
#include <pcs/Orl_shape_space.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>

#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

namespace {

Tree tree_of(pcs_fuzz::Bytes& bytes)
{
  const std::size_t count = bytes.count(1, 40);
  Tree tree(count);
  for (std::size_t i = 0; i < count; ++i) {
    auto& node = tree[i];
    const double x = bytes.coordinate(), y = bytes.coordinate(), z = bytes.coordinate();
    node.point = Kernel::Point_3(x, y, z);
    node.radius = bytes.byte() == 255 ? bytes.coordinate() : bytes.between(0, 2);
    if (i > 0)
      add_edge(bytes.count(0, i - 1), i, tree);
  }
  return tree;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  pcs_fuzz::Bytes bytes(data, size);
  const double lambda = bytes.between(-0.5, 1.5);
  const Tree first = tree_of(bytes), second = tree_of(bytes);
  try {
    pcs::Orl_shape_space<Kernel> space;
    const auto a = space.add_skeleton(first), b = space.add_skeleton(second);
    space.build();
    pcs_fuzz::check(std::isfinite(space.distance(a, b)));
    Tree between;
    space.skeleton(space.geodesic(a, b, lambda), between);
    for (const auto v : CGAL::make_range(vertices(between))) {
      const auto& node = between[v];
      pcs_fuzz::check(std::isfinite(node.point.x() + node.point.y() + node.point.z()));
      pcs_fuzz::check(node.radius >= 0 && std::isfinite(node.radius));
    }
  } catch (const pcs::Invalid_input&) {
  }
  return 0;
}
