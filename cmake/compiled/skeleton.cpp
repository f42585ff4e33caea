// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compiled once: what of tree skeletons depends on no type of the caller.

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/Resampled_session_impl.h>
#include <pcs/skeleton/Session_impl.h>
#include <pcs/skeleton/forest/Stand_impl.h>

template class pcs::skeleton::Session<CGAL::Sequential_tag>;
template class pcs::skeleton::Resampled_session<CGAL::Sequential_tag>;
template bool pcs::skeleton::find_trees<CGAL::Sequential_tag>(const pcs::skeleton::Read_input&,
                                                              const pcs::skeleton::Session_hints&,
                                                              pcs::internal::Progress&,
                                                              pcs::skeleton::Stand&);
#ifdef CGAL_LINKED_WITH_TBB
template class pcs::skeleton::Session<CGAL::Parallel_tag>;
template class pcs::skeleton::Resampled_session<CGAL::Parallel_tag>;
template bool pcs::skeleton::find_trees<CGAL::Parallel_tag>(const pcs::skeleton::Read_input&,
                                                            const pcs::skeleton::Session_hints&,
                                                            pcs::internal::Progress&,
                                                            pcs::skeleton::Stand&);
#endif
