// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compiled once: what of spaces of trees depends on no type of the caller.

#include <pcs/internal/parallel.h>
#include <pcs/shape_space/Space_engine_impl.h>

template struct pcs::shape_space::Space_engine<CGAL::Sequential_tag>;
#ifdef CGAL_LINKED_WITH_TBB
template struct pcs::shape_space::Space_engine<CGAL::Parallel_tag>;
#endif
