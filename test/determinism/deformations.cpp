// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Results of the functions of deformation, splats and registration.

#include "Results.h"
#include <pcs/Point_set_deformation.h>
#include <pcs/deform_point_set.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/registration/fit_point_set.h>
#include <pcs/splats/transform_splats.h>

#include <CGAL/property_map.h>

#include <numeric>

namespace pcs_test {
namespace deformations {

namespace np = pcs::parameters;

/// Points on a pillar with attributes; an element of `indices` is the number of a point.
template <class FT>
struct Pillar
{
  using Kernel = CGAL::Simple_cartesian<FT>;
  using Matrix = Eigen::Matrix<FT, 3, 3>;

  std::vector<typename Kernel::Point_3> points;
  std::vector<typename Kernel::Vector_3> normals;
  std::vector<Matrix> tensors, gradients;
  std::vector<std::size_t> indices, feet, head;

  explicit Pillar(std::size_t n)
    : tensors(n, Matrix::Identity()), gradients(n, Matrix::Identity()), indices(n)
  {
    std::iota(indices.begin(), indices.end(), std::size_t(0));
    for (const std::size_t i : indices) {
      const double angle = 2.399963229728653 * static_cast<double>(i);
      const double bump = 1 + 0.1 * std::sin(0.01 * static_cast<double>(i));
      normals.emplace_back(FT(std::cos(angle)), FT(std::sin(angle)), FT(0));
      points.emplace_back(FT(bump * std::cos(angle)),
                          FT(bump * std::sin(angle)),
                          FT(10 * (double(i) + 0.5) / double(n)));
      if (i < n / 10)
        feet.push_back(i);
      else if (i >= n - n / 10)
        head.push_back(i);
    }
  }

  auto maps()
  {
    return np::point_map(CGAL::make_property_map(points))
        .normal_map(CGAL::make_property_map(normals))
        .tensor_map(CGAL::make_property_map(tensors))
        .gradient_map(CGAL::make_property_map(gradients));
  }

  std::vector<pcs::Deformation_handle> bend() const
  {
    return {{feet, pcs::Similarity(), 0},
            {head, pcs::rotation(pcs_test::Kernel::Vector_3(0, 1, 0), 1.2, Point(5, 0, 5)), 0.5}};
  }
};

void add(const pcs::Deformation_report& r, Results& results)
{
  results << r.status << r.number_of_samples << r.number_of_interior_links << r.number_of_short_cuts
          << r.number_of_components << r.number_of_iterations << r.initial_energy << r.energy;
}

template <class FT>
void add(const Pillar<FT>& pillar, Results& results)
{
  results << pillar.points << pillar.normals << pillar.tensors << pillar.gradients;
}

template <class Tag, class FT = double, class Change>
void deform(const char* name, std::size_t n, const Change& change, Results& results)
{
  Pillar<FT> pillar(n);
  const auto report =
      pcs::deform_point_set<Tag>(pillar.indices, pillar.bend(), change(pillar.maps()));
  add(report, results(name));
  add(pillar, results);
}

template <class Tag>
void deform_session(Results& results)
{
  Pillar<double> pillar(3000), other(500);
  const auto maps = np::point_map(CGAL::make_property_map(pillar.points)).number_of_samples(400);
  using Session =
      pcs::Point_set_deformation<std::vector<std::size_t>, std::decay_t<decltype(maps)>, Tag>;
  Session session(pillar.indices, maps);
  session.add_handle(pillar.feet);
  const auto head = session.add_handle(pillar.head, 0.2);
  results("Point_set_deformation");
  for (int frame = 1; frame <= 5; ++frame) {
    session.set_rotation(head, Vector(1, 0, 0), 0.1 * frame);
    add(session.deform(pcs::Solver_start::warm), results);
  }
  results << pillar.points << session.energies_of_samples();
  session.accept();
  std::vector<Point> targets;
  for (const std::size_t i : pillar.head)
    targets.emplace_back(1.3 * pillar.points[i].x(),
                         0.8 * pillar.points[i].y(),
                         pillar.points[i].z() + 1);
  session.set_targets(head, targets);
  add(session.deform(), results);
  session.apply(other.indices, np::point_map(CGAL::make_property_map(other.points)));
  results << pillar.points << other.points;
  for (std::size_t i = 0; i < pillar.points.size(); i += 100)
    results << session.local_map(i).matrix() << session.deformation_gradient(i);
}

template <class Tag>
void move_splats(Results& results)
{
  constexpr std::size_t n = 3000, harmonics = 45;
  std::vector<std::vector<float>> columns(7 + harmonics, std::vector<float>(n));
  std::vector<Eigen::Matrix3d> gradients(n);
  pcs::internal::Random_stream random(5, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (auto& column : columns)
      column[i] = static_cast<float>(random.uniform() - 0.5);
    for (Eigen::Index k = 0; k < 9; ++k)
      gradients[i](k) = random.uniform() - 0.5;
  }
  pcs::splats::Splat_columns<float> splats;
  for (std::size_t k = 0; k < 4; ++k)
    splats.rotation[k] = columns[k].data();
  for (std::size_t k = 0; k < 3; ++k)
    splats.log_scale[k] = columns[4 + k].data();
  for (std::size_t k = 0; k < harmonics; ++k)
    splats.harmonics.push_back(columns[7 + k].data());
  results("splats::transform_splats")
      << pcs::splats::transform_splats<Tag>(gradients, splats) << columns;
}

template <class Tag>
void fit(Results& results)
{
  Pillar<double> source(1200);
  std::vector<Point> target;
  for (const Point& p : Pillar<double>(1500).points) {
    const double r = 10 - p.x(), angle = 0.1 * p.z();
    target.emplace_back(10 - r * std::cos(angle), p.y(), r * std::sin(angle));
  }
  const auto report =
      pcs::fit_point_set<Tag>(source.indices,
                              target,
                              np::point_map(CGAL::make_property_map(source.points)));
  results("fit_point_set") << report.number_of_matched << report.number_of_iterations
                           << report.median_residual << report.rms_residual
                           << report.rms_displacement << source.points;
}

template <class Tag>
void record(Results& results)
{
  deform<Tag>(
      "deform_point_set, all points",
      1500,
      [](auto p) { return p; },
      results);
  deform<Tag>(
      "deform_point_set, 500 samples",
      6000,
      [](auto p) { return p.number_of_samples(500); },
      results);
  deform<Tag>(
      "deform_point_set, Poisson ratio 0.4",
      1500,
      [](auto p) { return p.poisson_ratio(0.4); },
      results);
  deform<Tag>(
      "deform_point_set, published blending",
      4000,
      [](auto p) {
        return p.number_of_samples(300)
            .sample_search(pcs::Sample_search::breadth_first_hops)
            .sample_weights(pcs::Sample_weights::inverse_square);
      },
      results);
  deform<Tag, float>(
      "deform_point_set, float",
      3000,
      [](auto p) { return p.number_of_samples(300); },
      results);
  deform_session<Tag>(results);
  move_splats<Tag>(results);
  fit<Tag>(results);
}

} // namespace deformations

void record_deformations(bool is_sequential, Results& results)
{
  if (is_sequential)
    deformations::record<Sequential>(results);
  else
    deformations::record<CGAL::Parallel_if_available_tag>(results);
}

} // namespace pcs_test
