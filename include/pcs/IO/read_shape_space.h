// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a whole shape space of trees from a file.

#ifndef PCS_IO_READ_SHAPE_SPACE_H
#define PCS_IO_READ_SHAPE_SPACE_H

#include <pcs/IO/internal/Word_reader.h>
#include <pcs/core/Orl_space_data.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

class Space_reader
{
public:
  explicit Space_reader(const std::string& path) : m_file(path) {}

  Orl_space_data read()
  {
    Orl_space_data s;
    read_head(s);
    read_branches(s);
    read_trees(s);
    read_weights(s.weights);
    read_pairs(s.pairs);
    read_points(s);
    read_partners(s);
    m_file.expect_end();
    return s;
  }

private:
  void read_head(Orl_space_data& s)
  {
    m_file.expect("pcs_shape_space");
    m_is_version_5 = m_file.skip("5");
    if (!m_is_version_5 && !m_file.skip("6"))
      m_file.fail("expected '5' or '6', the versions that can be read");
    m_file.expect("orientation");
    s.orientation = m_file.number<int>("the kind of orientations");
    read_all(s.origin);
    m_file.expect("matching");
    s.matching.back() = 1; // whorls are kept, as in version 5
    for (std::size_t i = 0; i < s.matching.size() - (m_is_version_5 ? 1 : 0); ++i)
      s.matching[i] = m_file.real("a number");
  }
  /// Reads the branches and the edges that refer to earlier ones.
  void read_branches(Orl_space_data& s)
  {
    m_file.expect("branches");
    for (std::size_t n = m_file.count("the number of branches"); n > 0; --n) {
      Orl_space_data::Branch b;
      b.parent = index();
      b.number_of_edges = m_file.count("the number of edges");
      b.reference_edge = index();
      if (!m_is_version_5 && !m_file.skip("-"))
        b.confidence = m_file.real("confidence");
      s.branches.push_back(b);
    }
    m_file.expect("references");
    for (std::size_t n = m_file.count("the number of references"); n > 0; --n) {
      const std::size_t edge = m_file.count("the number of an edge");
      s.references.push_back({edge, m_file.count("the number of an edge")});
    }
  }
  /// Reads all trees, then the reference tree.
  void read_trees(Orl_space_data& s)
  {
    m_file.expect("trees");
    for (std::size_t n = m_file.count("the number of trees"); n > 0; --n)
      s.trees.push_back(read_tree());
    s.reference = read_tree();
  }
  void read_weights(Orl_space_data::Weights& weights)
  {
    m_file.expect("weights");
    weights.root = m_file.real("a weight");
    for (auto* values : {&weights.orientation,
                         &weights.length,
                         &weights.radius,
                         &weights.base_radius,
                         &weights.attachment})
      *values = read_numbers();
  }
  void read_pairs(std::vector<Orl_correspondences::Pair>& pairs)
  {
    m_file.expect("pairs");
    for (std::size_t n = m_file.count("the number of pairs"); n > 0; --n) {
      Orl_correspondences::Pair p{};
      p.edge = m_file.number<std::uint32_t>("the number of an edge");
      for (std::uint32_t& i : p.point)
        i = m_file.skip("-") ? Orl_correspondences::no_point
                             : m_file.number<std::uint32_t>("the number of a point");
      pairs.push_back(p);
    }
  }
  void read_points(Orl_space_data& s)
  {
    m_file.expect("points");
    const std::size_t number_of_points = m_file.count("the number of points");
    m_file.expect("normals");
    s.has_normals = m_file.count("whether there are normals") != 0;
    for (std::size_t n = number_of_points; n > 0; --n) {
      Orl_space_data::Point p;
      p.tree = m_file.number<std::uint32_t>("the number of a tree");
      p.index = m_file.number<std::uint32_t>("the number of a point");
      p.edge = m_file.number<std::uint32_t>("the number of an edge");
      read_place(s.has_normals, p);
      s.points.push_back(p);
    }
  }
  void read_partners(Orl_space_data& s)
  {
    m_file.expect("partners");
    for (std::size_t n = m_file.count("the number of partners"); n > 0; --n) {
      Orl_space_data::Partner p;
      p.point = m_file.number<std::uint32_t>("the number of a point");
      p.tree = m_file.number<std::uint32_t>("the number of a tree");
      p.index = m_file.number<std::uint32_t>("the number of a point");
      read_place(s.has_normals, p);
      s.partners.push_back(p);
    }
  }

  /// Reads the position and, if present, the normal of a point or of a partner.
  template <class Point>
  void read_place(bool has_normals, Point& p)
  {
    read_all(p.position);
    if (has_normals)
      read_all(p.normal);
  }
  template <class Range>
  void read_all(Range& values)
  {
    for (double& v : values)
      v = m_file.real("a number");
  }
  std::size_t index()
  {
    return m_file.skip("-") ? Orl_space_data::none : m_file.count("the number of an element");
  }
  // grows with the data: a wrong count fails at the end of the file, before memory is exhausted
  std::vector<double> read_numbers()
  {
    std::vector<double> values;
    for (std::size_t n = m_file.count("the number of values"); n > 0; --n)
      values.push_back(m_file.real("a number"));
    return values;
  }
  std::vector<std::array<double, 3>> read_vectors()
  {
    std::vector<std::array<double, 3>> values;
    for (std::size_t n = m_file.count("the number of points"); n > 0; --n) {
      values.emplace_back();
      read_all(values.back());
    }
    return values;
  }
  Orl_space_data::Tree read_tree()
  {
    Orl_space_data::Tree t;
    m_file.expect("tree");
    read_all(t.root);
    for (std::size_t n = m_file.count("the number of edges"); n > 0; --n) {
      t.orientation.emplace_back();
      read_all(t.orientation.back());
    }
    for (auto* values : {&t.length, &t.radius, &t.base_radius, &t.attachment})
      *values = read_numbers();
    for (std::size_t n = m_file.count("the number of branches"); n > 0; --n)
      t.tip.push_back(index());
    for (std::size_t n = m_file.count("the number of branches"); n > 0; --n)
      t.has.push_back(m_file.count("0 or 1") != 0 ? 1 : 0);
    t.point = read_vectors();
    t.normal = read_vectors();
    return t;
  }

  Word_reader m_file;
  bool m_is_version_5 = false;
};

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief reads a file of `write_shape_space()`.

  `Orl_shape_space::restore()` checks whether the numbers are consistent.

  Files of the previous version, 5, have no confidences; these are NaN then.

  \param path name of the file
  \throws pcs::IO_error with the line and the expected content
  \par Complexity
  Linear in the size of the file.
*/
inline Orl_space_data read_shape_space(const std::string& path)
{
  return internal::Space_reader(path).read();
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_READ_SHAPE_SPACE_H
