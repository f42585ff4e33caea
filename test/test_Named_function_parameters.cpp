// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Chains of named parameters of pcs and CGAL, in any order.

#include <pcs/Named_function_parameters.h>

#include <CGAL/property_map.h>

#include <boost/test/unit_test.hpp>

#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace test_Named_function_parameters {

namespace {

namespace np = pcs::parameters;
namespace tags = pcs::internal_np;
using pcs::internal::choose;
using pcs::internal::is_given_v;
using Pair = std::pair<int, double>;
using First = CGAL::First_of_pair_property_map<Pair>;
using Second = CGAL::Second_of_pair_property_map<Pair>;

/// Values that a function of pcs reads from a chain: "samples tolerance has-point-map
/// has-normal-map".
template <class NamedParameters>
std::string seen(const NamedParameters& chain)
{
  return std::to_string(choose(chain, tags::number_of_samples, 7)) + ' ' +
         std::to_string(choose(chain, tags::tolerance, 0.5)).substr(0, 4) + ' ' +
         std::to_string(is_given_v<NamedParameters, CGAL::internal_np::point_t>) + ' ' +
         std::to_string(is_given_v<NamedParameters, CGAL::internal_np::normal_t>);
}

} // namespace

BOOST_AUTO_TEST_SUITE(Named_function_parameters)

BOOST_AUTO_TEST_CASE(without_parameters_every_default_applies)
{
  BOOST_TEST(seen(np::default_values()) == "7 0.50 0 0");
  BOOST_TEST(seen(np::Default_named_parameters(true)) == "7 0.50 0 0");
}

BOOST_AUTO_TEST_CASE(parameters_may_come_in_any_order)
{
  const std::string expected = "3 0.25 1 1";
  BOOST_TEST(seen(np::number_of_samples(3).tolerance(0.25).point_map(First()).normal_map(
                 Second())) == expected);
  BOOST_TEST(seen(np::point_map(First()).number_of_samples(3).normal_map(Second()).tolerance(
                 0.25)) == expected);
  BOOST_TEST(seen(np::normal_map(Second()).tolerance(0.25).point_map(First()).number_of_samples(
                 3)) == expected);
}

BOOST_AUTO_TEST_CASE(a_plain_chain_of_cgal_is_understood)
{
  BOOST_TEST(seen(CGAL::parameters::point_map(First())) == "7 0.50 1 0");
  BOOST_TEST(seen(CGAL::parameters::normal_map(Second()).point_map(First())) == "7 0.50 1 1");
  BOOST_TEST(seen(CGAL::parameters::all_default()) == "7 0.50 0 0");
}

BOOST_AUTO_TEST_CASE(our_chain_is_a_chain_of_cgal)
{
  const auto chain = np::number_of_samples(3).number_of_iterations(42).point_map(First());
  using CGAL::parameters::choose_parameter;
  using CGAL::parameters::get_parameter;
  BOOST_TEST(choose_parameter(get_parameter(chain, CGAL::internal_np::number_of_iterations), 1) ==
             42);
  static_assert(
      std::is_same_v<decltype(get_parameter(chain, CGAL::internal_np::point_map)), First>);
}

BOOST_AUTO_TEST_CASE(only_what_was_given_is_given)
{
  const auto chain = np::stiffness(2.0).region_of_interest(std::vector<int>{1});
  using Chain = decltype(chain);
  static_assert(is_given_v<std::decay_t<Chain>, tags::stiffness_t>);
  static_assert(is_given_v<std::decay_t<Chain>, tags::region_of_interest_t>);
  static_assert(!is_given_v<std::decay_t<Chain>, tags::poisson_ratio_t>);
  static_assert(!is_given_v<np::Default_named_parameters, tags::stiffness_t>);
  BOOST_TEST(choose(chain, tags::stiffness, 1.0) == 2.0);
}

BOOST_AUTO_TEST_CASE(the_last_of_two_equal_parameters_counts)
{
  BOOST_TEST(choose(np::stiffness(2.0).tolerance(0.1).stiffness(3.0), tags::stiffness, 1.0) == 3.0);
}

BOOST_AUTO_TEST_CASE(a_reference_wrapper_stands_for_what_it_refers_to)
{
  std::vector<int> region{1, 2, 3};
  const auto chain = np::tolerance(0.1).region_of_interest(std::cref(region)).stiffness(1.0);
  const auto& found = CGAL::parameters::get_parameter_reference(chain, tags::region_of_interest);
  BOOST_TEST(&found == &region);
  const auto copied = np::region_of_interest(region);
  const auto& copy = CGAL::parameters::get_parameter_reference(copied, tags::region_of_interest);
  BOOST_TEST(&copy != &region);
  BOOST_TEST(copy == region);
  double stiffness = 5;
  BOOST_TEST(choose(np::stiffness(std::ref(stiffness)), tags::stiffness, 1.0) == 5.0);
}

BOOST_AUTO_TEST_CASE(values_of_any_type_are_kept)
{
  int calls = 0;
  const auto chain = np::callback([&calls](double) { return ++calls < 2; });
  const std::function<bool(double)> callback =
      CGAL::parameters::get_parameter(chain, CGAL::internal_np::callback);
  BOOST_TEST(callback(0.1));
  BOOST_TEST(!callback(0.2));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Named_function_parameters
