// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compiled once: what of the deformation and the registration of point sets depends on no type of
// the caller.

#include <pcs/deformation/Session_impl.h>
#include <pcs/deformation/upsampling/blend_block_impl.h>
#include <pcs/internal/parallel.h>
#include <pcs/registration/Fit_session_impl.h>

namespace pcs {
namespace deformation {

template Blend_block choose_blend_block<Blend_outputs::positions>();
template Blend_block choose_blend_block<Blend_outputs::normals>();
template Blend_block choose_blend_block<Blend_outputs::gradients>();

template class Session<CGAL::Sequential_tag>;
#ifdef CGAL_LINKED_WITH_TBB
template class Session<CGAL::Parallel_tag>;
#endif

} // namespace deformation

template class registration::Fit_session<CGAL::Sequential_tag>;
#ifdef CGAL_LINKED_WITH_TBB
template class registration::Fit_session<CGAL::Parallel_tag>;
#endif

} // namespace pcs
