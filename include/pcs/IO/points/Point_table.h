// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points with named properties, each kept in the type it has in its file.

#ifndef PCS_IO_POINTS_POINT_TABLE_H
#define PCS_IO_POINTS_POINT_TABLE_H

#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Scalar_type.h>
#include <pcs/core/errors.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief Points and any number of named properties per point, in file order.

  Positions are stored as doubles for every type in the file. Every other property keeps its own
  type, so reading and writing a table changes only the points that the caller changes. A default
  constructed table has no points and no properties other than `x`, `y`, `z`.

  The caller may change positions and the number of points through `points()`. The writers reject
  properties whose size differs from the number of points.
*/
class Point_table
{
public:
  using Kernel = CGAL::Simple_cartesian<double>;
  using Point_3 = Kernel::Point_3;
  using Vector_3 = Kernel::Vector_3;

  Point_table() : Point_table(Point_schema()) {}

  //! constructs a table without points and with the properties of `schema`
  explicit Point_table(Point_schema schema) : m_schema(std::move(schema))
  {
    for (const Property_description& p : m_schema.properties)
      m_values.push_back(make_values(p.type));
  }

  //! constructs a table of positions only
  explicit Point_table(std::vector<Point_3> points) : Point_table()
  {
    m_points = std::move(points);
  }

  std::size_t number_of_points() const { return m_points.size(); }
  std::vector<Point_3>& points() { return m_points; }
  const std::vector<Point_3>& points() const { return m_points; }

  //! returns names and types in file order, with the metadata of the format
  const Point_schema& schema() const { return m_schema; }

  //! returns the comment and obj_info lines of a PLY file
  std::vector<std::string>& comments() { return m_schema.comments; }
  std::vector<std::string>& obj_info() { return m_schema.obj_info; }

  //! returns the names of the properties other than `x`, `y`, `z`, in file order
  std::vector<std::string> property_names() const
  {
    std::vector<std::string> names;
    for (const Property_description& p : m_schema.properties)
      if (!is_coordinate_name(p.name))
        names.push_back(p.name);
    return names;
  }

  //! whether there is a property of that name other than a coordinate
  bool has_property(const std::string& name) const
  {
    return !is_coordinate_name(name) && m_schema.has(name);
  }

  //! returns the type of a property; throws `pcs::Invalid_input` if it does not exist
  Scalar_type property_type(const std::string& name) const
  {
    return m_schema.properties[index_of(name, "property_type")].type;
  }

  /*!
    \brief returns the values of a property in their own type.

    Throws `pcs::Invalid_input` when there is no such property or `T` is not its type.
  */
  template <class T>
  const std::vector<T>& property(const std::string& name) const
  {
    const std::size_t i = index_of(name, "property");
    if (scalar_type_of<T>() != m_schema.properties[i].type)
      throw Invalid_input("pcs::IO::Point_table::property(): property '" + name + "' is of type " +
                          name_of(m_schema.properties[i].type) + ", not " +
                          name_of(scalar_type_of<T>()));
    return *std::get_if<std::vector<T>>(&m_values[i]);
  }

  //! returns the values for modification; their number must not change
  template <class T>
  std::vector<T>& property(const std::string& name)
  {
    return const_cast<std::vector<T>&>(std::as_const(*this).template property<T>(name));
  }

  //! returns the values of a property of any type, converted to double
  std::vector<double> property_as_double(const std::string& name) const
  {
    return std::visit(
        [](const auto& values) {
          std::vector<double> result;
          result.reserve(values.size());
          for (const auto value : values)
            result.push_back(static_cast<double>(value));
          return result;
        },
        m_values[index_of(name, "property_as_double")]);
  }

  //! returns the values of a property as a variant over the ten types
  const Property_values& property_values(const std::string& name) const
  {
    return m_values[index_of(name, "property_values")];
  }

  /*!
    \brief appends a property.

    Throws `pcs::Invalid_input` without effect if the name is empty, in use, or a coordinate, or if
    the number of values differs from the number of points.
  */
  template <class T>
  void add_property(const std::string& name, std::vector<T> values)
  {
    if (name.empty() || m_schema.has(name) || is_coordinate_name(name))
      throw Invalid_input("pcs::IO::Point_table::add_property(): the name '" + name +
                          "' is empty or already in use");
    check_size(name, values.size(), "add_property");
    m_values.reserve(m_values.size() + 1);
    m_schema.properties.push_back({name, scalar_type_of<T>()});
    m_values.emplace_back(std::move(values));
  }

  //! replaces the values of an existing property, possibly by another type; it keeps its index
  template <class T>
  void replace_property(const std::string& name, std::vector<T> values)
  {
    const std::size_t i = index_of(name, "replace_property");
    check_size(name, values.size(), "replace_property");
    m_schema.properties[i].type = scalar_type_of<T>();
    m_values[i] = std::move(values);
  }

  //! removes an existing property
  void remove_property(const std::string& name)
  {
    const auto i = static_cast<std::ptrdiff_t>(index_of(name, "remove_property"));
    m_schema.properties.erase(m_schema.properties.begin() + i);
    m_values.erase(m_values.begin() + i);
  }

  //! whether the properties `nx`, `ny` and `nz` exist
  bool has_normals() const
  {
    return has_property("nx") && has_property("ny") && has_property("nz");
  }

  //! returns the vectors `(nx, ny, nz)`; throws `pcs::Invalid_input` if one property is missing
  std::vector<Vector_3> normals() const
  {
    const std::vector<double> nx = property_as_double("nx");
    const std::vector<double> ny = property_as_double("ny");
    const std::vector<double> nz = property_as_double("nz");
    std::vector<Vector_3> result;
    result.reserve(nx.size());
    for (std::size_t i = 0; i < nx.size(); ++i)
      result.emplace_back(nx[i], ny[i], nz[i]);
    return result;
  }

  //! stores normals in `nx`, `ny`, `nz`: in existing float or double properties, or in new ones
  void set_normals(const std::vector<Vector_3>& normals)
  {
    check_size("nx", normals.size(), "set_normals");
    constexpr const char* names[] = {"nx", "ny", "nz"};
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      values.reserve(normals.size());
      for (const Vector_3& n : normals)
        values.push_back(n[axis]);
      if (!has_property(names[axis]))
        add_property(names[axis], std::move(values));
      else if (property_type(names[axis]) == Scalar_type::float32)
        replace_property(names[axis], to_float(values));
      else
        replace_property(names[axis], std::move(values));
    }
  }

  /*!
    \brief appends the points of another table with the same names and types in the same order.

    Throws `pcs::Invalid_input` when the properties differ.
  */
  void append(const Point_table& other)
  {
    if (m_schema.properties != other.m_schema.properties)
      throw Invalid_input("pcs::IO::Point_table::append(): the tables have different properties");
    m_points.insert(m_points.end(), other.m_points.begin(), other.m_points.end());
    for (std::size_t i = 0; i < m_values.size(); ++i)
      std::visit(
          [&](auto& values) {
            const auto& more = *std::get_if<std::decay_t<decltype(values)>>(&other.m_values[i]);
            values.insert(values.end(), more.begin(), more.end());
          },
          m_values[i]);
  }

  /*!
    \brief returns the points with the given indices with all their properties.

    Throws `pcs::Invalid_input` when an index is not below `number_of_points()`.
  */
  Point_table select(const std::vector<std::size_t>& indices) const
  {
    for (const std::size_t i : indices)
      if (i >= m_points.size())
        throw Invalid_input("pcs::IO::Point_table::select(): index " + std::to_string(i) +
                            " is not below the number of points " +
                            std::to_string(m_points.size()));
    check_sizes("select");
    Point_table result(m_schema);
    result.m_points = gather(m_points, indices);
    for (std::size_t c = 0; c < m_values.size(); ++c)
      if (!is_coordinate_name(m_schema.properties[c].name))
        result.m_values[c] =
            std::visit([&](const auto& values) { return Property_values(gather(values, indices)); },
                       m_values[c]);
    return result;
  }

  //! removes all points; the properties and the memory remain
  void clear()
  {
    m_points.clear();
    for (Property_values& values : m_values)
      std::visit([](auto& v) { v.clear(); }, values);
  }

  //! throws `pcs::Invalid_input` unless every property has one value per point
  void check_sizes(const std::string& caller) const
  {
    for (std::size_t i = 0; i < m_values.size(); ++i)
      if (!is_coordinate_name(m_schema.properties[i].name))
        check_size(m_schema.properties[i].name, number_of_values(m_values[i]), caller);
  }

  /// \cond SKIP_IN_MANUAL
  Property_values& values_at(std::size_t i) { return m_values[i]; }
  const Property_values& values_at(std::size_t i) const { return m_values[i]; }
  /// \endcond

private:
  std::size_t index_of(const std::string& name, const char* caller) const
  {
    const std::size_t i = m_schema.find(name);
    if (i == m_schema.properties.size() || is_coordinate_name(name))
      throw Invalid_input(std::string("pcs::IO::Point_table::") + caller +
                          "(): there is no property '" + name + "'");
    return i;
  }

  void check_size(const std::string& name, std::size_t size, const std::string& caller) const
  {
    if (size != m_points.size())
      throw Invalid_input("pcs::IO::Point_table::" + caller + "(): property '" + name + "' has " +
                          std::to_string(size) + " values for " + std::to_string(m_points.size()) +
                          " points");
  }

  static std::vector<float> to_float(const std::vector<double>& values)
  {
    std::vector<float> result;
    result.reserve(values.size());
    for (const double value : values)
      result.push_back(static_cast<float>(value));
    return result;
  }

  template <class T>
  static std::vector<T> gather(const std::vector<T>& values,
                               const std::vector<std::size_t>& indices)
  {
    std::vector<T> result;
    result.reserve(indices.size());
    for (const std::size_t i : indices)
      result.push_back(values[i]);
    return result;
  }

  Point_schema m_schema;
  std::vector<Point_3> m_points;
  std::vector<Property_values> m_values; // parallel to m_schema.properties; empty for x, y, z
};

} // namespace IO
} // namespace pcs

#endif // PCS_IO_POINTS_POINT_TABLE_H
