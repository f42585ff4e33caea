// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes the correspondences of two trees to a file.

#ifndef PCS_IO_WRITE_CORRESPONDENCES_H
#define PCS_IO_WRITE_CORRESPONDENCES_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Orl_correspondences.h>

#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief writes the correspondences of two trees as text; `read_correspondences()` gives them back
      unchanged.

  The file is complete or absent.
  \throws pcs::IO_error when the file cannot be written
*/
inline void write_correspondences(const std::string& path, const Orl_correspondences& c)
{
  internal::Output_file file(path);
  std::string line = "pcs_correspondences 3\nnote";
  const auto add = [&](auto value) {
    line += ' ';
    internal::append_number(line, value);
  };
  const auto add_index = [&](std::size_t i) {
    if (i == Orl_correspondences::none)
      line += " -";
    else
      add(i);
  };
  const auto end = [&] {
    line += '\n';
    file.write(line);
    line.clear();
  };
  std::vector<std::string> words;
  std::istringstream note(c.note);
  for (std::string word; note >> word;)
    words.push_back(word);
  add(words.size());
  for (const std::string& word : words)
    line += ' ' + word;
  end();
  line += "trees";
  for (std::size_t t = 0; t < 2; ++t) {
    add(c.fingerprint[t]);
    add(c.fingerprint_of_points[t]);
  }
  end();
  line += "turn";
  for (const double x : c.turn)
    add(x);
  end();
  line += "branches";
  add(c.branches.size());
  end();
  for (const Orl_correspondences::Branch& b : c.branches) {
    add_index(b.parent);
    for (std::size_t t = 0; t < 2; ++t) {
      add_index(b.first[t]);
      add_index(b.tip[t]);
      add(b.attachment[t]);
      add(b.is_continued[t] ? 1 : 0);
      add(b.nodes[t].size());
      for (const double s : b.nodes[t])
        add(s);
    }
    end();
  }
  line += "pairs";
  add(c.pairs.size());
  end();
  for (const Orl_correspondences::Pair& p : c.pairs) {
    add(p.edge);
    for (const std::uint32_t i : p.point)
      add_index(i == Orl_correspondences::no_point ? Orl_correspondences::none : i);
    end();
  }
  file.commit();
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_WRITE_CORRESPONDENCES_H
