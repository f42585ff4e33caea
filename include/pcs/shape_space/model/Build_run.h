// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Arguments that all steps of the construction of a space have in common.

#ifndef PCS_SHAPE_SPACE_MODEL_BUILD_RUN_H
#define PCS_SHAPE_SPACE_MODEL_BUILD_RUN_H

#include <pcs/core/Orl_report.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/model/Build_options.h>

namespace pcs {
namespace shape_space {

/// Arguments of one construction of a space: its steps read the options, and update progress and
/// report.
struct Build_run
{
  const Build_options& options;
  pcs::internal::Progress& progress;
  Orl_report& report;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_BUILD_RUN_H
