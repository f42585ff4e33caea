// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Handles whose points are named by elements of the range, such as vertex descriptors.

#include <pcs/deform_point_set.h>
#include <pcs/deformation/access/Element_positions.h>
#include <support/exceptions.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/iterator/iterator_facade.hpp>
#include <boost/range/iterator_range.hpp>
#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <vector>

namespace test_element_positions {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using pcs_test::message_has;

/// A vertex descriptor.
struct Vertex
{
  unsigned number = 0;
  friend bool operator<(Vertex a, Vertex b) { return a.number < b.number; }
  friend bool operator==(Vertex a, Vertex b) { return a.number == b.number; }
};

struct Position_map
{
  using key_type = Vertex;
  using value_type = Point;
  using reference = const Point&;
  using category = boost::lvalue_property_map_tag;

  std::vector<Point>* points;

  friend const Point& get(const Position_map& map, Vertex v) { return (*map.points)[v.number]; }
  friend void put(const Position_map& map, Vertex v, const Point& p)
  {
    (*map.points)[v.number] = p;
  }
};

/// A sheet of vertices whose first `number_of_removed` vertices are not in the range, as in a mesh
/// with removed elements.
struct Sheet
{
  std::vector<Point> points;
  std::vector<Vertex> vertices, fixed, moved;

  explicit Sheet(unsigned number_of_removed)
  {
    for (unsigned k = 0; k < number_of_removed; ++k)
      points.emplace_back(100, 100, 100);
    for (int i = 0; i < 30; ++i)
      for (int j = 0; j < 10; ++j) {
        const Vertex v{static_cast<unsigned>(points.size())};
        points.emplace_back(i, j, 0);
        vertices.push_back(v);
        if (i == 0)
          fixed.push_back(v);
        if (i == 29)
          moved.push_back(v);
      }
  }
  auto parameters() { return pcs::parameters::point_map(Position_map{&points}); }
};

/// Steps from element to element, like the iterator of a mesh with removed elements.
class Slow_iterator
  : public boost::
        iterator_facade<Slow_iterator, const Vertex, std::random_access_iterator_tag, const Vertex&>
{
public:
  Slow_iterator() = default;
  Slow_iterator(const Vertex* at, std::size_t* number_of_steps) : m_at(at), m_steps(number_of_steps)
  {
  }

private:
  friend class boost::iterator_core_access;
  const Vertex& dereference() const { return *m_at; }
  bool equal(const Slow_iterator& other) const { return m_at == other.m_at; }
  void increment() { advance(1); }
  void decrement() { advance(-1); }
  void advance(std::ptrdiff_t n)
  {
    *m_steps += static_cast<std::size_t>(std::abs(n));
    m_at += n;
  }
  std::ptrdiff_t distance_to(const Slow_iterator& other) const { return other.m_at - m_at; }

  const Vertex* m_at = nullptr;
  std::size_t* m_steps = nullptr;
};

} // namespace

BOOST_AUTO_TEST_SUITE(element_positions)

BOOST_AUTO_TEST_CASE(positions_of_all_equal_elements_are_found)
{
  const std::vector<Vertex> range = {{7}, {3}, {7}, {1}};
  const pcs::deformation::Element_positions<Vertex> positions(range);
  const std::vector<std::uint32_t> expected = {3, 0, 2};
  BOOST_TEST(positions.find(std::vector<Vertex>{{1}, {7}}, "f()") == expected);
  BOOST_TEST(positions.find(std::vector<Vertex>(), "f()").empty());
  BOOST_CHECK_EXCEPTION(positions.find(std::vector<Vertex>{{1}, {2}}, "f()"),
                        pcs::Invalid_input,
                        message_has("f(): element 1 of the range of handle points is not"));
}

BOOST_AUTO_TEST_CASE(handles_of_vertices_move_these_vertices)
{
  for (const unsigned number_of_removed : {0u, 1u, 5u}) {
    Sheet sheet(number_of_removed);
    const auto report = pcs::deform_point_set(boost::make_iterator_range(sheet.vertices),
                                              sheet.fixed,
                                              sheet.moved,
                                              pcs::translation(Vector(0, 0, 4)),
                                              sheet.parameters());
    BOOST_TEST((report.status == pcs::Status::converged));
    for (const Vertex v : sheet.fixed)
      BOOST_TEST(sheet.points[v.number].z() == 0);
    for (const Vertex v : sheet.moved)
      BOOST_TEST(std::abs(sheet.points[v.number].z() - 4) < 1e-12);
    for (unsigned k = 0; k < number_of_removed; ++k)
      BOOST_TEST(sheet.points[k] == Point(100, 100, 100));
  }
}

BOOST_AUTO_TEST_CASE(vertices_have_the_result_of_their_positions)
{
  Sheet by_vertex(3), by_position(3);
  const pcs::Similarity motion = pcs::translation(Vector(1, 0, 2));
  pcs::deform_point_set(by_vertex.vertices,
                        by_vertex.fixed,
                        by_vertex.moved,
                        motion,
                        by_vertex.parameters().region_of_interest(by_vertex.vertices));
  std::vector<std::size_t> fixed, moved;
  for (std::size_t i = 0; i < 10; ++i) {
    fixed.push_back(i);
    moved.push_back(290 + i);
  }
  pcs::deform_point_set(by_position.vertices, fixed, moved, motion, by_position.parameters());
  BOOST_TEST((by_vertex.points == by_position.points));
}

BOOST_AUTO_TEST_CASE(a_vertex_outside_the_range_is_named)
{
  Sheet sheet(1);
  const std::vector<Vertex> removed = {{0}};
  BOOST_CHECK_EXCEPTION(pcs::deform_point_set(sheet.vertices,
                                              sheet.fixed,
                                              removed,
                                              pcs::Similarity(),
                                              sheet.parameters()),
                        pcs::Invalid_input,
                        message_has("element 0 of the range of handle points is not"));
}

BOOST_AUTO_TEST_CASE(slow_iterators_are_passed_a_few_times_only)
{
  Sheet sheet(0);
  std::size_t number_of_steps = 0;
  const Slow_iterator first(sheet.vertices.data(), &number_of_steps);
  const auto range = boost::make_iterator_range(
      first,
      Slow_iterator(sheet.vertices.data() + sheet.vertices.size(), &number_of_steps));
  pcs::deform_point_set(range,
                        sheet.fixed,
                        sheet.moved,
                        pcs::translation(Vector(0, 0, 4)),
                        sheet.parameters());
  BOOST_TEST(sheet.points[299].z() > 3.9);
  BOOST_TEST(number_of_steps < 10 * sheet.vertices.size());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_element_positions
