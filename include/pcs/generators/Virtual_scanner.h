// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A virtual laser scanner: its stations, its beams and errors, and the surroundings of the tree.

#ifndef PCS_GENERATORS_VIRTUAL_SCANNER_H
#define PCS_GENERATORS_VIRTUAL_SCANNER_H

#include <pcs/core/errors.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/text.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsGeneratorsRef
//! an upright cylinder beside the tree, such as a lamp post; its base is at the height of the root
struct Scan_post
{
  double x = 0, y = 0; //!< from the root [L]
  double radius = 0.06, height = 4;
};

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief A virtual laser scanner and the scanned surroundings; the defaults assume metres.

  Stations are distributed over a circle or an arc around the root of the tree, or given by
  `positions`. Each station emits beams in regular steps of azimuth and elevation. A beam consists
  of three rays within `beam_width`; `scan_tree()` describes how beams at edges are processed.
*/
struct Virtual_scanner
{
  std::size_t number_of_stations = 4;           //!< [count]
  double distance = 10;                         //!< of the stations from the root [L]
  double distance_spread = 0.15;                //!< relative variation of `distance` [-]
  double station_height = 1.6;                  //!< above the root [L]
  double first_azimuth = 0;                     //!< of the arc, from +x to +y [rad]
  double azimuth_range = 2 * pcs::internal::pi; //!< of the arc; below 2 pi: one-sided [rad]
  std::vector<std::array<double, 3>> positions; //!< in the coordinates of the tree; replace the arc

  double angular_step = 0.05 * (pcs::internal::pi / 180); //!< between beams [rad]
  double beam_width = 0.0004; //!< diameter of a beam: its divergence [rad]
  double ghost_gap = 0.03;    //!< range difference in a beam above which a ghost may occur [L]
  double ghost_share = 0.25;  //!< fraction of such beams that give a ghost [-]
  double edge_share = 0.5;    //!< fraction of beams with only off-center hits that give a point [-]
  double range_noise = 0.002; //!< standard deviation of ranges, extrapolated to the station [L]
  double noise_distance = 50; //!< distance at which the noise is doubled [L]
  double registration_error = 0.0015; //!< standard deviation of shifts of stations, per axis [L]
  double outlier_share = 0.001;       //!< ratio of outliers and other points [-]
  double largest_range = std::numeric_limits<double>::infinity(); //!< [L]
  double voxel_size = 0; //!< thinning to one point per cube of this size; 0: none [L]

  double bark_depth = 0.004; //!< depth of the bark relief, at most `bark_share` of the radius [L]
  double bark_share = 0.03;  //!< largest ratio of bark depth and radius [-]
  double wind = 0;           //!< largest displacement of twigs (order 2 and more) per station [L]
  double leaves_per_length = 0; //!< on twigs thinner than `leaf_twig_radius` [1/L]
  double leaf_radius = 0.03;    //!< [L]
  double leaf_twig_radius = 0.01;
  double ground_radius = 0;       //!< radius of a circular patch of ground; 0: none [L]
  double ground_roughness = 0.02; //!< amplitude of its relief [L]
  std::vector<Scan_post> posts;

  //! returns the same scanner in another unit: multiplies all lengths, but no angles, by `factor`
  Virtual_scanner scaled(double factor) const
  {
    Virtual_scanner result = *this;
    for (double* length : {&result.distance,
                           &result.station_height,
                           &result.ghost_gap,
                           &result.range_noise,
                           &result.noise_distance,
                           &result.registration_error,
                           &result.largest_range,
                           &result.voxel_size,
                           &result.bark_depth,
                           &result.wind,
                           &result.leaf_radius,
                           &result.leaf_twig_radius,
                           &result.ground_radius,
                           &result.ground_roughness})
      *length *= factor;
    result.leaves_per_length /= factor;
    for (auto& position : result.positions)
      for (double& x : position)
        x *= factor;
    for (Scan_post& post : result.posts)
      for (double* length : {&post.x, &post.y, &post.radius, &post.height})
        *length *= factor;
    return result;
  }
};

namespace internal {

/// Checks single values of a scanner; throws `Invalid_input`.
struct Scanner_checks
{
  static void check(bool is_fine, const char* name, double value, const char* rule)
  {
    if (!is_fine)
      throw Invalid_input(std::string("pcs::Virtual_scanner: `") + name + "` must be " + rule +
                          ", found " + to_text(value));
  }

  static void positive(double value, const char* name)
  {
    check(value > 0 && std::isfinite(value), name, value, "positive");
  }

  static void not_negative(double value, const char* name)
  {
    check(value >= 0 && std::isfinite(value), name, value, "0 or more");
  }

  static void share(double value, const char* name)
  {
    check(value >= 0 && value <= 1, name, value, "in [0, 1]");
  }

  static void finite(double value, const char* name)
  {
    check(std::isfinite(value), name, value, "finite");
  }

  static void stations(const Virtual_scanner& s);
  static void beams(const Virtual_scanner& s);
  static void surroundings(const Virtual_scanner& s);
};

inline void Scanner_checks::stations(const Virtual_scanner& s)
{
  if (s.positions.empty()) {
    check(s.number_of_stations >= 1 && s.number_of_stations <= 10000,
          "number_of_stations",
          static_cast<double>(s.number_of_stations),
          "from 1 to 10000");
    positive(s.distance, "distance");
    check(s.distance_spread >= 0 && s.distance_spread < 1,
          "distance_spread",
          s.distance_spread,
          "in [0, 1)");
    finite(s.station_height, "station_height");
    finite(s.first_azimuth, "first_azimuth");
    check(s.azimuth_range >= 0 && s.azimuth_range < 6.2832,
          "azimuth_range",
          s.azimuth_range,
          "from 0 to a full turn");
  }
  for (const auto& position : s.positions)
    for (const double x : position)
      finite(x, "positions");
}

inline void Scanner_checks::beams(const Virtual_scanner& s)
{
  check(s.angular_step >= 1e-6 && s.angular_step <= 1,
        "angular_step",
        s.angular_step,
        "from 1e-6 to 1");
  check(s.beam_width >= 0 && s.beam_width <= 0.1, "beam_width", s.beam_width, "from 0 to 0.1");
  not_negative(s.ghost_gap, "ghost_gap");
  share(s.ghost_share, "ghost_share");
  share(s.edge_share, "edge_share");
  not_negative(s.range_noise, "range_noise");
  positive(s.noise_distance, "noise_distance");
  not_negative(s.registration_error, "registration_error");
  share(s.outlier_share, "outlier_share");
  check(s.largest_range > 0, "largest_range", s.largest_range, "positive");
  not_negative(s.voxel_size, "voxel_size");
}

inline void Scanner_checks::surroundings(const Virtual_scanner& s)
{
  not_negative(s.bark_depth, "bark_depth");
  check(s.bark_share >= 0 && s.bark_share <= 0.5, "bark_share", s.bark_share, "in [0, 0.5]");
  not_negative(s.wind, "wind");
  not_negative(s.leaves_per_length, "leaves_per_length");
  positive(s.leaf_radius, "leaf_radius");
  not_negative(s.leaf_twig_radius, "leaf_twig_radius");
  not_negative(s.ground_radius, "ground_radius");
  not_negative(s.ground_roughness, "ground_roughness");
  for (const Scan_post& post : s.posts) {
    finite(post.x, "posts");
    finite(post.y, "posts");
    positive(post.radius, "posts");
    positive(post.height, "posts");
  }
}

/// Throws `Invalid_input` unless every value is in its range.
inline void check_scanner(const Virtual_scanner& s)
{
  Scanner_checks::stations(s);
  Scanner_checks::beams(s);
  Scanner_checks::surroundings(s);
}

} // namespace internal
} // namespace pcs

#endif // PCS_GENERATORS_VIRTUAL_SCANNER_H
