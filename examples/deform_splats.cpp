// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Gaussian splats: the shape and the colours of each splat follow the deformation.

#include "pillar.h"
#include <pcs/deform_point_set.h>
#include <pcs/splats/Splat_transformation.h>

#include <boost/property_map/property_map.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <vector>

//! [splat]
struct Splat
{
  Eigen::Vector3d center;
  pcs::splats::Splat_shape shape; // rotation and logarithms of the scales
  float colors[9];                // band 1 of red, of green and of blue
};

struct Center_map
{
  using key_type = Splat;
  using value_type = Eigen::Vector3d;
  using reference = const Eigen::Vector3d&;
  using category = boost::read_write_property_map_tag;

  friend reference get(const Center_map&, const Splat& s) { return s.center; }
  friend void put(const Center_map&, Splat& s, const Eigen::Vector3d& p) { s.center = p; }
};

/// Transforms a splat, which is at rest, as soon as its gradient is known.
struct Gradient_map
{
  using key_type = Splat;
  using value_type = Eigen::Matrix3d;
  using reference = void;
  using category = boost::writable_property_map_tag;

  friend void put(const Gradient_map&, Splat& s, const Eigen::Matrix3d& gradient)
  {
    const pcs::splats::Splat_transformation transformation(gradient);
    transformation.transform(s.shape);
    transformation.rotate_harmonics(1, s.colors);
  }
};
//! [splat]

int main()
{
  std::vector<Splat> splats;
  for (const Eigen::Vector3d& p : make_pillar<Eigen::Vector3d>(5000))
    splats.push_back({p, {Eigen::Quaterniond::Identity(), {-3, -3, -5}}, {0, 0, 1}});
  std::vector<std::size_t> feet, head;
  for (std::size_t i = 0; i < 500; ++i) {
    feet.push_back(i);
    head.push_back(splats.size() - 1 - i);
  }

  //! [deform_splats]
  const auto bend = pcs::rotation(Eigen::Vector3d(0, 1, 0), CGAL_PI / 2, Eigen::Vector3d(5, 0, 5));
  const auto report =
      pcs::deform_point_set(splats,
                            feet,
                            head,
                            bend,
                            pcs::parameters::point_map(Center_map()).gradient_map(Gradient_map()));
  //! [deform_splats]

  // The short axis of the last splat pointed along z, and its red colour was strongest along -x.
  const Splat& last = splats.back();
  const Eigen::Vector3d axis = last.shape.rotation * Eigen::Vector3d::UnitZ();
  std::cout << report.status << "; the short axis of the last splat points along "
            << axis.transpose() << ", and its band 1 of red is " << last.colors[0] << ' '
            << last.colors[1] << ' ' << last.colors[2] << '\n';
  return std::abs(axis.x() - 1) < 1e-9 && std::abs(last.colors[1] - 1) < 1e-6 ? EXIT_SUCCESS
                                                                              : EXIT_FAILURE;
}
