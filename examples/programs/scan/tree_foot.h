// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Foot of a tree as a comment of its file; segment_trees writes it, extract_tree_skeleton reads it.

#ifndef PCS_EXAMPLES_TREE_FOOT_H
#define PCS_EXAMPLES_TREE_FOOT_H

#include <pcs/IO/points/Point_table.h>

#include <CGAL/Bbox_3.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <locale>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace program {

/// Beginning of the comment. Three coordinates follow, in the frame of the file.
inline const std::string& foot_keyword()
{
  static const std::string keyword = "foot of the tree: ";
  return keyword;
}

/// Replaces the foot in the comments of a table.
inline void write_foot(const std::array<double, 3>& foot, pcs::IO::Point_table& table)
{
  std::vector<std::string>& comments = table.comments();
  comments.erase(std::remove_if(comments.begin(),
                                comments.end(),
                                [](const std::string& c) {
                                  return c.compare(0, foot_keyword().size(), foot_keyword()) == 0;
                                }),
                 comments.end());
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  text << foot_keyword() << foot[0] << ' ' << foot[1] << ' ' << foot[2];
  comments.push_back(text.str());
}

/// Returns the foot in the comments of a table, unless it lies outside the bounding box of the
/// points (with a margin of 5 % of its sides). This occurs if the points were moved afterwards.
inline std::optional<std::array<double, 3>> read_foot(const pcs::IO::Point_table& table)
{
  CGAL::Bbox_3 box;
  for (const auto& p : table.points())
    box += p.bbox();
  for (const std::string& comment : table.schema().comments) {
    if (comment.compare(0, foot_keyword().size(), foot_keyword()) != 0)
      continue;
    std::istringstream text(comment.substr(foot_keyword().size()));
    text.imbue(std::locale::classic());
    std::array<double, 3> foot{};
    bool is_inside = bool(text >> foot[0] >> foot[1] >> foot[2]);
    for (int k = 0; k < 3 && is_inside; ++k) {
      const double margin = 0.05 * (box.max(k) - box.min(k)), x = foot[std::size_t(k)];
      is_inside = x >= box.min(k) - margin && x <= box.max(k) + margin;
    }
    if (is_inside)
      return foot;
  }
  return std::nullopt;
}

} // namespace program

#endif // PCS_EXAMPLES_TREE_FOOT_H
