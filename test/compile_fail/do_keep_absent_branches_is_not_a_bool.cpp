// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `do_keep_absent_branches` must be a bool.

#include <pcs/Orl_shape_space.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = pcs::Orl_metric;
#else
using Option = bool;
#endif

void compile(const Space& space,
             const pcs::Orl_tree& tree,
             pcs::Tree_skeleton<CGAL::Simple_cartesian<double>>& result,
             const Option& value)
{
  space.skeleton(tree, result, pcs::parameters::do_keep_absent_branches(value));
}
