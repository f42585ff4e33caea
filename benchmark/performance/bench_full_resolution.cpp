// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares deformation without sampling with CGAL::Surface_mesh_deformation on the vertices of one
// large mesh.

#include <pcs/Point_set_deformation.h>
#include <support/Table.h>
#include <support/deformation_cases.h>
#include <support/measuring.h>
#include <support/models.h>

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/IO/polygon_mesh_io.h>

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iostream>
#include <quality/mesh_peer.h>
#include <stdexcept>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Vec3 = Eigen::Vector3d;

namespace {

/// Reads the largest connected component of the mesh in a file.
pcs_test::Deformation_case read_case(const std::string& path)
{
  namespace PMP = CGAL::Polygon_mesh_processing;
  std::vector<Point> soup;
  std::vector<std::vector<std::size_t>> polygons;
  if (!CGAL::IO::read_polygon_soup(path, soup, polygons))
    throw std::runtime_error(path + ": no mesh");
  PMP::repair_polygon_soup(soup, polygons);
  PMP::orient_polygon_soup(soup, polygons);
  CGAL::Surface_mesh<Point> mesh;
  PMP::polygon_soup_to_polygon_mesh(soup, polygons, mesh);
  PMP::keep_largest_connected_components(mesh, 1);
  mesh.collect_garbage();
  pcs_test::Deformation_case c;
  c.name = path;
  for (const auto v : mesh.vertices())
    c.points.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
  for (const auto f : mesh.faces()) {
    std::vector<std::uint32_t> corners;
    for (const auto v : vertices_around_face(mesh.halfedge(f), mesh))
      corners.push_back(static_cast<std::uint32_t>(std::size_t(v)));
    if (corners.size() != 3)
      throw std::runtime_error(path + ": not all faces are triangles");
    c.triangles.push_back({corners[0], corners[1], corners[2]});
  }
  return c;
}

/// Fixes the lowest 5 % along y. Turns the highest 8 % by 60 degrees and moves them.
void set_handles(pcs_test::Deformation_case& c)
{
  const pcs_bench::Ends ends(c.points, 0.05, 0.08);
  const Vec3 extent = ends.high_centroid - c.points[ends.low.front()];
  const pcs::Similarity turn =
      pcs::Similarity::about(pcs::Similarity::from_turn(Vec3(0, 0, 3.14159265358979323846 / 3)),
                             ends.high_centroid);
  c.handles = {ends.low, ends.high};
  c.transforms = {pcs::Similarity(),
                  pcs::Similarity::from_translation(0.1 * extent.norm() * Vec3::UnitX()) * turn};
}

/// Root mean square of the relative changes of length of all edges.
double edge_change(const pcs_test::Deformation_case& c, const std::vector<Vec3>& points)
{
  double sum = 0, count = 0;
  for (const auto& t : c.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = t[k], b = t[(k + 1) % 3];
      const double rest = (c.points[a] - c.points[b]).norm();
      if (!(rest > 0))
        continue;
      const double change = (points[a] - points[b]).norm() / rest - 1;
      sum += change * change;
      ++count;
    }
  return std::sqrt(sum / count);
}

struct Row
{
  double preparation = 0, factorization = 0, solving = 0; // [s]
  std::size_t iterations = 0;
  double change = 0;
};

template <class ConcurrencyTag>
Row measure_pcs(const pcs_test::Deformation_case& c, bool do_preserve_volume)
{
  std::vector<Point> points;
  for (const Vec3& p : c.points)
    points.emplace_back(p.x(), p.y(), p.z());
  const auto np =
      pcs::parameters::number_of_samples(points.size()).do_preserve_volume(do_preserve_volume);
  pcs::Point_set_deformation<std::vector<Point>, decltype(np), ConcurrencyTag> session(points, np);
  for (std::size_t h = 0; h < c.handles.size(); ++h) {
    const auto handle = session.add_handle(c.handles[h]);
    session.set_transformation(handle, c.transforms[h]);
  }
  const pcs::Deformation_report r = session.deform();
  Row row;
  row.preparation = r.seconds.neighbors + r.seconds.sampling;
  row.factorization = r.seconds.factorization;
  row.solving = r.seconds.solving + r.seconds.upsampling;
  row.iterations = r.number_of_iterations;
  std::vector<Vec3> moved;
  for (const Point& p : points)
    moved.emplace_back(p.x(), p.y(), p.z());
  row.change = edge_change(c, moved);
  return row;
}

template <CGAL::Deformation_algorithm_tag algorithm>
Row measure_cgal(const pcs_test::Deformation_case& c, std::size_t iterations)
{
  const auto result = pcs_bench::deform_mesh<algorithm>(c, iterations, 1e9);
  Row row;
  row.factorization = result.preprocessing;
  row.solving = result.seconds - result.preprocessing;
  row.iterations = result.iterations;
  row.change = edge_change(c, result.points);
  return row;
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Deforms all vertices of a mesh, without sampling, and with CGAL.");
  std::string path;
  std::size_t iterations = 10;
  app.add_option("--mesh", path, "triangle mesh (PLY, OFF, OBJ); default: a bar of 400,000 points")
      ->check(CLI::ExistingFile);
  app.add_option("--iterations", iterations, "of CGAL, besides one [count]")
      ->check(CLI::Range(2, 10000));
  CLI11_PARSE(app, argc, argv);
  try {
    pcs_test::Deformation_case c;
    if (path.empty()) {
      c.name = "bar";
      pcs_test::make_box(Vec3(0, 0, 0), Vec3(1, 4, 1), 158, 632, 158, c);
    } else
      c = read_case(path);
    set_handles(c);
    std::cerr << c.points.size() << " points, " << c.triangles.size() << " triangles\n";
    pcs_bench::Table table({"method",
                            "neighbours, weights s",
                            "analysis, factor s",
                            "solving s",
                            "iterations",
                            "RMS edge change"});
    const auto add = [&](const std::string& name, const Row& r) {
      table.add({name,
                 pcs_bench::number(r.preparation),
                 pcs_bench::number(r.factorization),
                 pcs_bench::number(r.solving),
                 std::to_string(r.iterations),
                 pcs_bench::number(r.change)});
    };
    for (const bool has_links : {true, false}) {
      const std::string name = has_links ? "pcs" : "pcs, without interior links";
      add(name + ", one thread", measure_pcs<CGAL::Sequential_tag>(c, has_links));
      add(name, measure_pcs<CGAL::Parallel_if_available_tag>(c, has_links));
    }
    for (const std::size_t n : {std::size_t(1), iterations}) {
      add("CGAL ORIGINAL_ARAP", measure_cgal<CGAL::ORIGINAL_ARAP>(c, n));
      add("CGAL SRE_ARAP", measure_cgal<CGAL::SRE_ARAP>(c, n));
    }
    table.print(std::cout);
  } catch (const std::exception& e) {
    std::cerr << "bench_full_resolution: " << e.what() << '\n';
    return 1;
  }
}
