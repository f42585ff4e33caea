// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of checking and reading the values of named parameters.

#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <support/exceptions.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

namespace test_check_value {

using pcs_test::message_has;
namespace internal = pcs::internal;
namespace np = pcs::parameters;

BOOST_AUTO_TEST_SUITE(check_value)

BOOST_AUTO_TEST_CASE(valid_values_are_returned)
{
  BOOST_TEST(internal::check_at_least("f()", "x", 0, 0) == 0);
  BOOST_TEST(internal::check_positive("f()", "x", 1e-300) == 1e-300);
  BOOST_TEST(internal::check_in_range("f()", "x", 2, 1, 2) == 2);
  BOOST_TEST(internal::check_count("f()", "n", 7, 1, 7) == 7u);
}

BOOST_AUTO_TEST_CASE(messages_name_function_parameter_value_and_rule)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BOOST_CHECK_EXCEPTION(internal::check_at_least("f()", "x", -1, 0),
                        pcs::Invalid_input,
                        message_has("f(): x is -1; it must be finite and not negative"));
  BOOST_CHECK_EXCEPTION(internal::check_positive("f()", "x", nan),
                        pcs::Invalid_input,
                        message_has("f(): x is nan; it must be finite and positive"));
  BOOST_CHECK_EXCEPTION(internal::check_in_range("f()", "x", 3, 1, 2),
                        pcs::Invalid_input,
                        message_has("f(): x is 3; it must be between 1 and 2"));
}

BOOST_AUTO_TEST_CASE(counts_do_not_wrap_around)
{
  BOOST_CHECK_EXCEPTION(internal::check_count("f()", "n", -1, 0, 10),
                        pcs::Invalid_input,
                        message_has("f(): n is -1; it must be between 0 and 10"));
  BOOST_CHECK_THROW(internal::check_count("f()", "n", std::int8_t(-128), 0, 10),
                    pcs::Invalid_input);
  BOOST_CHECK_THROW(internal::check_count("f()", "n", std::uint64_t(1) << 40, 0, 10),
                    pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE(parameters_replace_defaults)
{
  double tolerance = 1;
  internal::read_parameter(np::stiffness(2), pcs::internal_np::tolerance, tolerance);
  BOOST_TEST(tolerance == 1);
  internal::read_parameter(np::stiffness(2).tolerance(0.5f),
                           pcs::internal_np::tolerance,
                           tolerance);
  BOOST_TEST(tolerance == 0.5);
}

BOOST_AUTO_TEST_CASE(the_vertical_gets_unit_length_at_every_scale)
{
  using Vector = CGAL::Simple_cartesian<double>::Vector_3;
  for (const double scale : {1e-300, 1.0, 1e300}) {
    const std::array<double, 3> up =
        internal::read_up_direction(np::up_direction(Vector(0, 3 * scale, 4 * scale)), "f()");
    BOOST_TEST(up[0] == 0);
    BOOST_TEST(std::abs(up[1] - 0.6) < 1e-12);
    BOOST_TEST(std::abs(up[2] - 0.8) < 1e-12);
  }
  BOOST_TEST(internal::read_up_direction(np::default_values(), "f()")[2] == 1);
  BOOST_CHECK_EXCEPTION(internal::read_up_direction(np::up_direction(Vector(0, 0, 0)), "f()"),
                        pcs::Invalid_input,
                        message_has("f(): `up_direction` must be finite and not the null vector"));
}

BOOST_AUTO_TEST_CASE(a_callback_is_kept)
{
  std::function<bool(double)> callback;
  internal::read_callback(np::default_values(), callback);
  BOOST_TEST(!callback);
  double last = 0;
  internal::read_callback(np::callback([&](double f) {
                            last = f;
                            return f < 0.5;
                          }),
                          callback);
  BOOST_TEST(callback(0.25));
  BOOST_TEST(!callback(0.75));
  BOOST_TEST(last == 0.75);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_check_value
