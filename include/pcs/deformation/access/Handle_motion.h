// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Motion of a handle from rest, as the caller composes it.

#ifndef PCS_DEFORMATION_ACCESS_HANDLE_MOTION_H
#define PCS_DEFORMATION_ACCESS_HANDLE_MOTION_H

#include <pcs/core/Similarity.h>

namespace pcs {
namespace deformation {

/// Scale, then rotation, then translation; each can be replaced separately.
struct Handle_motion
{
  Similarity scale, rotation, translation;

  Similarity whole() const { return translation * rotation * scale; }
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ACCESS_HANDLE_MOTION_H
