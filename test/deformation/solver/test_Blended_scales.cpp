// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Scale field of a rod between two scaled handles, and the fraction of least energy.

#include <pcs/core/Similarity.h>
#include <pcs/deformation/solver/Blended_scales.h>
#include <support/networks.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_Blended_scales {

using namespace pcs::deformation;
using pcs::Similarity;
using Scales = Blended_scales<CGAL::Sequential_tag>;

namespace {

/// A chain of nodes along a direction; its ends are handles.
struct Rod
{
  static constexpr std::size_t size = 9;
  Vec3 along = Vec3(1, 2, 2) / 3;
  Elastic_network network;
  Node_constraints constraints;
  Elastic_factors factors;

  Rod()
  {
    network.surface = pcs_test::path_graph(size);
    for (std::size_t i = 0; i < size; ++i)
      network.rest.push_back(double(i) * along);
    constraints.handle_of_node.assign(size, free_node);
    constraints.handle_of_node.front() = 0;
    constraints.handle_of_node.back() = 1;
    constraints.softness_weight = {0, 0};
    BOOST_TEST_REQUIRE(factors.factorize<CGAL::Sequential_tag>(network, constraints, 1));
  }
  void begin(double first, double last, Scales& scales) const
  {
    scales.begin(network,
                 constraints,
                 factors,
                 {Similarity::from_scale(first), Similarity::from_scale(last)});
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(blended_scales)

BOOST_AUTO_TEST_CASE(scales_are_geometric_means_and_lengths_grow_by_a_fraction_of_them)
{
  const Rod rod;
  Scales scales;
  rod.begin(1, 16, scales);
  for (const double share : {0.0, 0.5, 1.0}) {
    scales.set_share(share);
    BOOST_TEST_REQUIRE(scales.growth().size() == Rod::size);
    for (std::size_t i = 1; i + 1 < Rod::size; ++i) {
      const double scale = std::pow(16, double(i) / 8);
      const Eigen::Matrix3d& growth = scales.growth()[i];
      const Vec3 across = rod.along.unitOrthogonal();
      BOOST_TEST((growth * across - scale * across).norm() < 1e-9);
      BOOST_TEST((growth * rod.along - (1 + share * (scale - 1)) * rod.along).norm() < 1e-9);
    }
    // handles are scaled as a whole
    BOOST_TEST((scales.growth().back() - 16 * Eigen::Matrix3d::Identity()).norm() < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(a_negative_fraction_does_not_invert_edges)
{
  const Rod rod;
  Scales scales;
  rod.begin(1, 16, scales);
  scales.set_share(-1);
  for (std::size_t i = 1; i + 1 < Rod::size; ++i)
    BOOST_TEST(rod.along.dot(scales.growth()[i] * rod.along) >= 0.25 - 1e-12);
}

BOOST_AUTO_TEST_CASE(equal_scales_have_no_direction)
{
  const Rod rod;
  Scales scales;
  rod.begin(3, 3, scales);
  for (const Eigen::Matrix3d& growth : scales.growth())
    BOOST_TEST((growth - 3 * Eigen::Matrix3d::Identity()).norm() < 1e-9);
  rod.begin(1, 1, scales);
  BOOST_TEST(scales.growth().empty());
}

BOOST_AUTO_TEST_CASE(the_fraction_of_least_energy_is_that_of_a_parabola)
{
  for (const double best : {-3., -0.4, 0.3, 0.75, 5.}) {
    const auto energy = [&](double share) { return 2 + 7 * (share - best) * (share - best); };
    BOOST_TEST(std::abs(Scales::share_of_least_energy(energy(0), energy(0.5), energy(1)) -
                        std::min(1.0, std::max(-1.0, best))) < 1e-9);
  }
  BOOST_TEST(Scales::share_of_least_energy(2, 2, 2) == 1);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Blended_scales
