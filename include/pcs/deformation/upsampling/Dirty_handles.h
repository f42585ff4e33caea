// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Dirty flags of handles, so that points of unmoved handles remain bitwise unchanged.

#ifndef PCS_DEFORMATION_UPSAMPLING_DIRTY_HANDLES_H
#define PCS_DEFORMATION_UPSAMPLING_DIRTY_HANDLES_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/model/Node_constraints.h>

#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/// Values of `Dirty_handles::find()` for a handle: its points are not written, moved, or written
/// at their positions at rest.
constexpr char points_unwritten = 0, points_moved = 1, points_at_rest = 2;

/// The handles with displaced points.
class Dirty_handles
{
public:
  /*!
    Finds for each handle how its points are written. They are if it moves or has moved before.
    Until `finish()`, all of these handles count as moved, since an output that throws leaves some
    of their points displaced. Allocates nothing if the number of handles is unchanged.

    \param transforms of the handles, in local coordinates; the outside of the region of interest,
           which never moves, comes last if there is one
    \param has_targets `has_targets(handle)`: whether its points have targets, and move therefore
    \param followed handles that displaced points have begun to follow
    \param is_at_rest whether the samples are at rest
  */
  template <class HasTargets>
  const std::vector<char>& find(const std::vector<Similarity>& transforms,
                                const HasTargets& has_targets,
                                bool has_outside,
                                const std::vector<Node_constraint>& followed,
                                bool is_at_rest)
  {
    const std::size_t outside_count = has_outside && !transforms.empty() ? 1 : 0;
    const std::size_t count = transforms.size() - outside_count;
    // Points of a new handle may have been displaced before.
    m_was_moved.resize(count, m_is_displaced ? 1 : 0);
    for (const Node_constraint h : followed)
      if (static_cast<std::size_t>(h) < count && m_is_displaced)
        m_was_moved[static_cast<std::size_t>(h)] = 1;
    m_is_written.assign(transforms.size(), 0);
    for (std::size_t h = 0; h < count; ++h) {
      const bool is_moved = !transforms[h].is_identity() || has_targets(h);
      m_is_written[h] = is_moved         ? points_moved
                        : m_was_moved[h] ? points_at_rest
                                         : points_unwritten;
      m_was_moved[h] = m_was_moved[h] || is_moved ? 1 : 0;
    }
    m_is_displaced = m_is_displaced || !is_at_rest;
    return m_is_written;
  }

  /// Stores which handles are displaced after all points of `find()` were written.
  void finish()
  {
    for (std::size_t h = 0; h < m_was_moved.size(); ++h)
      m_was_moved[h] = m_is_written[h] == points_moved ? 1 : 0;
  }

  /// Marks all handles as moved, because their points may have been displaced by other handles.
  void replace_handles() { m_was_moved.clear(); }

  /// Makes the current shape the rest shape.
  void accept()
  {
    m_was_moved.clear();
    m_is_displaced = false;
  }

private:
  std::vector<char> m_was_moved, m_is_written;
  bool m_is_displaced = false; ///< whether points have been written displaced
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_DIRTY_HANDLES_H
