// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the correspondences of two trees from a file.

#ifndef PCS_IO_READ_CORRESPONDENCES_H
#define PCS_IO_READ_CORRESPONDENCES_H

#include <pcs/IO/internal/Word_reader.h>
#include <pcs/core/Orl_correspondences.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief reads a file of `write_correspondences()`.

  `Orl_shape_space::build_from()` checks whether the correspondences match the trees.

  Files of the previous version, 3, have no confidences; these are NaN then.

  \param path name of the file
  \throws pcs::IO_error with the line and the expected content
  \par Complexity
  Linear in the size of the file.
*/
inline Orl_correspondences read_correspondences(const std::string& path)
{
  internal::Word_reader file(path);
  Orl_correspondences result;
  file.expect("pcs_correspondences");
  const bool has_confidences = file.skip("4");
  if (!has_confidences && !file.skip("3"))
    file.fail("expected '3' or '4', the versions that can be read");
  file.expect("note");
  for (std::size_t n = file.count("the number of words"); n > 0; --n)
    result.note += (result.note.empty() ? "" : " ") + file.word("a word");
  file.expect("trees");
  for (std::size_t t = 0; t < 2; ++t) {
    result.fingerprint[t] = file.number<std::uint64_t>("a fingerprint");
    result.fingerprint_of_points[t] = file.number<std::uint64_t>("a fingerprint");
  }
  file.expect("turn");
  for (double& x : result.rotation)
    x = file.real("number of a quaternion");
  const auto index = [&] {
    return file.skip("-") ? Orl_correspondences::none : file.count("the number of an element");
  };
  file.expect("branches");
  result.branches.resize(file.count("the number of branches"));
  for (Orl_correspondences::Branch& b : result.branches) {
    b.parent = index();
    if (has_confidences && !file.skip("-"))
      b.confidence = file.real("confidence");
    for (std::size_t t = 0; t < 2; ++t) {
      b.first[t] = index();
      b.tip[t] = index();
      b.attachment[t] = file.real("attachment");
      b.is_continued[t] = file.skip("1");
      if (!b.is_continued[t])
        file.expect("0");
      b.nodes[t].resize(file.count("the number of nodes"));
      for (double& s : b.nodes[t])
        s = file.real("share");
    }
  }
  file.expect("pairs");
  result.pairs.resize(file.count("the number of pairs"));
  for (Orl_correspondences::Pair& p : result.pairs) {
    p.edge = file.number<std::uint32_t>("the number of an edge");
    for (std::uint32_t& i : p.point)
      i = file.skip("-") ? Orl_correspondences::no_point
                         : file.number<std::uint32_t>("the number of a point");
  }
  file.expect_end();
  return result;
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_READ_CORRESPONDENCES_H
