// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes the correspondences of two trees to a file.

#ifndef PCS_IO_WRITE_CORRESPONDENCES_H
#define PCS_IO_WRITE_CORRESPONDENCES_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Orl_correspondences.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace pcs {
namespace IO {

namespace internal {

class Correspondence_writer
{
public:
  explicit Correspondence_writer(const std::string& path) : m_file(path) {}

  void write(const Orl_correspondences& c)
  {
    m_line = "pcs_correspondences 4\nnote";
    add_words(c.note);
    end();
    write_trees(c);
    begin("branches", c.branches.size());
    for (const Orl_correspondences::Branch& b : c.branches)
      write_branch(b);
    begin("pairs", c.pairs.size());
    for (const Orl_correspondences::Pair& p : c.pairs)
      write_pair(p);
    m_file.commit();
  }

private:
  template <class T>
  void add(T value)
  {
    m_line += ' ';
    append_number(m_line, value);
  }
  void add_index(std::size_t i)
  {
    if (i == Orl_correspondences::none)
      m_line += " -";
    else
      add(i);
  }
  void end()
  {
    m_line += '\n';
    m_file.write(m_line);
    m_line.clear();
  }
  void begin(const char* name, std::size_t count)
  {
    m_line += name;
    add(count);
    end();
  }

  /// Adds the number of words of a text, then the words.
  void add_words(const std::string& text)
  {
    std::vector<std::string> words;
    std::istringstream stream(text);
    for (std::string word; stream >> word;)
      words.push_back(word);
    add(words.size());
    for (const std::string& word : words)
      m_line += ' ' + word;
  }
  /// Writes the fingerprints of both trees and the rotation between them.
  void write_trees(const Orl_correspondences& c)
  {
    m_line += "trees";
    for (std::size_t t = 0; t < 2; ++t) {
      add(c.fingerprint[t]);
      add(c.fingerprint_of_points[t]);
    }
    end();
    m_line += "turn";
    for (const double x : c.rotation)
      add(x);
    end();
  }
  void write_branch(const Orl_correspondences::Branch& b)
  {
    add_index(b.parent);
    if (std::isfinite(b.confidence))
      add(b.confidence);
    else
      m_line += " -";
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
  void write_pair(const Orl_correspondences::Pair& p)
  {
    add(p.edge);
    for (const std::uint32_t i : p.point)
      add_index(i == Orl_correspondences::no_point ? Orl_correspondences::none : i);
    end();
  }

  Output_file m_file;
  std::string m_line;
};

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief writes the correspondences of two trees as text; `read_correspondences()` restores them
      exactly.

  The file is written completely or not at all.

  \param path name of the file
  \param c the correspondences
  \throws pcs::IO_error when the file cannot be written
  \par Complexity
  Linear in the size of the correspondences.
*/
inline void write_correspondences(const std::string& path, const Orl_correspondences& c)
{
  internal::Correspondence_writer(path).write(c);
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_WRITE_CORRESPONDENCES_H
