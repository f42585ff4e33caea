// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Minimal models of the concepts: code that compiles with them compiles with every model.

#ifndef PCS_TEST_SUPPORT_ARCHETYPES_H
#define PCS_TEST_SUPPORT_ARCHETYPES_H

#include <boost/property_map/property_map.hpp>

#include <cstddef>
#include <iterator>
#include <vector>

namespace pcs_test {

/// Point with three coordinates only: no default constructor, no comparison, no assignment of a
/// coordinate.
template <class FT_>
class Triple_archetype
{
public:
  using FT = FT_;
  Triple_archetype(FT x, FT y, FT z) : m_x(x), m_y(y), m_z(z) {}
  FT x() const { return m_x; }
  FT y() const { return m_y; }
  FT z() const { return m_z; }

private:
  FT m_x, m_y, m_z;
};

/// A key that can only be copied.
class Key_archetype
{
public:
  explicit Key_archetype(std::size_t i) : m_index(i) {}
  std::size_t index() const { return m_index; }

private:
  std::size_t m_index;
};

/// Property map that reads by value and writes through `put`. It is not default constructible, not
/// assignable, and has no `operator[]`.
template <class Value>
class Map_archetype
{
public:
  using key_type = Key_archetype;
  using value_type = Value;
  using reference = Value;
  using category = boost::read_write_property_map_tag;

  explicit Map_archetype(std::vector<Value>& values) : m_values(values) {}

  friend Value get(const Map_archetype& map, const Key_archetype& key)
  {
    return map.m_values[key.index()];
  }
  friend void put(const Map_archetype& map, const Key_archetype& key, const Value& value)
  {
    Value& place = map.m_values[key.index()];
    place.~Value();
    new (&place) Value(value);
  }

private:
  std::vector<Value>& m_values;
};

/// A range of generated keys: its iterators return them by value.
class Range_archetype
{
public:
  class iterator
  {
  public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = Key_archetype;
    using difference_type = std::ptrdiff_t;
    using pointer = void;
    using reference = Key_archetype;

    explicit iterator(std::size_t i) : m_index(i) {}
    Key_archetype operator*() const { return Key_archetype(m_index); }
    iterator& operator++()
    {
      ++m_index;
      return *this;
    }
    iterator operator+(difference_type d) const
    {
      return iterator(m_index + static_cast<std::size_t>(d));
    }
    difference_type operator-(const iterator& other) const
    {
      return static_cast<difference_type>(m_index) - static_cast<difference_type>(other.m_index);
    }
    iterator& operator+=(difference_type d) { return *this = *this + d; }
    bool operator==(const iterator& other) const { return m_index == other.m_index; }
    bool operator!=(const iterator& other) const { return m_index != other.m_index; }

  private:
    std::size_t m_index;
  };

  explicit Range_archetype(std::size_t n) : m_size(n) {}
  iterator begin() const { return iterator(0); }
  iterator end() const { return iterator(m_size); }

private:
  std::size_t m_size;
};

/// A single pass range of integers.
class Index_range_archetype
{
public:
  class iterator
  {
  public:
    using iterator_category = std::input_iterator_tag;
    using value_type = short;
    using difference_type = std::ptrdiff_t;
    using pointer = void;
    using reference = short;
    explicit iterator(short i) : m_index(i) {}
    short operator*() const { return m_index; }
    iterator& operator++()
    {
      ++m_index;
      return *this;
    }
    bool operator==(const iterator& other) const { return m_index == other.m_index; }
    bool operator!=(const iterator& other) const { return m_index != other.m_index; }

  private:
    short m_index;
  };
  Index_range_archetype(short begin, short end) : m_begin(begin), m_end(end) {}
  iterator begin() const { return iterator(m_begin); }
  iterator end() const { return iterator(m_end); }

private:
  short m_begin, m_end;
};

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_ARCHETYPES_H
