// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Deformation of pcs for the live editor of the gallery, compiled to WebAssembly.

#include <pcs/Point_set_deformation.h>
#include <pcs/core/Deformation_report.h>

#include <CGAL/Simple_cartesian.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <emscripten/emscripten.h>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Point = CGAL::Simple_cartesian<float>::Point_3;
using Points = std::vector<Point>;
using Session = pcs::Point_set_deformation<Points>;

static_assert(sizeof(Point) == 3 * sizeof(float), "JavaScript reads the points as an array");

/// The page has one session.
struct Editor
{
  Points points;
  std::unique_ptr<Session> session;
  std::vector<std::uint32_t> indices; ///< of the next handle, written by JavaScript
  std::string error;
};
Editor editor;

/// Returns the result of `work()`, or -1 if it throws; then `editor.error` is a sentence.
template <class Work>
int attempt(const Work& work)
{
  try {
    editor.error.clear();
    return work();
  } catch (const std::bad_alloc&) {
    editor.error = "There is not enough memory for these points. Thin the file first.";
  } catch (const std::exception& e) {
    editor.error = e.what();
  }
  return -1;
}

Session& session()
{
  if (!editor.session)
    throw std::logic_error("No points are loaded.");
  return *editor.session;
}

} // namespace

// Functions return -1 after an error.
extern "C" {

EMSCRIPTEN_KEEPALIVE const char* editor_error()
{
  return editor.error.c_str();
}

/// Makes room for points, which JavaScript then writes.
EMSCRIPTEN_KEEPALIVE int editor_allocate(std::size_t number_of_points)
{
  return attempt([&] {
    editor.session.reset();
    editor.points = Points(number_of_points, Point(0, 0, 0));
    return 0;
  });
}

EMSCRIPTEN_KEEPALIVE Point* editor_points()
{
  return editor.points.data();
}

/// Prepares the session for the points at rest. Returns the number of samples.
EMSCRIPTEN_KEEPALIVE int editor_start(int number_of_samples)
{
  return attempt([&] {
    editor.session =
        std::make_unique<Session>(editor.points,
                                  pcs::parameters::number_of_samples(number_of_samples));
    return static_cast<int>(session().number_of_samples());
  });
}

/// Makes room for the indices of the next handle, which JavaScript then writes.
EMSCRIPTEN_KEEPALIVE int editor_allocate_indices(std::size_t number_of_indices)
{
  return attempt([&] {
    editor.indices.resize(number_of_indices);
    return 0;
  });
}

EMSCRIPTEN_KEEPALIVE std::uint32_t* editor_indices()
{
  return editor.indices.data();
}

/// Returns the number of the handle.
EMSCRIPTEN_KEEPALIVE int editor_add_handle()
{
  return attempt([] { return static_cast<int>(session().add_handle(editor.indices)); });
}

EMSCRIPTEN_KEEPALIVE int editor_remove_handle(int handle)
{
  return attempt([&] {
    session().remove_handle(static_cast<std::size_t>(handle));
    return 0;
  });
}

/// Sets the motion of a handle from rest: scale and turn (a unit quaternion) about the centroid of
/// its points, then an offset.
EMSCRIPTEN_KEEPALIVE int editor_move(int handle,
                                     double scale,
                                     double turn_x,
                                     double turn_y,
                                     double turn_z,
                                     double turn_w,
                                     double x,
                                     double y,
                                     double z)
{
  return attempt([&] {
    const auto h = static_cast<std::size_t>(handle);
    const Point c = session().centroid(h);
    const Eigen::Vector3d center(c.x(), c.y(), c.z());
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    motion.linear() =
        scale * Eigen::Quaterniond(turn_w, turn_x, turn_y, turn_z).normalized().toRotationMatrix();
    motion.translation() = center + Eigen::Vector3d(x, y, z) - motion.linear() * center;
    session().set_transformation(h, motion);
    return 0;
  });
}

/// Deforms the points. Returns the number of the `pcs::Status`.
EMSCRIPTEN_KEEPALIVE int editor_deform(int is_warm)
{
  return attempt([&] {
    const pcs::Deformation_report report =
        session().deform(is_warm != 0 ? pcs::Solver_start::warm : pcs::Solver_start::cold);
    return static_cast<int>(report.status);
  });
}

/// Makes the present shape the rest shape.
EMSCRIPTEN_KEEPALIVE int editor_accept()
{
  return attempt([] {
    session().accept();
    return 0;
  });
}
}
