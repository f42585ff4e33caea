// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the blending of sample maps with the plain formula in double precision, for rigid
// motions and both kernels.

#include <pcs/core/Similarity.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/body/octree_samples.h>
#include <pcs/deformation/model/Point_blocks.h>
#include <pcs/deformation/upsampling/Upsampling.h>
#include <pcs/deformation/upsampling/blend_block_impl.h>
#include <pcs/internal/instruction_set.h>
#include <support/networks.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cstring>
#include <functional>

namespace test_Upsampling {

namespace {

using pcs::deformation::Affine_map;
using pcs_test::Points;
using pcs_test::Vec3;
using Any_tag = CGAL::Parallel_if_available_tag;
using Row_major = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Affine_map affine(const Eigen::Matrix3d& a, const Vec3& t)
{
  Affine_map map;
  Eigen::Map<Row_major>(map.a) = a;
  Eigen::Map<Vec3>(map.t) = t;
  return map;
}

/// Output functions of the upsampling; the default functions must not be called.
struct Writer
{
  using Write = std::function<void(std::size_t, const Vec3&, const Vec3&, const Eigen::Matrix3d&)>;
  Write write;
  std::function<void(std::size_t)> write_other = [](std::size_t) {
    BOOST_ERROR("every point is blended or held");
  };
  std::function<void(std::size_t)> expect = [](std::size_t) {};
  std::function<bool(std::size_t, const pcs::deformation::Block_output&)> stream = {};
  bool does_stream() const { return bool(stream); }
};

struct Setup
{
  Points points, normals;
  std::vector<Eigen::Matrix3d> gradients; ///< of the last apply()
  std::vector<std::uint32_t> samples;
  pcs::deformation::Sample_links links;
  Points sample_points;
  pcs::deformation::Point_blocks rest;
  pcs::deformation::Upsampling upsampling;

  Setup(const Points& unordered, std::size_t count, bool has_normals)
    : points(pcs_test::in_spatial_order(unordered))
  {
    std::mt19937 random(3);
    for (std::size_t i = 0; i < points.size(); ++i)
      normals.push_back((1 + double(i % 3)) * pcs_test::random_direction(random));
    const auto graph = pcs::neighborhood::nearest_neighbor_graph<CGAL::Sequential_tag>(points, 6);
    samples = pcs::deformation::octree_samples(points, count);
    links = pcs::deformation::link_by_hops<CGAL::Sequential_tag>(points,
                                                                 graph,
                                                                 samples,
                                                                 6,
                                                                 pcs::Sample_weights::compact);
    sample_points = pcs_test::permuted(points, samples);
    rest = pcs::deformation::Point_blocks(points.size(), [&](std::size_t i) { return points[i]; });
    upsampling = pcs::deformation::Upsampling::build(
        points.size(),
        [](std::size_t i) { return i; },
        links);
    if (has_normals)
      rest.set_normals([&](std::size_t i) { return normals[i]; });
  }

  /// Points and samples, which are moved by `maps`.
  pcs::deformation::Upsampling::Input input(const std::vector<Affine_map>& maps) const
  {
    return {rest, sample_points, maps};
  }

  /// Maps that rotate and shift by up to `size`, independently for every sample.
  std::vector<Affine_map> random_maps(double size, unsigned seed) const
  {
    std::mt19937 random(seed);
    std::vector<Affine_map> maps;
    for (std::size_t s = 0; s < samples.size(); ++s)
      maps.push_back(
          affine(pcs::rotation_exp(size * pcs_test::random_vector(random)).toRotationMatrix(),
                 size * pcs_test::random_vector(random)));
    return maps;
  }

  /// Motion of the blocks: by default all are blended from the samples.
  struct Motions
  {
    std::vector<std::uint8_t> is_blended;
    std::vector<std::int32_t> holder;
    std::vector<char> is_written;
    std::vector<pcs::deformation::Handle_map> handles;
    pcs::deformation::Upsampling::Fades fades;

    explicit Motions(const Setup& s)
      : is_blended(s.rest.number_of_blocks(), 255),
        holder(is_blended.size(), pcs::deformation::mixed_block)
    {
    }
    operator pcs::deformation::Upsampling::Block_motions() const
    {
      return {is_blended.data(), holder.data(), is_written.data(), handles.data(), fades};
    }
  };

  template <class Tag>
  void apply(const std::vector<Affine_map>& maps, Points& p, Points& n)
  {
    apply<Tag>(maps, p, n, Motions(*this));
  }
  template <class Tag>
  void apply(const std::vector<Affine_map>& maps, Points& p, Points& n, const Motions& motions)
  {
    p.assign(points.size(), Vec3::Zero());
    n.assign(points.size(), Vec3::Zero());
    gradients.assign(points.size(), Eigen::Matrix3d::Zero());
    const Writer writer{[&](std::size_t i, const Vec3& q, const Vec3& m, const Eigen::Matrix3d& g) {
      p[i] = q;
      n[i] = m;
      gradients[i] = g;
    }};
    upsampling.apply<Tag, true>(input(maps), {}, motions, writer);
  }
};

/// A handle that rotates, scales and shifts.
pcs::Similarity some_motion(std::size_t h)
{
  return pcs::rotation(Vec3(1, double(h), 2), 0.4, Vec3(0.1, 0, 0)) *
         pcs::scaling(1.5, Vec3(0, 0, 0));
}
pcs::deformation::Handle_map handle_map(const pcs::Similarity& motion)
{
  pcs::deformation::Handle_map map;
  Eigen::Map<Row_major>(map.turn) = motion.rotation();
  map.map = affine(motion.scale() * motion.rotation(), motion.translation());
  return map;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Upsampling)

BOOST_AUTO_TEST_CASE(points_normals_and_gradients_follow_the_plain_formula)
{
  Setup s(pcs_test::sphere(1003), 60, true);
  for (const double size : {1.0, 1e-3}) {
    const auto maps = s.random_maps(size, 1);
    Points p, n;
    s.apply<Any_tag>(maps, p, n);
    double error = 0, normal_error = 0, gradient_error = 0;
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
      Vec3 t = Vec3::Zero();
      for (std::size_t b = 0; b < 6; ++b) {
        const auto k = s.links.sample[6 * i + b];
        if (k == pcs::deformation::no_sample)
          continue;
        a += double(s.links.weight[6 * i + b]) * Eigen::Map<const Row_major>(maps[k].a);
        t += double(s.links.weight[6 * i + b]) * Eigen::Map<const Vec3>(maps[k].t);
      }
      error = std::max(error, (p[i] - (a * s.points[i] + t)).norm());
      gradient_error = std::max(gradient_error, (s.gradients[i] - a).norm());
      const Vec3 expected = a.determinant() * a.inverse().transpose() * s.normals[i];
      normal_error =
          std::max(normal_error, (n[i] - s.normals[i].norm() * expected.normalized()).norm());
    }
    // Weights have 16 bits: up to five of them have an error of half a step of 1/65535 each. The
    // error is multiplied by the difference of neighbouring maps, here up to four sizes.
    BOOST_TEST(error < 2.5 / 65535 * 4 * size);
    BOOST_TEST(gradient_error < 2.5 / 65535 * 4 * size);
    BOOST_TEST(normal_error < 1e-3 * size);
    BOOST_TEST_MESSAGE("size " << size << ": points off by " << error << ", normals by "
                               << normal_error);
  }
}

BOOST_AUTO_TEST_CASE(a_rigid_motion_is_exact)
{
  Setup s(pcs_test::sphere(1003), 60, true);
  const Eigen::Matrix3d r = pcs::rotation_exp(Vec3(1, -2, .5)).toRotationMatrix();
  const Vec3 t(10, -20, 30);
  Points p, n;
  s.apply<Any_tag>(std::vector<Affine_map>(60, affine(r, t)), p, n);
  double error = 0, normal_error = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    error = std::max(error, (p[i] - (r * s.points[i] + t)).norm());
    normal_error = std::max(normal_error, (n[i] - r * s.normals[i]).norm());
  }
  BOOST_TEST(error < 1e-12);
  BOOST_TEST(normal_error < 1e-12);
}

BOOST_AUTO_TEST_CASE(points_around_handles_are_drawn_to_where_these_take_them)
{
  using namespace pcs::deformation;
  Setup s(pcs_test::sphere(1003), 60, true);
  const auto maps = s.random_maps(0.3, 7);
  Points p, n;
  s.apply<Any_tag>(maps, p, n);
  const Points without = p, normals_without = n;
  const std::vector<Eigen::Matrix3d> gradients_without = s.gradients;
  const pcs::Similarity motions[] = {some_motion(0), some_motion(1)};
  // The first handle prescribes the first half of every third block, the second one the next point.
  const auto share = [](std::size_t i) { return i % 24 < 4 ? 0.25 * double(i % 24 + 1) : 0.0; };
  std::vector<std::uint32_t> first(1, 0);
  std::vector<Block_fade> entries;
  for (std::size_t block = 0; block < s.rest.number_of_blocks(); ++block) {
    if (block % 3 == 0) {
      entries.push_back({0, {}});
      for (std::size_t l = 0; l < 4; ++l)
        entries.back().weight[l] = share(l);
      entries.push_back({1, {0, 0, 0, 0, 0.5, 0, 0, 0}});
    }
    first.push_back(static_cast<std::uint32_t>(entries.size()));
  }
  Setup::Motions blocks(s);
  blocks.handles = {handle_map(motions[0]), handle_map(motions[1])};
  blocks.fades = {first.data(), entries.data()};
  s.apply<Any_tag>(maps, p, n, blocks);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t h = i % 24 == 4 ? 1 : 0;
    const double w = h == 1 ? 0.5 : share(i);
    const Vec3 position = without[i] + w * (motions[h](s.points[i]) - without[i]);
    Vec3 normal =
        normals_without[i] + w * (motions[h].rotation() * s.normals[i] - normals_without[i]);
    normal *= s.normals[i].norm() / normal.norm();
    const Eigen::Matrix3d linear = motions[h].scale() * motions[h].rotation();
    BOOST_TEST((p[i] - position).norm() < 1e-14);
    BOOST_TEST((n[i] - normal).norm() < 1e-13);
    BOOST_TEST(
        (s.gradients[i] - gradients_without[i] - w * (linear - gradients_without[i])).norm() <
        1e-14);
  }
}

BOOST_AUTO_TEST_CASE(points_that_are_not_blended_are_passed_on)
{
  Setup s(pcs_test::sphere(101), 20, false);
  Setup::Motions blocks(s);
  std::fill(blocks.is_blended.begin(), blocks.is_blended.end(), std::uint8_t(0));
  for (std::size_t i = 0; i < 101; i += 3)
    blocks.is_blended[i / 8] = static_cast<std::uint8_t>(blocks.is_blended[i / 8] | 1u << i % 8);
  std::vector<int> written(101, 0), others(101, 0);
  Writer writer{[&](std::size_t i, const Vec3&, const Vec3& normal, const Eigen::Matrix3d&) {
    ++written[i];
    BOOST_TEST((normal == Vec3::Zero()));
  }};
  writer.write_other = [&](std::size_t i) { ++others[i]; };
  const auto maps = s.random_maps(1, 2);
  s.upsampling.apply<CGAL::Sequential_tag, false>(s.input(maps), {}, blocks, writer);
  for (std::size_t i = 0; i < 101; ++i) {
    BOOST_TEST(written[i] == (i % 3 == 0 ? 1 : 0));
    BOOST_TEST(others[i] == (i % 3 == 0 ? 0 : 1));
  }
}

BOOST_AUTO_TEST_CASE(blocks_move_with_the_handle_that_holds_them)
{
  Setup s(pcs_test::sphere(1003), 60, true);
  const pcs::Similarity motions[] = {some_motion(0), some_motion(1), pcs::Similarity()};
  Setup::Motions blocks(s);
  for (const auto& m : motions)
    blocks.handles.push_back(handle_map(m));
  blocks.is_written = {1, 0, 1};
  for (std::size_t b = 0; b < blocks.holder.size(); ++b)
    blocks.holder[b] = static_cast<std::int32_t>(b % 5) + pcs::deformation::still_block;
  for (std::size_t b = 0; b < blocks.holder.size(); ++b) // irrelevant for blocks of one handle
    if (blocks.holder[b] != pcs::deformation::mixed_block)
      blocks.is_blended[b] = 0;
  Points p, n;
  s.apply<Any_tag>(s.random_maps(1, 3), p, n, blocks);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::int32_t h = blocks.holder[i / 8];
    if (h == pcs::deformation::mixed_block)
      continue;
    const bool is_written = h == 0 || h == 2;
    BOOST_TEST((s.gradients[i] != Eigen::Matrix3d::Zero()) == is_written);
    if (!is_written)
      continue;
    const pcs::Similarity& m = motions[h];
    BOOST_TEST((p[i] - m(s.points[i])).norm() < 1e-15);
    BOOST_TEST((n[i] - m.rotation() * s.normals[i]).norm() < 1e-15);
    BOOST_TEST((s.gradients[i] - m.scale() * m.rotation()).norm() < 1e-15);
    if (h == 2) // points of a resting handle are bit-identical
      BOOST_TEST((p[i] == s.points[i] && n[i] == s.normals[i]));
  }
}

BOOST_AUTO_TEST_CASE(whole_blocks_are_streamed_where_the_writer_takes_them)
{
  constexpr std::size_t n = 1003;
  Setup s(pcs_test::sphere(n), 60, true);
  Setup::Motions blocks(s);
  blocks.is_blended[2] = 0x7f;
  Points p(n, Vec3::Zero()), normals(n, Vec3::Zero());
  std::vector<int> written(n, 0), streamed(n, 0);
  Writer writer{[&](std::size_t i, const Vec3& q, const Vec3& m, const Eigen::Matrix3d&) {
    p[i] = q;
    normals[i] = m;
    ++written[i];
  }};
  writer.write_other = [](std::size_t) {};
  const auto maps = s.random_maps(1, 4);
  s.upsampling.apply<CGAL::Sequential_tag, false>(s.input(maps), {}, blocks, writer);
  BOOST_TEST(std::count(written.begin(), written.end(), 1) == n - 1);
  const Points all = p, all_normals = normals;
  writer.expect = [](std::size_t) { BOOST_ERROR("nothing is to be asked for"); };
  writer.stream = [&](std::size_t first, const pcs::deformation::Block_output& out) {
    if (first == 8)
      return false;
    for (std::size_t l = 0; l < 8; ++l) {
      for (int c = 0; c < 3; ++c) {
        p[first + l][c] = out.position.value[c][l];
        normals[first + l][c] = out.normal.value[c][l];
      }
      ++streamed[first + l];
    }
    return true;
  };
  std::fill(written.begin(), written.end(), 0);
  s.upsampling.apply<CGAL::Sequential_tag, false>(s.input(maps), {}, blocks, writer);
  BOOST_TEST((p == all && normals == all_normals));
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_declined = i / 8 == 1 || i / 8 == 2 || i / 8 == n / 8;
    BOOST_TEST(streamed[i] == (is_declined ? 0 : 1));
    BOOST_TEST(written[i] == (is_declined && i != 23 ? 1 : 0));
  }
}

BOOST_AUTO_TEST_CASE(points_are_announced_before_they_are_written)
{
  constexpr std::size_t n = 1003;
  Setup s(pcs_test::sphere(n), 20, false);
  std::vector<int> announced(n, 0);
  std::size_t late = 0;
  Writer writer{[&](std::size_t i, const Vec3&, const Vec3&, const Eigen::Matrix3d&) {
    late += announced[i] == 0 ? 1 : 0;
  }};
  writer.expect = [&](std::size_t i) { ++announced.at(i); };
  const auto maps = s.random_maps(1, 2);
  s.upsampling.apply<CGAL::Sequential_tag, false>(s.input(maps), {}, Setup::Motions(s), writer);
  BOOST_TEST(*std::max_element(announced.begin(), announced.end()) == 1);
  BOOST_TEST(late < n / 5); // the first blocks, and the incomplete last one
}

BOOST_AUTO_TEST_CASE(sizes_around_the_block_are_right)
{
  for (std::size_t n = 1; n < 20; ++n) {
    Setup s(pcs_test::random_points(n, 4), 3, true);
    BOOST_TEST(s.rest.size() == n);
    const auto identity = affine(Eigen::Matrix3d::Identity(), Vec3::Zero());
    Points p, normals;
    s.apply<Any_tag>(std::vector<Affine_map>(s.samples.size(), identity), p, normals);
    BOOST_TEST(pcs_test::largest_distance(p, s.points) < 1e-15);
    for (std::size_t i = 0; i < n; ++i) {
      BOOST_TEST((s.rest.position(i) == s.points[i]));
      BOOST_TEST((s.rest.normal(i) == s.normals[i]));
    }
  }
}

BOOST_AUTO_TEST_CASE(a_map_that_crushes_the_surface_leaves_finite_normals)
{
  Setup s(pcs_test::sphere(100), 10, true);
  Points p, n;
  for (const Eigen::Matrix3d& a :
       {Eigen::Matrix3d(Eigen::Matrix3d::Zero()), Eigen::Matrix3d(Vec3(1, 0, 0).asDiagonal())}) {
    s.apply<Any_tag>(std::vector<Affine_map>(10, affine(a, Vec3::Zero())), p, n);
    for (const Vec3& v : n)
      BOOST_REQUIRE(v.allFinite());
  }
}

#if PCS_HAS_RUNTIME_DISPATCH
BOOST_AUTO_TEST_CASE(all_kernels_give_the_same_bits)
{
  using namespace pcs::deformation;
  std::mt19937 random(5);
  for (int repetition = 0; repetition < 2000; ++repetition) {
    const auto map = [&] {
      return affine(pcs::rotation_exp(pcs_test::random_vector(random)).toRotationMatrix(),
                    pcs_test::random_vector(random));
    };
    const Affine_map base_affine = map();
    const Vec3 origin = pcs_test::random_vector(random);
    const Base_map base = base_map(base_affine, origin.data());
    const Vec3 frame_origin = 1e3 * pcs_test::random_vector(random);
    std::vector<Map_difference> differences;
    std::vector<Block_entry> entries;
    for (std::uint32_t e = 0; e < random() % 9; ++e) {
      differences.push_back(map_difference(base_affine, map(), origin.data()));
      Block_entry entry{e, {}};
      for (auto& w : entry.weight)
        w = static_cast<std::uint16_t>(random() % 8192);
      entries.push_back(entry);
    }
    Lane_vectors rest, normal;
    for (int c = 0; c < 3; ++c)
      for (std::size_t l = 0; l < lanes; ++l) {
        rest.value[c][l] = pcs_test::uniform(random);
        normal.value[c][l] = pcs_test::uniform(random);
      }
    std::vector<Handle_map> handles(3);
    std::vector<Block_fade> fades;
    for (Handle_map& handle : handles) {
      handle.map = map();
      std::copy_n(map().a, 9, handle.turn);
    }
    for (std::uint32_t h = 0; h < random() % 3; ++h) {
      fades.push_back({h, {}});
      for (auto& w : fades.back().weight)
        w = random() % 2 ? pcs_test::uniform(random) : 0;
    }
    const Block_input in{&base,
                         differences.data(),
                         entries.data(),
                         entries.data() + entries.size(),
                         &rest,
                         &normal,
                         0.25,
                         frame_origin.data(),
                         fades.data(),
                         fades.data() + fades.size(),
                         handles.data(),
                         repetition % 4 == 3 ? &handles[2] : nullptr};
    Block_output all{};
    internal::blend_block_default<Blend_outputs::gradients>(in, all);
    const auto check = [&](Blend_block gradients, Blend_block normals, Blend_block positions) {
      Block_output out{};
      gradients(in, out);
      BOOST_REQUIRE(std::memcmp(&all, &out, sizeof all) == 0);
      out = Block_output{};
      normals(in, out);
      BOOST_REQUIRE(std::memcmp(&all.normal, &out.normal, sizeof all.normal) == 0);
      BOOST_REQUIRE(std::memcmp(&all.position, &out.position, sizeof all.position) == 0);
      out = Block_output{};
      positions(in, out);
      BOOST_REQUIRE(std::memcmp(&all.position, &out.position, sizeof all.position) == 0);
    };
    check(internal::blend_block_default<Blend_outputs::gradients>,
          internal::blend_block_default<Blend_outputs::normals>,
          internal::blend_block_default<Blend_outputs::positions>);
    if (pcs::internal::has_avx2())
      check(internal::blend_block_avx2<Blend_outputs::gradients>,
            internal::blend_block_avx2<Blend_outputs::normals>,
            internal::blend_block_avx2<Blend_outputs::positions>);
    if (pcs::internal::has_avx512())
      check(internal::blend_block_avx512<Blend_outputs::gradients>,
            internal::blend_block_avx512<Blend_outputs::normals>,
            internal::blend_block_avx512<Blend_outputs::positions>);
  }
}
#endif

BOOST_AUTO_TEST_CASE(every_number_of_threads_gives_the_same_bits)
{
  Setup s(pcs_test::sphere(20000), 300, true);
  const auto maps = s.random_maps(0.5, 6);
  Points p, n, q, m;
  s.apply<CGAL::Sequential_tag>(maps, p, n);
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      s.apply<Any_tag>(maps, q, m);
      BOOST_TEST((p == q && n == m));
    });
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Upsampling
