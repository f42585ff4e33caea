// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Construction, storage and restoration of a shape space.

#ifndef PCS_SHAPE_SPACE_BUILD_SPACE_H
#define PCS_SHAPE_SPACE_BUILD_SPACE_H

#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Orl_report.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/Space_state.h>
#include <pcs/shape_space/model/Build_options.h>

#include <string>

namespace pcs {
namespace shape_space {

/// Finds the correspondences of branches and points of the added trees, and the coordinates of all
/// trees. With `Status::cancelled` the state is as before.
template <class ConcurrencyTag>
Orl_report
build_space(const Build_options& options, pcs::internal::Progress& progress, Space_state& state);

/// Builds a space of two trees from stored correspondences of their branches and points. Throws
/// `Invalid_input`, with a message that begins with `caller`, if these do not fit the trees.
template <class ConcurrencyTag>
Orl_report build_space_from(const Orl_correspondences& stored,
                            const Build_options& options,
                            const std::string& caller,
                            Space_state& state);

/// Returns the correspondences of a space of two trees. \pre the space was built, not restored
template <class ConcurrencyTag>
Orl_correspondences store_correspondences(const Space_state& state);

/// Returns the data of a built space, from which `restore_space()` reconstructs it.
template <class ConcurrencyTag>
Orl_space_data store_space(const Space_state& state);

/// Restores the space of `store_space()`. Throws like `build_space_from()`.
template <class ConcurrencyTag>
Space_state restore_space(const Orl_space_data& stored, const std::string& caller);

} // namespace shape_space
} // namespace pcs

#ifndef PCS_COMPILED_SHAPE_SPACE
#include <pcs/shape_space/build_space_impl.h>
#endif

#endif // PCS_SHAPE_SPACE_BUILD_SPACE_H
