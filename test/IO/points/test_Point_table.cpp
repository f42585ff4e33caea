// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of IO/Point_table.h.

#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <boost/test/unit_test.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace test_Point_table {

using pcs::Invalid_input;
using pcs::IO::Point_table;
using Point_3 = Point_table::Point_3;
using Vector_3 = Point_table::Vector_3;

namespace {

Point_table two_points()
{
  return Point_table(std::vector<Point_3>{Point_3(1, 2, 3), Point_3(4, 5, 6)});
}

} // namespace

BOOST_AUTO_TEST_SUITE(point_table)

BOOST_AUTO_TEST_CASE(a_property_keeps_its_type_and_its_place)
{
  Point_table table = two_points();
  table.add_property<std::uint8_t>("label", {7, 8});
  table.add_property<float>("height", {0.5f, 1.5f});
  BOOST_TEST((table.property_type("label") == pcs::IO::Scalar_type::uint8));
  BOOST_TEST((table.property<std::uint8_t>("label") == std::vector<std::uint8_t>{7, 8}));
  BOOST_TEST((table.property_as_double("height") == std::vector<double>{0.5, 1.5}));
  table.replace_property<std::int64_t>("label", {-1, -2});
  BOOST_TEST((table.property_names() == std::vector<std::string>{"label", "height"}));
  BOOST_TEST((table.property_type("label") == pcs::IO::Scalar_type::int64));
}

BOOST_AUTO_TEST_CASE(wrong_use_is_refused_and_changes_nothing)
{
  Point_table table = two_points();
  table.add_property<int>("label", {7, 8});
  BOOST_CHECK_THROW(table.add_property<int>("label", {1, 2}), Invalid_input);
  BOOST_CHECK_THROW(table.add_property<int>("x", {1, 2}), Invalid_input);
  BOOST_CHECK_THROW(table.add_property<int>("", {1, 2}), Invalid_input);
  BOOST_CHECK_THROW(table.add_property<int>("short", {1}), Invalid_input);
  BOOST_CHECK_THROW(table.property<float>("label"), Invalid_input);
  BOOST_CHECK_THROW(table.property<int>("absent"), Invalid_input);
  BOOST_CHECK_THROW(table.remove_property("absent"), Invalid_input);
  BOOST_CHECK_THROW(table.remove_property("x"), Invalid_input);
  BOOST_CHECK_THROW(table.select({2}), Invalid_input);
  BOOST_TEST(table.property_names().size() == 1u);
}

BOOST_AUTO_TEST_CASE(the_message_names_the_property_and_both_types)
{
  Point_table table = two_points();
  table.add_property<std::uint16_t>("label", {7, 8});
  BOOST_CHECK_EXCEPTION(table.property<float>("label"), Invalid_input, [](const Invalid_input& e) {
    const std::string text = e.what();
    return text.find("'label'") != std::string::npos && text.find("uint16") != std::string::npos &&
           text.find("float32") != std::string::npos;
  });
}

BOOST_AUTO_TEST_CASE(normals_are_stored_in_the_existing_type)
{
  Point_table table = two_points();
  BOOST_TEST(!table.has_normals());
  BOOST_CHECK_THROW(table.normals(), Invalid_input);
  table.add_property<float>("nx", {0, 0});
  table.set_normals({Vector_3(1, 0, 0), Vector_3(0, 0, 1)});
  BOOST_TEST((table.property_type("nx") == pcs::IO::Scalar_type::float32));
  BOOST_TEST((table.property_type("ny") == pcs::IO::Scalar_type::float64));
  BOOST_TEST(table.has_normals());
  BOOST_TEST((table.normals()[1] == Vector_3(0, 0, 1)));
}

BOOST_AUTO_TEST_CASE(selected_points_bring_their_properties)
{
  Point_table table = two_points();
  table.add_property<int>("label", {7, 8});
  const Point_table chosen = table.select({1, 0, 1});
  BOOST_TEST((chosen.property<int>("label") == std::vector<int>{8, 7, 8}));
  BOOST_TEST((chosen.points()[0] == Point_3(4, 5, 6)));
}

BOOST_AUTO_TEST_CASE(tables_with_other_properties_cannot_be_appended)
{
  Point_table table = two_points();
  table.append(two_points());
  BOOST_TEST(table.number_of_points() == 4u);
  Point_table other = two_points();
  other.add_property<int>("label", {7, 8});
  BOOST_CHECK_THROW(table.append(other), Invalid_input);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Point_table
