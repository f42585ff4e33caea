// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `point_path` is a value of an enumeration.

#include <pcs/Orl_shape_space.h>

#include <vector>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = pcs::Point_path;
#endif

using Points = std::vector<Space::Point_3>;

void compile(const Space& space, const pcs::Orl_tree& tree, Points& result, const Option& value)
{
  space.points(tree, result, pcs::parameters::point_path(value));
}
