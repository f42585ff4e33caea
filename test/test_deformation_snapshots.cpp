// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Undo and redo: snapshots bring back points, handles and motions, with all bits.

#include <pcs/Point_set_deformation.h>
#include <pcs/deformation/handles/Handle_set.h>
#include <support/deform_cloud.h>
#include <support/exceptions.h>
#include <support/threads.h>

#include <CGAL/property_map.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <random>
#include <string>
#include <tuple>
#include <vector>

namespace test_deformation_snapshots {

namespace {

using pcs::Invalid_input;
using pcs_test::Bar_edit;
using pcs_test::message_has;
using pcs_test::Points;
using pcs_test::Vec3;

using Indices = std::vector<std::size_t>;

const int both_resolutions[] = {1000000, 100};

bool have_equal_bits(const Points& a, const Points& b)
{
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

/// A bar whose coordinates have all bits, with double points, an outlier, a part without samples
/// and a part that most handles do not reach.
struct Cloud
{
  Points rest;
  Indices bottom, middle, top, lid, speck, island;

  explicit Cloud(bool is_shuffled = false)
  {
    rest = pcs_test::box(4, 4, 16, .25);
    std::mt19937 random(7);
    for (Vec3& p : rest)
      p += .02 * pcs_test::random_vector(random);
    bottom = below(.2);
    middle = between(1.8, 2.2);
    top = between(3.8, 5);
    lid = between(3.2, 3.4);
    for (std::size_t i = 0; i < top.front(); i += 3)
      rest.insert(rest.end(), 2, Vec3(rest[i]));
    rest.push_back(rest[top.front()] + Vec3(.6, .7, .8));
    for (int k = 0; k < 4; ++k) {
      speck.push_back(rest.size());
      rest.push_back(Vec3(2.1, .3, 2) + .01 * pcs_test::random_vector(random));
    }
    for (const Vec3& p : pcs_test::box(3, 3, 3, .25)) {
      island.push_back(rest.size());
      rest.push_back(p + Vec3(9, 1e-17, -3) + .02 * pcs_test::random_vector(random));
    }
    for (Vec3& p : rest)
      p = 1.3 * p + Vec3(.1, 7.3, -2.1);
    if (is_shuffled)
      shuffle(random);
  }

private:
  void shuffle(std::mt19937& random)
  {
    Indices order(rest.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::shuffle(order.begin(), order.end(), random);
    Points shuffled(rest.size());
    for (std::size_t i = 0; i < rest.size(); ++i)
      shuffled[order[i]] = rest[i];
    rest = shuffled;
    for (Indices* part : {&bottom, &middle, &top, &lid, &speck, &island})
      for (std::size_t& i : *part)
        i = order[i];
  }

  Indices below(double z) const { return between(-1, z); }
  Indices between(double low, double high) const
  {
    return pcs_test::select(rest, [&](const Vec3& p) { return p.z() > low && p.z() < high; });
  }
};

Indices all_but_the_bottom(const Cloud& cloud)
{
  Indices region(cloud.rest.size());
  std::iota(region.begin(), region.end(), std::size_t(0));
  for (const std::size_t i : cloud.bottom)
    region.erase(std::find(region.begin(), region.end(), i));
  return region;
}

auto parameters(int samples, const Indices& region)
{
  return pcs::parameters::number_of_samples(samples).region_of_interest(region);
}
using Session = pcs::Point_set_deformation<Points, decltype(parameters(0, Indices()))>;

pcs::Similarity random_motion(std::mt19937& random)
{
  return pcs::Similarity::from_translation(pcs_test::random_vector(random)) *
         pcs::Similarity::from_turn(pcs_test::random_vector(random));
}

/// A session and all states that it had.
struct History
{
  struct State
  {
    Session::Snapshot snapshot;
    Points points;
    std::vector<std::size_t> handles;
    std::vector<pcs::Similarity> motions;
    Points centroids; ///< of the handles
    Points continued; ///< after a further motion of the first handle
  };

  Cloud cloud;
  Indices region;
  Points points = cloud.rest;
  Session session;
  std::size_t count = 0; ///< of all handles that were ever added
  std::vector<State> states;

  History(int samples, bool has_region, bool is_shuffled = false)
    : cloud(is_shuffled),
      region(has_region ? all_but_the_bottom(cloud) : all()),
      session(points, parameters(samples, region))
  {
  }

  std::vector<std::size_t> handles()
  {
    std::vector<std::size_t> result;
    for (std::size_t h = 0; h < count + 2; ++h)
      try {
        session.centroid(h);
        result.push_back(h);
      } catch (const Invalid_input&) {
      }
    return result;
  }

  std::size_t add(const Indices& indices, double softness = 0)
  {
    const std::size_t handle = session.add_handle(indices, softness);
    BOOST_REQUIRE(handle == count); // a number is given once
    BOOST_REQUIRE_NO_THROW(session.centroid(handle));
    ++count;
    return handle;
  }

  Points continue_from_here()
  {
    const auto present = handles();
    if (!present.empty())
      session.set_translation(present.front(), Vec3(.3, -.2, .1));
    session.deform();
    return points;
  }

  /// Solves and keeps the state.
  void keep()
  {
    session.deform();
    State s{session.snapshot(), points, handles(), {}, {}, {}};
    for (const std::size_t h : s.handles) {
      s.motions.push_back(session.transformation(h));
      s.centroids.push_back(session.centroid(h));
    }
    s.continued = continue_from_here();
    states.push_back(s);
    check(states.size() - 1);
  }

  /// Restores a state.
  void check(std::size_t k)
  {
    const State& s = states[k];
    session.restore(s.snapshot);
    BOOST_TEST_CONTEXT("state " << k)
    {
      BOOST_REQUIRE(have_equal_bits(points, s.points));
      BOOST_REQUIRE((handles() == s.handles));
      for (std::size_t i = 0; i < s.handles.size(); ++i) {
        const Vec3 probe(1, 2, 3);
        const pcs::Similarity& found = session.transformation(s.handles[i]);
        BOOST_REQUIRE((found(probe) == s.motions[i](probe)));
        BOOST_REQUIRE((session.centroid(s.handles[i]) == s.centroids[i]));
      }
    }
  }

  /// Restores a state and goes on from it.
  void check_continued(std::size_t k)
  {
    check(k);
    BOOST_TEST_CONTEXT("state " << k)
    BOOST_REQUIRE(have_equal_bits(continue_from_here(), states[k].continued));
  }

private:
  Indices all() const
  {
    Indices result(cloud.rest.size());
    std::iota(result.begin(), result.end(), std::size_t(0));
    return result;
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(deformation_snapshots)

BOOST_AUTO_TEST_CASE(handles_come_and_go_in_all_orders)
{
  for (const int samples : both_resolutions)
    for (const bool has_region : {false, true}) {
      std::vector<int> actions{0, 1, 2, 3};
      do {
        History h(samples, has_region);
        h.keep();
        std::size_t feet = h.add(has_region ? h.cloud.lid : h.cloud.bottom);
        const std::size_t top = h.add(h.cloud.top);
        h.session.set_transformation(top, pcs::rotation(Vec3(1, 0, 0), .7, Vec3(0, 7, 0)));
        h.keep();
        for (const int action : actions) {
          if (action == 0)
            h.session.set_translation(h.add(h.cloud.middle), Vec3(.5, 0, 0));
          else if (action == 1)
            h.session.remove_handle(top);
          else if (action == 2) // it has not moved: its points must keep their bits
            h.session.remove_handle(feet);
          else
            h.session.set_translation(h.add(h.cloud.island, 1), Vec3(0, .5, 0));
          h.keep();
        }
        std::vector<std::size_t> order(h.states.size());
        std::iota(order.begin(), order.end(), std::size_t(0));
        std::mt19937 random(unsigned(actions[0] * 4 + actions[1]));
        for (int repetition = 0; repetition < 3; ++repetition) {
          for (const std::size_t k : order)
            h.check(k);
          for (const std::size_t k : order)
            h.check_continued(k);
          std::shuffle(order.begin(), order.end(), random);
        }
      } while (std::next_permutation(actions.begin(), actions.end()));
    }
}

BOOST_AUTO_TEST_CASE(any_state_of_a_random_history_comes_back)
{
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::vector<Points> of_threads;
    for (const int threads : {1, 8}) {
      of_threads.emplace_back();
      pcs_test::with_threads(threads, [&] {
        std::mt19937 random(seed);
        History h(both_resolutions[seed % 2], seed % 4 < 2, seed > 4);
        const Indices* const sets[] = {&h.cloud.middle,
                                       &h.cloud.top,
                                       &h.cloud.lid,
                                       &h.cloud.speck,
                                       &h.cloud.island};
        for (int step = 0; step < 25; ++step) {
          const auto present = h.handles();
          const auto kind = random() % 4;
          if (kind == 0 && !present.empty())
            h.session.remove_handle(present[random() % present.size()]);
          else if (kind == 1 && !h.states.empty())
            h.check(random() % h.states.size());
          else
            try {
              const std::size_t handle = h.add(*sets[random() % 5], random() % 3 ? 0.0 : .5);
              if (random() % 3)
                h.session.set_transformation(handle, random_motion(random));
            } catch (const Invalid_input&) { // the points belong to another handle
            }
          h.keep();
          h.check_continued(random() % h.states.size());
          if (step % 5 == 4) {
            h.session.reset();
            BOOST_REQUIRE(have_equal_bits(h.points, h.cloud.rest));
          }
        }
        for (const History::State& s : h.states)
          of_threads.back().insert(of_threads.back().end(), s.points.begin(), s.points.end());
      });
    }
    BOOST_TEST(have_equal_bits(of_threads[0], of_threads[1]));
  }
}

BOOST_AUTO_TEST_CASE(an_unsolved_handle_is_undone)
{
  for (const int samples : both_resolutions) {
    History h(samples, false);
    h.add(h.cloud.bottom);
    h.session.set_translation(h.add(h.cloud.top), Vec3(1, 0, 0));
    h.keep();
    const std::size_t added = h.add(h.cloud.middle);
    h.session.restore(h.states[0].snapshot);
    BOOST_TEST(h.session.deform().seconds.factorization == 0); // the matrices are still valid
    BOOST_TEST(have_equal_bits(h.points, h.states[0].points));
    h.add(h.cloud.middle);
    h.session.preprocess();
    h.check_continued(0);
    for (const auto handle : {added, added + 1, added + 2}) {
      const auto says_so = message_has("no handle " + std::to_string(handle));
      BOOST_CHECK_EXCEPTION(h.session.remove_handle(handle), Invalid_input, says_so);
      BOOST_CHECK_EXCEPTION(h.session.set_scale(handle, 2), Invalid_input, says_so);
      BOOST_CHECK_EXCEPTION(h.session.centroid(handle), Invalid_input, says_so);
      BOOST_CHECK_EXCEPTION(h.session.transformation(handle), Invalid_input, says_so);
    }
  }
}

BOOST_AUTO_TEST_CASE(another_rest_shape_is_refused_and_changes_nothing)
{
  History h(100, false);
  h.add(h.cloud.bottom);
  const std::size_t top = h.add(h.cloud.top);
  h.keep();
  h.session.set_translation(top, Vec3(1, 0, 0));
  h.keep();
  h.session.accept();
  const std::size_t added = h.add(h.cloud.middle);
  const Points before = h.points;
  for (const History::State& s : h.states)
    BOOST_CHECK_EXCEPTION(h.session.restore(s.snapshot), Invalid_input, message_has("accept()"));
  BOOST_TEST(have_equal_bits(h.points, before));
  const Vec3 centroid = h.session.centroid(added);
  h.states.clear();
  h.keep();
  h.session.remove_handle(added);
  h.keep();
  h.check_continued(0);
  BOOST_TEST((h.session.centroid(added) == centroid));
  h.session.reset();
  BOOST_TEST(have_equal_bits(h.points, before)); // the accepted positions
}

BOOST_AUTO_TEST_CASE(normals_and_gradients_come_back)
{
  using Element = std::tuple<Vec3, Vec3, Eigen::Matrix3d>;
  const Cloud cloud;
  for (const int samples : both_resolutions) {
    std::vector<Element> points;
    std::mt19937 random(3);
    for (const Vec3& p : cloud.rest)
      points.emplace_back(p, pcs_test::random_vector(random), Eigen::Matrix3d::Identity());
    const auto np = pcs::parameters::number_of_samples(samples)
                        .point_map(CGAL::Nth_of_tuple_property_map<0, Element>())
                        .normal_map(CGAL::Nth_of_tuple_property_map<1, Element>())
                        .gradient_map(CGAL::Nth_of_tuple_property_map<2, Element>());
    pcs::Point_set_deformation<std::vector<Element>, std::decay_t<decltype(np)>> session(points,
                                                                                         np);
    const std::vector<Element> rest = points;
    const auto at_rest = session.snapshot();
    const auto feet = session.add_handle(cloud.bottom);
    const auto top = session.add_handle(cloud.top);
    session.set_rotation(top, Vec3(1, 2, 3), 1);
    session.deform();
    const auto bent = session.snapshot();
    const std::vector<Element> bent_points = points;
    session.remove_handle(feet);
    session.set_translation(session.add_handle(cloud.island), Vec3(1, 2, 3));
    session.deform();
    BOOST_TEST((points != bent_points));
    session.restore(bent);
    BOOST_TEST((points == bent_points));
    session.restore(at_rest);
    BOOST_TEST((points == rest));
    BOOST_CHECK_THROW(session.centroid(feet), Invalid_input);
    session.restore(bent);
    BOOST_TEST((points == bent_points));
    session.reset();
    BOOST_TEST((points == rest));
  }
}

BOOST_AUTO_TEST_CASE(the_gradient_of_one_point_is_the_written_one)
{
  using Element = std::tuple<Vec3, Eigen::Matrix3d>;
  for (const int kind : {0, 1, 2, 3}) {
    const Cloud cloud(kind > 1);
    const Indices region = all_but_the_bottom(cloud);
    const int samples = both_resolutions[kind % 2];
    std::vector<Element> points;
    for (const Vec3& p : cloud.rest)
      points.emplace_back(p, Eigen::Matrix3d::Identity());
    const auto np = parameters(samples, region)
                        .point_map(CGAL::Nth_of_tuple_property_map<0, Element>())
                        .gradient_map(CGAL::Nth_of_tuple_property_map<1, Element>());
    pcs::Point_set_deformation session(points, np);
    Points other_points = cloud.rest;
    Session other(other_points, parameters(samples, region)); // without gradients
    std::size_t number_of_inverted = 0;
    const auto check = [&] {
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Matrix3d& written = std::get<1>(points[i]);
        BOOST_REQUIRE((session.deformation_gradient(i) == written));
        BOOST_REQUIRE((other.deformation_gradient(i) == written));
        const Eigen::Matrix3d r = session.local_rotation(i);
        BOOST_REQUIRE((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-12);
        // The polar decomposition: the rest of the gradient is symmetric.
        const Eigen::Matrix3d u =
            written.determinant() > 0 ? Eigen::Matrix3d(r.transpose() * written) : r;
        number_of_inverted += written.determinant() > 0 ? 0 : 1;
        BOOST_REQUIRE((u - u.transpose()).norm() < 1e-10);
      }
    };
    const auto edit = [&](auto& s) {
      const auto top = s.add_handle(cloud.top);
      s.set_rotation(top, Vec3(1, 2, 3), 1);
      s.set_scale(top, 1.2);
      s.add_handle(cloud.lid); // not moved
      s.set_translation(s.add_handle(cloud.middle, .5), Vec3(.4, 0, 0));
      s.set_rotation(s.add_handle(Indices{cloud.speck[0]}), Vec3(1, 0, 0), .5);
      s.deform();
    };
    check(); // the rest shape
    const auto at_rest = session.snapshot();
    const auto other_at_rest = other.snapshot();
    edit(session);
    edit(other);
    check();
    BOOST_TEST((session.deformation_gradient(cloud.lid[0]) == Eigen::Matrix3d::Identity()));
    BOOST_TEST((session.deformation_gradient(cloud.top[0]) != Eigen::Matrix3d::Identity()));
    BOOST_TEST(std::abs(session.deformation_gradient(cloud.top[0]).determinant() - 1.728) < 1e-12);
    session.remove_handle(1);
    session.preprocess();
    BOOST_CHECK_EXCEPTION(session.deformation_gradient(0), Invalid_input, message_has("call it"));
    BOOST_CHECK_EXCEPTION(session.local_rotation(0), Invalid_input, message_has("call it first"));
    session.deform();
    other.remove_handle(1);
    other.deform();
    check();
    session.restore(at_rest);
    other.restore(other_at_rest);
    check();
    BOOST_TEST(number_of_inverted < points.size() / 10);
    const auto says_so = message_has("no point " + std::to_string(points.size()));
    BOOST_CHECK_EXCEPTION(session.local_rotation(points.size()), Invalid_input, says_so);
    BOOST_CHECK_EXCEPTION(session.deformation_gradient(points.size()), Invalid_input, says_so);
  }
}

BOOST_AUTO_TEST_CASE(a_local_map_maps_a_point_and_its_surroundings)
{
  for (const int samples : {1000000, 150}) {
    const pcs_test::Bar_edit edit(12, 48);
    const Points rest = edit.points;
    Points points = rest;
    pcs::Point_set_deformation session(points, pcs::parameters::number_of_samples(samples));
    BOOST_TEST(session.local_map(7).isApprox(Eigen::Affine3d::Identity()));
    for (const auto& handle : edit.handles)
      session.set_transformation(session.add_handle(handle.indices), handle.transformation);
    session.deform();
    double largest = 0, sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const Eigen::Affine3d map = session.local_map(i);
      BOOST_REQUIRE((map * rest[i] - points[i]).norm() < 1e-12);
      BOOST_REQUIRE((map.linear() - session.deformation_gradient(i)).norm() < 1e-15);
      if (i > 0 && (rest[i] - rest[i - 1]).norm() < .1) {
        const double error = (map * rest[i - 1] - points[i - 1]).norm();
        largest = std::max(largest, error);
        sum += error;
        ++count;
      }
    }
    BOOST_TEST_MESSAGE("neighbours: mean error " << sum / double(count) << ", largest " << largest);
    BOOST_TEST(count > 100u);
    BOOST_TEST(sum / double(count) < .02); // a spacing is 0.083
    BOOST_CHECK_EXCEPTION(session.local_map(points.size()), Invalid_input, message_has("no point"));
  }
}

BOOST_AUTO_TEST_CASE(the_energies_of_samples_add_up_and_show_where_a_body_is_strained)
{
  int number_of_runs = 0;
  for (const int samples : {1000000, 1000000, 150}) {
    const bool has_springs = ++number_of_runs > 1;
    const pcs_test::Bar_edit edit(12, 48);
    Points points = edit.points;
    pcs::Point_set_deformation session(
        points,
        pcs::parameters::number_of_samples(samples).do_preserve_volume(has_springs));
    for (const double energy : session.energies_of_samples())
      BOOST_REQUIRE(energy == 0);
    for (const auto& handle : edit.handles)
      session.set_transformation(session.add_handle(handle.indices), handle.transformation);
    const auto report = session.deform();
    const std::vector<double> energies = session.energies_of_samples();
    BOOST_TEST(energies.size() == session.number_of_samples());
    double sum = 0, in_handles = 0;
    for (std::size_t k = 0; k < energies.size(); ++k) {
      BOOST_REQUIRE(energies[k] >= 0);
      sum += energies[k];
      const double height = edit.points[session.point_of_sample(k)].z();
      if (height < .05 || height > 3.95) // well inside a handle
        in_handles = std::max(in_handles, energies[k]);
    }
    BOOST_TEST_MESSAGE(samples << " samples: energy " << report.energy << ", of samples " << sum);
    BOOST_TEST(std::abs(sum - report.energy) < 1e-9 * report.energy);
    // springs through the interior also strain points inside handles
    if (report.number_of_interior_links == 0 && samples > 150)
      BOOST_TEST(in_handles < 1e-20);
    const auto snapshot = session.snapshot();
    session.restore(snapshot);
    BOOST_CHECK_EXCEPTION(session.energies_of_samples(),
                          Invalid_input,
                          message_has("last deform()"));
    session.reset();
    for (const double energy : session.energies_of_samples())
      BOOST_REQUIRE(energy == 0);
    BOOST_CHECK_EXCEPTION(session.point_of_sample(energies.size()),
                          Invalid_input,
                          message_has("no such sample"));
  }
}

BOOST_AUTO_TEST_CASE(a_common_rotation_is_the_local_rotation_of_all_points)
{
  const Bar_edit edit;
  for (const int samples : both_resolutions) {
    Points points = edit.points;
    pcs::Point_set_deformation session(points, pcs::parameters::number_of_samples(samples));
    const pcs::Similarity motion =
        pcs::rotation(Vec3(1, 2, 3), .8, Vec3(0, 0, 2)) * pcs::scaling(1.5, Vec3(0, 0, 0));
    for (const auto& handle : edit.handles)
      session.set_transformation(session.add_handle(handle.indices), motion);
    session.deform();
    for (std::size_t i = 0; i < points.size(); ++i) {
      BOOST_REQUIRE((session.local_rotation(i) - motion.rotation()).norm() < 1e-6);
      BOOST_REQUIRE((session.deformation_gradient(i) - 1.5 * motion.rotation()).norm() < 1e-6);
    }
  }
}

BOOST_AUTO_TEST_CASE(coordinates_in_single_precision_come_back)
{
  const Cloud cloud;
  for (const int samples : both_resolutions) {
    std::vector<Eigen::Vector3f> points;
    for (const Vec3& p : cloud.rest)
      points.push_back(p.cast<float>());
    const std::vector<Eigen::Vector3f> rest = points;
    pcs::Point_set_deformation session(points, pcs::parameters::number_of_samples(samples));
    const auto feet = session.add_handle(cloud.bottom);
    session.set_rotation(session.add_handle(cloud.top), Vec3(0, 0, 1), 1);
    session.deform();
    const std::vector<Eigen::Vector3f> bent = points;
    const auto snapshot = session.snapshot();
    session.remove_handle(feet);
    session.deform();
    BOOST_TEST((points != bent));
    session.restore(snapshot);
    BOOST_TEST((points == bent));
    session.reset();
    BOOST_TEST((points == rest));
  }
}

BOOST_AUTO_TEST_CASE(snapshots_share_the_points_of_handles)
{
  const Cloud cloud;
  const std::function<bool(double)> callback;
  pcs::internal::Progress progress(callback);
  pcs::deformation::Sampling_options options;
  pcs::deformation::Session<CGAL::Sequential_tag> session(cloud.rest, options, nullptr, progress);
  const auto add = [&](const Indices& indices) {
    return session.add_handle({indices.begin(), indices.end()}, 0, "test");
  };
  const std::size_t bottom = add(cloud.bottom), top = add(cloud.top);
  const auto first = session.snapshot();
  add(cloud.middle);
  session.remove_handle(top);
  const auto second = session.snapshot();
  BOOST_REQUIRE(second.handles.size() == 3u);
  BOOST_TEST(second.handles[bottom] == first.handles[bottom]);
  BOOST_TEST(!second.handles[top]);
  session.restore(first);
  const auto third = session.snapshot();
  BOOST_REQUIRE(third.handles.size() == 2u);
  BOOST_TEST(third.handles[bottom] == first.handles[bottom]);
  BOOST_TEST(third.handles[top] == first.handles[top]);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_deformation_snapshots
