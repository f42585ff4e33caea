// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The function that interpolates attributes must accept a weight.

#include <pcs/Orl_shape_space.h>

#include <cstddef>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = void (*)(std::size_t);
#else
using Option = void (*)(std::size_t, std::size_t, std::size_t, double);
#endif

void compile(const Space& space, const pcs::Orl_tree& tree, const Option& f)
{
  space.for_each_point(tree, f);
}
