// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The step of a grid is found among random lengths; smooth distributions have no step.

#include <pcs/skeleton/registration/Periodogram.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_Periodogram {

using namespace pcs::skeleton;

namespace {

constexpr std::size_t number_of_pairs = 2000;
constexpr double reach = 1;

/// Lengths of pairs for each hypothesis: random, but for some hypotheses multiples of a step with
/// an error of a tenth of it.
class Lengths
{
public:
  explicit Lengths(std::size_t number_of_hypotheses)
  {
    for (std::size_t h = 0; h < number_of_hypotheses; ++h) {
      m_lengths.emplace_back();
      for (std::size_t k = 0; k < number_of_pairs; ++k)
        m_lengths.back().push_back(float(reach * m_uniform(m_random)));
    }
  }
  void set_step(std::size_t hypothesis, double step)
  {
    for (float& l : m_lengths[hypothesis]) {
      const double multiple = std::floor(reach / step * m_uniform(m_random));
      l = float(step * (multiple + 0.1 * (2 * m_uniform(m_random) - 1)));
    }
  }

  Periodogram periodogram() const
  {
    Periodogram result(0.02, 0.1, 1.01, 12, reach);
    result.compute<CGAL::Sequential_tag>(m_lengths.size(), number_of_pairs, [&](std::size_t h) {
      return [this, h](std::size_t pair) { return m_lengths[h][pair]; };
    });
    return result;
  }

private:
  std::mt19937 m_random{5};
  std::uniform_real_distribution<double> m_uniform{0, 1};
  std::vector<std::vector<float>> m_lengths;
};

} // namespace

BOOST_AUTO_TEST_SUITE(periodogram)

BOOST_AUTO_TEST_CASE(the_step_of_one_hypothesis_among_many_is_found)
{
  for (const double step : {0.025, 0.04, 0.07}) {
    Lengths lengths(30);
    lengths.set_step(17, step);
    const Step_peak peak = lengths.periodogram().highest();
    BOOST_TEST(peak.hypothesis == 17u);
    BOOST_TEST(std::abs(peak.step / step - 1) < 0.01);
    BOOST_TEST(peak.contrast > 0.6); // mean cosine of the errors: sin(0.2 pi) / (0.2 pi) = 0.94
    BOOST_TEST(peak.contrast < 1.5);
  }
}

BOOST_AUTO_TEST_CASE(random_lengths_have_no_outstanding_step)
{
  const auto never = [](std::size_t, std::size_t) { return false; };
  BOOST_TEST(Lengths(30).periodogram().outstanding(8, 10, never).empty());
}

BOOST_AUTO_TEST_CASE(of_alike_hypotheses_only_the_best_is_outstanding)
{
  Lengths lengths(30);
  lengths.set_step(3, 0.04);
  lengths.set_step(20, 0.07);
  const Periodogram periodogram = lengths.periodogram();
  const auto are_equal = [](std::size_t g, std::size_t h) { return g == h; };
  const auto peaks = periodogram.outstanding(8, 10, are_equal);
  BOOST_TEST_REQUIRE(peaks.size() == 2u);
  BOOST_TEST(peaks[0].score >= peaks[1].score);
  BOOST_TEST(peaks[0].hypothesis + peaks[1].hypothesis == 23u);
  BOOST_TEST(periodogram.outstanding(8, 1, are_equal).size() == 1u);
  const auto always = [](std::size_t, std::size_t) { return true; };
  const auto best = periodogram.outstanding(8, 10, always);
  BOOST_TEST_REQUIRE(best.size() == 1u);
  BOOST_TEST(best[0].hypothesis == peaks[0].hypothesis);
}

BOOST_AUTO_TEST_CASE(lengths_much_shorter_than_all_steps_have_no_contrast)
{
  Periodogram periodogram(0.02, 0.1, 1.01, 12, reach);
  periodogram.compute<CGAL::Sequential_tag>(1, number_of_pairs, [](std::size_t) {
    return [](std::size_t) { return 1e-4F; };
  });
  BOOST_TEST(periodogram.highest().contrast < 0.05); // the mean cosine itself is nearly 1
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Periodogram
