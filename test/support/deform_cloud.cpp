// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Runs one edit of a test.

#include <support/deform_cloud.h>

#include <CGAL/property_map.h>

#include <random>
#include <utility>

namespace pcs_test {

namespace {

using Element = std::pair<Vec3, Vec3>;
using Elements = std::vector<Element>;

template <class Tag, class NamedParameters>
pcs::Deformation_report run(Elements& elements, const Handles& handles, const NamedParameters& np)
{
  return pcs::deform_point_set<Tag>(elements, handles, np);
}

template <class NamedParameters>
pcs::Deformation_report dispatch(Elements& elements,
                                 const Handles& handles,
                                 const Options& options,
                                 const NamedParameters& np)
{
  return options.is_sequential ? run<CGAL::Sequential_tag>(elements, handles, np)
                               : run<CGAL::Parallel_if_available_tag>(elements, handles, np);
}

} // namespace

Points arbitrary_normals(std::size_t n)
{
  std::mt19937 random(77);
  Points normals(n);
  for (Vec3& v : normals)
    v = random_direction(random);
  return normals;
}

Deformed
deform(const Points& points, const Handles& handles, const Options& options, const Points& normals)
{
  const Points rest = normals.empty() ? arbitrary_normals(points.size()) : normals;
  Elements elements;
  for (std::size_t i = 0; i < points.size(); ++i)
    elements.emplace_back(points[i], rest[i]);
  const auto np = pcs::parameters::point_map(CGAL::First_of_pair_property_map<Element>())
                      .normal_map(CGAL::Second_of_pair_property_map<Element>())
                      .number_of_samples(options.number_of_samples)
                      .number_of_neighbors(options.number_of_neighbors)
                      .number_of_sample_neighbors(options.number_of_sample_neighbors)
                      .number_of_iterations(options.number_of_iterations)
                      .tolerance(options.tolerance)
                      .stiffness(options.stiffness)
                      .poisson_ratio(options.poisson_ratio)
                      .do_preserve_volume(options.do_preserve_volume)
                      .sample_search(options.sample_search)
                      .sample_weights(options.sample_weights)
                      .rotation_field(options.rotation_field)
                      .callback(options.callback ? options.callback : [](double) { return true; });
  Deformed result;
  const auto collect = [&] {
    for (const Element& e : elements) {
      result.points.push_back(e.first);
      result.normals.push_back(e.second);
    }
  };
  try {
    result.report = options.region_of_interest
                        ? dispatch(elements,
                                   handles,
                                   options,
                                   np.region_of_interest(std::cref(*options.region_of_interest)))
                        : dispatch(elements, handles, options, np);
  } catch (...) {
    // Checks that the points are unchanged, for all tests of errors.
    collect();
    if (result.points.size() != points.size())
      throw std::logic_error("deform_point_set() threw and changed the size");
    for (std::size_t i = 0; i < points.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const auto differ = [](double a, double b) { return !(a == b || (a != a && b != b)); };
        if (differ(result.points[i][c], points[i][c]) || differ(result.normals[i][c], rest[i][c]))
          throw std::logic_error("deform_point_set() threw and changed point " + std::to_string(i));
      }
    throw;
  }
  collect();
  return result;
}

} // namespace pcs_test
