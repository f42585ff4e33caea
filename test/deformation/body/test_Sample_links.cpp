// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the samples of each point with a brute-force search, and tests the smoothness of the
// weights.

#include <pcs/deformation/body/Sample_links.h>
#include <pcs/deformation/body/octree_samples.h>
#include <support/networks.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <map>
#include <set>

namespace test_Sample_links {

namespace {

using pcs::Sample_weights;
using pcs::deformation::Sample_links;
using pcs_test::Points;
using pcs_test::Vec3;
using Tag = CGAL::Sequential_tag;
using Any_tag = CGAL::Parallel_if_available_tag;

struct Sampled
{
  Points points;
  pcs::neighborhood::Proximity_graph graph;
  std::vector<std::uint32_t> samples;
  pcs::deformation::Sample_regions regions;
  pcs::deformation::Weighted_graph touching;

  Sampled(const Points& unordered, std::size_t count)
    : points(pcs_test::in_spatial_order(unordered)),
      graph(pcs::neighborhood::nearest_neighbor_graph<Tag>(points, 6)),
      samples(pcs::deformation::octree_samples(points, count)),
      regions(pcs::deformation::grow_regions(points, graph, samples))
  {
    double unit = 0;
    touching = pcs::deformation::sample_graph(points, graph, samples, regions, unit);
  }
  Sample_links by_regions(std::size_t k, Sample_weights weights) const
  {
    return pcs::deformation::link_by_regions<Any_tag>(points,
                                                      samples,
                                                      regions,
                                                      touching,
                                                      k,
                                                      weights);
  }
  Sample_links by_hops(std::size_t k, Sample_weights weights) const
  {
    return pcs::deformation::link_by_hops<Any_tag>(points, graph, samples, k, weights);
  }
};

/// Weights are in [0, 1] and sum to one, samples are distinct, and unused entries are last.
void check_rows(const Sample_links& links, std::size_t n)
{
  BOOST_REQUIRE(links.sample.size() == n * links.k);
  BOOST_REQUIRE(links.weight.size() == n * links.k);
  std::size_t faults = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0;
    std::set<std::uint32_t> seen;
    bool has_ended = false;
    for (std::size_t b = 0; b < links.k; ++b) {
      const auto s = links.sample[i * links.k + b];
      const double w = links.weight[i * links.k + b];
      if (s == pcs::deformation::no_sample) {
        has_ended = true;
        faults += w != 0 ? 1 : 0;
        continue;
      }
      faults += has_ended || !seen.insert(s).second || !(w >= 0 && w <= 1) ? 1 : 0;
      sum += w;
    }
    faults += std::abs(sum - 1) > 1e-6 ? 1 : 0;
  }
  BOOST_TEST(faults == 0u);
}

/// The documented weights of the nearest `k` of the given distances.
std::map<std::uint32_t, double>
expected_weights(std::vector<std::pair<double, std::uint32_t>> candidates,
                 std::size_t k,
                 Sample_weights kind)
{
  std::sort(candidates.begin(), candidates.end());
  const std::size_t count = std::min(k, candidates.size());
  const double support =
      candidates.size() > k ? candidates[k].first : 1.5 * candidates.back().first;
  std::map<std::uint32_t, double> weights;
  double sum = 0;
  for (std::size_t b = 0; b < count; ++b) {
    const double r = candidates[b].first / support;
    const double w =
        kind == Sample_weights::compact ? (1 - r * r) * (1 - r * r) : 1 / std::max(r * r, 1e-24);
    weights[candidates[b].second] = w;
    sum += w;
  }
  for (auto& w : weights)
    w.second /= sum;
  return weights;
}

/// The largest change of weights between two linked points.
double largest_jump(const Sampled& s, const Sample_links& links)
{
  double largest = 0;
  for (std::size_t i = 0; i < s.points.size(); ++i)
    for (auto j = s.graph.begin(i); j != s.graph.end(i); ++j) {
      std::map<std::uint32_t, double> change;
      for (std::size_t b = 0; b < links.k; ++b) {
        change[links.sample[i * links.k + b]] += links.weight[i * links.k + b];
        change[links.sample[*j * links.k + b]] -= links.weight[*j * links.k + b];
      }
      double sum = 0;
      for (const auto& c : change)
        sum += std::abs(c.second);
      largest = std::max(largest, sum);
    }
  return largest;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Sample_links)

BOOST_AUTO_TEST_CASE(nearest_samples_of_eight_points_are_those_of_each)
{
  using namespace pcs::deformation::internal;
  for (const std::size_t k : {2u, 6u, 9u})
    for (const bool is_grid : {false, true}) { // equal distances on grids
      const Points samples = is_grid ? pcs_test::plate(6, 6, 0.25) : pcs_test::random_points(49, 3);
      std::vector<std::uint32_t> ring;
      for (std::uint32_t s = 0; s < samples.size(); s += s % 3 == 0 ? 1 : 2)
        ring.push_back(s);
      const Points points = is_grid ? pcs_test::plate(7, 6, 0.125) : pcs_test::random_points(50, 4);
      Ring_search search(samples, k);
      std::vector<Sample_candidate> found, expected;
      for (std::size_t first = 0; first < points.size(); first += Ring_search::size) {
        const std::size_t count = std::min<std::size_t>(8, points.size() - first);
        search.start(points.data() + first, count, ring[first % ring.size()], ring);
        for (std::size_t l = 0; l < count; ++l) {
          search.nearest(l, found);
          nearest_samples(points[first + l], samples, ring, k, expected);
          BOOST_TEST_REQUIRE(found.size() == expected.size());
          for (std::size_t b = 0; b < found.size(); ++b) {
            BOOST_TEST(found[b].sample == expected[b].sample);
            BOOST_TEST(found[b].squared_distance == expected[b].squared_distance);
          }
        }
      }
    }
}

BOOST_AUTO_TEST_CASE(the_nearest_of_the_two_rings_move_a_point)
{
  for (const Points& cloud : {pcs_test::random_points(800, 1), pcs_test::sphere(1500)})
    for (const std::size_t k : {1u, 4u, 6u, 32u})
      for (const auto kind : {Sample_weights::compact, Sample_weights::inverse_square}) {
        const Sampled s(cloud, 60);
        const auto links = s.by_regions(k, kind);
        check_rows(links, s.points.size());
        double error = 0;
        for (std::size_t i = 0; i < s.points.size(); ++i) {
          const auto own = s.regions.sample_of_point[i];
          std::set<std::uint32_t> ring{own};
          for (auto a = s.touching.begin(own); a != s.touching.end(own); ++a) {
            ring.insert(*a);
            ring.insert(s.touching.begin(*a), s.touching.end(*a));
          }
          std::vector<std::pair<double, std::uint32_t>> candidates;
          for (const auto t : ring)
            candidates.emplace_back((s.points[s.samples[t]] - s.points[i]).norm(), t);
          auto weights = expected_weights(candidates, k, kind);
          for (std::size_t b = 0; b < k; ++b) {
            const auto t = links.sample[i * k + b];
            if (t != pcs::deformation::no_sample)
              error = std::max(error, std::abs(weights[t] - double(links.weight[i * k + b])));
          }
        }
        // 16-bit integers; the nearest sample takes the rounding error
        BOOST_TEST(error < 0.51 * double(k) / 65535);
      }
}

BOOST_AUTO_TEST_CASE(no_sample_with_fewer_hops_is_left_out)
{
  const std::size_t k = 5;
  const Sampled s(pcs_test::sphere(1200), 50);
  for (const auto kind : {Sample_weights::compact, Sample_weights::inverse_square}) {
    const auto links = s.by_hops(k, kind);
    check_rows(links, s.points.size());
    std::vector<std::vector<std::size_t>> hops; // per sample
    for (const auto source : s.samples) {
      std::vector<std::size_t> distance(s.points.size(), s.points.size());
      std::vector<std::size_t> front{source};
      distance[source] = 0;
      for (std::size_t at = 0; at < front.size(); ++at)
        for (auto j = s.graph.begin(front[at]); j != s.graph.end(front[at]); ++j)
          if (distance[*j] == s.points.size()) {
            distance[*j] = distance[front[at]] + 1;
            front.push_back(*j);
          }
      hops.push_back(distance);
    }
    std::size_t faults = 0;
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      std::vector<std::size_t> all;
      for (const auto& h : hops)
        all.push_back(h[i]);
      std::sort(all.begin(), all.end());
      // The first k + 1 samples are candidates; the spatially farthest of them only limits the
      // support.
      for (std::size_t b = 0; b < k; ++b)
        faults += hops[links.sample[i * k + b]][i] > all[k] ? 1 : 0;
    }
    BOOST_TEST(faults == 0u);
  }
}

BOOST_AUTO_TEST_CASE(a_sample_is_moved_by_itself_alone_or_nearly_so)
{
  const Sampled s(pcs_test::sphere(1200), 50);
  const auto links = s.by_regions(6, Sample_weights::inverse_square);
  for (std::size_t t = 0; t < s.samples.size(); ++t) {
    BOOST_TEST(links.sample[s.samples[t] * 6] == t);
    BOOST_TEST(links.weight[s.samples[t] * 6] > 0.999f);
  }
  const auto compact = s.by_regions(6, Sample_weights::compact);
  for (std::size_t t = 0; t < s.samples.size(); ++t)
    BOOST_TEST(compact.sample[s.samples[t] * 6] == t); // the nearest sample is first
}

BOOST_AUTO_TEST_CASE(compact_weights_are_continuous_and_the_texts_jump)
{
  // For a cloud of four times the density, a continuous function changes by a quarter between
  // neighbours.
  double compact[2], inverse[2];
  for (int level = 0; level < 2; ++level) {
    const int n = level == 0 ? 60 : 240;
    const Sampled s(pcs_test::plate(n, n, 20.0 / n), 49);
    compact[level] = largest_jump(s, s.by_regions(6, Sample_weights::compact));
    inverse[level] = largest_jump(s, s.by_regions(6, Sample_weights::inverse_square));
    BOOST_TEST_MESSAGE("largest jump of weights, compact " << compact[level] << ", inverse square "
                                                           << inverse[level]);
  }
  BOOST_TEST(compact[1] < 0.4 * compact[0]); // 0.25 with all samples as candidates
  BOOST_TEST(inverse[1] > 0.4 * inverse[0]);
}

BOOST_AUTO_TEST_CASE(fewer_samples_than_k_all_move_every_point)
{
  for (const std::size_t count : {1u, 2u, 3u}) {
    const Sampled s(pcs_test::random_points(100, 2), count);
    for (const auto& links :
         {s.by_regions(6, Sample_weights::compact), s.by_hops(6, Sample_weights::inverse_square)}) {
      check_rows(links, 100);
      for (std::size_t i = 0; i < 100; ++i)
        for (std::size_t b = 0; b < 6; ++b)
          BOOST_REQUIRE((links.sample[i * 6 + b] != pcs::deformation::no_sample) == (b < count));
    }
  }
}

BOOST_AUTO_TEST_CASE(points_in_parts_without_sample_are_moved_by_none)
{
  Points points = pcs_test::plate(20, 20, 1);
  for (int i = 0; i < 8; ++i)
    points.push_back(Vec3(1000 + i, 0, 0));
  const Sampled s(points, 2);
  std::size_t none = 0;
  for (const auto& links :
       {s.by_regions(3, Sample_weights::compact), s.by_hops(3, Sample_weights::compact)}) {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (links.sample[i * 3] == pcs::deformation::no_sample) {
        BOOST_TEST((s.regions.sample_of_point[i] == pcs::deformation::no_sample));
        ++none;
      }
  }
  BOOST_TEST_MESSAGE(none << " points without samples");
}

BOOST_AUTO_TEST_CASE(every_number_of_threads_gives_the_same_bits)
{
  const Sampled s(pcs_test::sphere(20000), 500);
  const auto regions = pcs::deformation::link_by_regions<Tag>(s.points,
                                                              s.samples,
                                                              s.regions,
                                                              s.touching,
                                                              6,
                                                              Sample_weights::compact);
  const auto hops =
      pcs::deformation::link_by_hops<Tag>(s.points, s.graph, s.samples, 6, Sample_weights::compact);
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      const auto a = s.by_regions(6, Sample_weights::compact);
      const auto b = s.by_hops(6, Sample_weights::compact);
      BOOST_TEST((a.sample == regions.sample && a.weight == regions.weight));
      BOOST_TEST((b.sample == hops.sample && b.weight == hops.weight));
    });
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Sample_links
