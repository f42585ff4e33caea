// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a whole shape space of trees to a file.

#ifndef PCS_IO_WRITE_SHAPE_SPACE_H
#define PCS_IO_WRITE_SHAPE_SPACE_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/Orl_space_data.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

class Space_writer
{
public:
  explicit Space_writer(const std::string& path) : m_file(path) {}

  void write(const Orl_space_data& s)
  {
    write_head(s);
    write_branches(s);
    write_trees(s);
    write_weights(s.weights);
    write_pairs(s.pairs);
    write_points(s);
    write_partners(s);
    m_file.commit();
  }

private:
  void write_head(const Orl_space_data& s)
  {
    m_line = "pcs_shape_space 6\norientation";
    add(s.orientation);
    add_all(s.origin);
    end();
    m_line = "matching";
    add_all(s.matching);
    end();
  }
  /// Writes the branches and the edges that refer to earlier ones.
  void write_branches(const Orl_space_data& s)
  {
    begin("branches", s.branches.size());
    for (const Orl_space_data::Branch& b : s.branches) {
      add_index(b.parent);
      add(b.number_of_edges);
      add_index(b.reference_edge);
      if (std::isfinite(b.confidence))
        add(b.confidence);
      else
        m_line += " -";
      end();
    }
    begin("references", s.references.size());
    for (const auto& [edge, earlier] : s.references) {
      add(edge);
      add(earlier);
      end();
    }
  }
  /// Writes all trees, then the reference tree.
  void write_trees(const Orl_space_data& s)
  {
    begin("trees", s.trees.size());
    for (const Orl_space_data::Tree& t : s.trees)
      write_tree(t);
    write_tree(s.reference);
  }
  void write_weights(const Orl_space_data::Weights& weights)
  {
    m_line = "weights";
    add(weights.root);
    end();
    for (const auto* values : {&weights.orientation,
                               &weights.length,
                               &weights.radius,
                               &weights.base_radius,
                               &weights.attachment})
      write_numbers(*values);
  }
  void write_pairs(const std::vector<Orl_correspondences::Pair>& pairs)
  {
    begin("pairs", pairs.size());
    for (const Orl_correspondences::Pair& p : pairs) {
      add(p.edge);
      for (const std::uint32_t i : p.point)
        add_index(i == Orl_correspondences::no_point ? Orl_space_data::none : i);
      end();
    }
  }
  void write_points(const Orl_space_data& s)
  {
    begin("points", s.points.size());
    m_line = s.has_normals ? "normals 1" : "normals 0";
    end();
    for (const Orl_space_data::Point& p : s.points) {
      add(p.tree);
      add(p.index);
      add(p.edge);
      add_place(s.has_normals, p);
      end();
    }
  }
  void write_partners(const Orl_space_data& s)
  {
    begin("partners", s.partners.size());
    for (const Orl_space_data::Partner& p : s.partners) {
      add(p.point);
      add(p.tree);
      add(p.index);
      add_place(s.has_normals, p);
      end();
    }
  }

  /// Adds the position and, if present, the normal of a point or of a partner.
  template <class Point>
  void add_place(bool has_normals, const Point& p)
  {
    add_all(p.position);
    if (has_normals)
      add_all(p.normal);
  }
  template <class T>
  void add(T value)
  {
    m_line += ' ';
    append_number(m_line, value);
  }
  template <class Range>
  void add_all(const Range& values)
  {
    for (const auto v : values)
      add(v);
  }
  void add_index(std::size_t i)
  {
    if (i == Orl_space_data::none)
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
    m_line = name;
    add(count);
    end();
  }
  void write_numbers(const std::vector<double>& values)
  {
    add(values.size());
    add_all(values);
    end();
  }
  void write_vectors(const std::vector<std::array<double, 3>>& values)
  {
    add(values.size());
    end();
    for (const auto& v : values) {
      add_all(v);
      end();
    }
  }
  void write_tree(const Orl_space_data::Tree& t)
  {
    m_line = "tree";
    add_all(t.root);
    end();
    add(t.orientation.size());
    for (const auto& q : t.orientation)
      add_all(q);
    end();
    for (const auto* values : {&t.length, &t.radius, &t.base_radius, &t.attachment})
      write_numbers(*values);
    add(t.tip.size());
    for (const std::size_t i : t.tip)
      add_index(i);
    end();
    add(t.has.size());
    for (const char has : t.has)
      add(has ? 1 : 0);
    end();
    write_vectors(t.point);
    write_vectors(t.normal);
  }

  Output_file m_file;
  std::string m_line;
};

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief writes the result of `Orl_shape_space::data()` as text; `read_shape_space()` restores it
      exactly.

  The file is written completely or not at all.

  \param path name of the file
  \param space the data of a space
  \throws pcs::IO_error when the file cannot be written
  \par Complexity
  Linear in the size of the data.
*/
inline void write_shape_space(const std::string& path, const Orl_space_data& space)
{
  internal::Space_writer(path).write(space);
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_WRITE_SHAPE_SPACE_H
