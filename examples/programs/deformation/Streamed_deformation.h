// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Out-of-core deformation: a sample of the points is deformed, and the others follow chunk by
// chunk.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_STREAMED_DEFORMATION_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_STREAMED_DEFORMATION_H

#include "common/Progress_line.h"
#include "common/check_output.h"
#include "deformation/Deformation_options.h"
#include "deformation/Edit.h"
#include "deformation/Kept_points.h"
#include "deformation/Normals.h"
#include "deformation/Run_report.h"
#include "deformation/Splats.h"
#include "deformation/adapt_faces.h"
#include "deformation/apply_edit.h"
#include "deformation/default_edit.h"
#include "deformation/run_session.h"
#include <pcs/IO/Point_reader.h>
#include <pcs/IO/Point_writer.h>
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Write_options.h>
#include <pcs/IO/write_points.h>
#include <pcs/core/Similarity.h>
#include <pcs/core/errors.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace program {

class Streamed_deformation
{
public:
  /// \param region the region of interest, or null; must outlive this object
  Streamed_deformation(const Options& options, const Edit* region, Run_report& run)
    : m_options(options), m_run(run), m_progress(!options.is_quiet), m_region_edit(region)
  {
  }

  /// Runs the deformation. Without an edit, the default edit is derived from the kept points.
  void run(std::optional<Edit> edit)
  {
    const Stopwatch reading;
    if (std::filesystem::exists(m_options.input) &&
        !std::filesystem::is_regular_file(m_options.input))
      throw pcs::IO_error(m_options.input, "is no regular file, but --stream reads it twice");
    count_points();
    check_output(m_options.output, m_empty.schema());
    keep_points(edit);
    m_run.edit = m_edit->source;
    m_run.seconds_read = reading.seconds();

    if (m_splats)
      m_kept_gradients.assign(m_kept.numbers.size(), Eigen::Matrix3d::Identity());
    const bool has_all = m_kept.numbers.size() == m_run.number_of_points;
    Options options = m_options;
    if (!has_all) {
      options.number_of_neighbors = std::max(least_neighbors, options.number_of_neighbors);
      if (options.number_of_samples == 0) // points that are not kept are blended more smoothly
        options.number_of_samples = pcs::default_number_of_samples;
    }
    m_run.number_of_neighbors = options.number_of_neighbors;
    m_run.deformation =
        run_session({*m_edit,
                     m_motions,
                     m_kept.handles,
                     m_kept.table.points(),
                     do_normals() ? &m_kept.normals : nullptr,
                     m_splats ? &m_kept_gradients : nullptr,
                     has_all ? "" : " (numbers count the points that --stream keeps)",
                     m_kept_inside},
                    options,
                    m_progress,
                    [this](const Move_others& move_others) { write(move_others); });
    m_run.samples_reason = has_all || m_options.number_of_samples > 0
                               ? reason_of(m_run.deformation)
                               : "default, --stream keeps a part of the points";
    m_progress.clear();
  }

private:
  using Table = pcs::IO::Point_table;

  /// The number of links is increased because randomly selected points are uneven: with 6 links,
  /// which suffice for a scan, a group of 8 in a million points was disconnected and kept its
  /// position together with all points near it.
  static constexpr std::int64_t least_neighbors = 10;

  bool do_normals() const { return m_run.normals == "deformed"; }

  /// Calls `use(chunk, number of its first point)` for all chunks of the input.
  /// `do_keep_faces`: also reads the faces, to `m_faces`.
  template <class Use>
  std::uint64_t for_each_chunk(const char* stage, const Use& use, bool do_keep_faces = false)
  {
    pcs::IO::Point_reader reader(m_options.input, do_keep_faces);
    Table chunk;
    std::uint64_t first = 0, number_of_chunks = 0;
    while (reader.read(chunk, static_cast<std::size_t>(m_options.chunk_size))) {
      const std::size_t size = chunk.number_of_points();
      use(chunk, first);
      first += size;
      ++number_of_chunks;
      if (m_run.number_of_points > 0) // otherwise they are being counted
        m_progress.show(stage,
                        std::min(1.0, double(first) / static_cast<double>(m_run.number_of_points)));
    }
    m_run.number_of_chunks = number_of_chunks;
    if (do_keep_faces)
      m_faces = reader.faces();
    return first;
  }

  void count_points()
  {
    std::optional<std::uint64_t> n;
    {
      const pcs::IO::Point_reader reader(m_options.input, !m_options.is_points_only);
      m_empty = Table(reader.schema());
      m_run.warnings = reader.schema().warnings;
      warn_of_unknown_normals(reader.schema(), m_run.warnings);
      m_splats = find_splats(reader.schema(), m_run.warnings);
      if (m_splats)
        note_splats(*m_splats, m_run);
      n = reader.number_of_points();
    }
    m_run.number_of_points =
        n ? *n : for_each_chunk("counting", [](const Table&, std::uint64_t) {});
  }

  void check_count(std::uint64_t n) const
  {
    if (n != m_run.number_of_points)
      throw pcs::IO_error(m_options.input, "was changed by someone else while it was read");
  }

  /// The first pass: fills `m_kept` and all members that depend on the edit.
  void keep_points(std::optional<Edit>& edit)
  {
    const std::size_t number_of_handles = edit ? edit->handles.size() : 0;
    if (edit)
      set_edit(std::move(*edit));
    Keeper keeper(m_run.number_of_points,
                  static_cast<std::uint64_t>(m_options.number_of_kept_points),
                  number_of_handles);
    m_run.normals = m_empty.has_normals() ? "deformed" : "none";
    const Region region(m_region_edit, m_empty);
    m_is_inside.clear();
    const auto add = [&](const Table& chunk, std::uint64_t first) {
      Normal_vectors normals;
      if (do_normals()) {
        normals = chunk.normals();
        if (const std::optional<std::size_t> invalid = first_invalid(normals)) {
          m_run.normals = "unchanged";
          m_run.warnings.push_back(invalid_normal_warning(first + *invalid));
        }
      }
      const auto handles = m_scan ? m_scan->add(chunk) : std::vector<std::uint32_t>();
      for (const char is_inside : region.in(chunk, first, handles, m_scan ? &*m_edit : nullptr))
        m_is_inside.push_back(is_inside != 0);
      keeper.add(chunk, normals, handles, first);
    };
    check_count(for_each_chunk("reading", add, !m_options.is_points_only));
    adapt_faces(m_faces, m_options.output, m_run.warnings);
    m_run.number_of_faces = m_faces ? m_faces->number_of_faces() : 0;
    m_kept = keeper.take(do_normals());

    if (!m_scan) {
      set_edit(default_edit(m_kept.table.points()));
      m_kept.handles = m_scan->add(m_kept.table);
    }
    m_motions = m_scan->motions();
    check_handles();
    check_region(region);
  }

  /// Finds the kept points of the region.
  void check_region(const Region& region)
  {
    m_run.number_of_inside_points = region.is_given()
                                        ? std::count(m_is_inside.begin(), m_is_inside.end(), true)
                                        : static_cast<std::int64_t>(m_run.number_of_points);
    region.check(m_run.number_of_points, static_cast<std::uint64_t>(m_run.number_of_inside_points));
    m_kept_inside.clear();
    if (!region.is_given())
      return;
    for (const std::uint64_t number : m_kept.numbers)
      m_kept_inside.push_back(m_is_inside[number] ? 1 : 0);
    if (std::find(m_kept_inside.begin(), m_kept_inside.end(), char(1)) == m_kept_inside.end())
      throw pcs::IO_error(m_options.region,
                          "none of the points of the region is kept; raise --stream-points");
  }

  void set_edit(Edit edit)
  {
    for (const Handle& handle : edit.handles)
      if (!handle.motion.targets.empty())
        throw pcs::IO_error(edit.source,
                            handle.pointer +
                                "/targets: --stream keeps only some of the points; run without "
                                "--stream, or give a motion");
    m_edit = std::move(edit);
    m_scan.emplace(*m_edit, m_empty);
  }

  void check_handles() const
  {
    std::vector<char> has_points(m_edit->handles.size(), 0);
    for (const std::uint32_t h : m_kept.handles)
      if (h != no_handle)
        has_points[h] = 1;
    for (std::size_t h = 0; h < has_points.size(); ++h)
      if (!has_points[h])
        throw pcs::IO_error(m_edit->source,
                            m_edit->handles[h].pointer +
                                "/select: none of its points is kept; raise --stream-points");
  }

  void write(const Move_others& move_others)
  {
    const Stopwatch writing;
    pcs::IO::Write_options options;
    options.number_of_points = m_run.number_of_points;
    options.faces = m_faces;
    options.keep_coordinate_types = m_splats.has_value();
    if (pcs::IO::internal::format_by_extension(m_options.output) == pcs::IO::File_format::las)
      choose_las_grid(move_others, options);
    m_run.points_of_handles.assign(m_edit->handles.size(), 0);
    m_run.number_of_invalid_splats = 0; // the grid of LAS needs a pass more
    pcs::IO::Point_writer writer(m_options.output, m_empty.schema(), options);
    check_count(for_each_chunk("writing", [&](Table& chunk, std::uint64_t first) {
      for (const std::uint32_t h : move(move_others, chunk, first))
        if (h != no_handle)
          ++m_run.points_of_handles[h];
      writer.append(chunk);
    }));
    writer.commit();
    m_run.seconds_write = writing.seconds();
  }

  /// Returns the grid that `write_points()` computes for the whole table from its bounding box.
  void choose_las_grid(const Move_others& move_others, pcs::IO::Write_options& options)
  {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    check_count(for_each_chunk("measuring", [&](Table& chunk, std::uint64_t first) {
      move(move_others, chunk, first);
      if (first == 0)
        low = high = to_vec3(chunk.points().front());
      for (const auto& point : chunk.points()) {
        low = low.cwiseMin(to_vec3(point));
        high = high.cwiseMax(to_vec3(point));
      }
    }));
    Table corners(m_empty.schema());
    corners.points().emplace_back(low.x(), low.y(), low.z());
    corners.points().emplace_back(high.x(), high.y(), high.z());
    pcs::IO::internal::choose_las_grid(m_options.output, corners, options);
  }

  /// Moves the points of the next chunk. Returns the handle of each point.
  std::vector<std::uint32_t> move(const Move_others& move_others, Table& chunk, std::uint64_t first)
  {
    if (first == 0)
      m_next_kept = 0;
    std::vector<std::uint32_t> handles = m_scan->handles_of(chunk, first);
    const std::vector<char> is_inside =
        Region(m_region_edit, m_empty).in(chunk, first, handles, &*m_edit);
    Normal_vectors normals;
    if (do_normals())
      normals = chunk.normals();
    const std::vector<Table::Point_3> rest =
        m_splats ? chunk.points() : std::vector<Table::Point_3>();
    Gradients gradients(m_splats ? handles.size() : 0, Eigen::Matrix3d::Identity());
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < handles.size(); ++i)
      if (m_next_kept < m_kept.numbers.size() && m_kept.numbers[m_next_kept] == first + i) {
        chunk.points()[i] = m_kept.table.points()[m_next_kept];
        if (do_normals())
          normals[i] = m_kept.normals[m_next_kept];
        if (m_splats)
          gradients[i] = m_kept_gradients[m_next_kept];
        ++m_next_kept;
      } else if (handles[i] != no_handle && is_hard(m_edit->handles[handles[i]])) {
        const pcs::Similarity& motion = m_motions[handles[i]];
        move_rigidly(motion, chunk.points()[i], do_normals() ? &normals[i] : nullptr);
        if (m_splats)
          gradients[i] = motion.scale() * motion.rotation();
      } else if (is_inside.empty() || is_inside[i])
        others.push_back(i);

    move_others({others,
                 chunk.points(),
                 do_normals() ? &normals : nullptr,
                 m_splats ? &gradients : nullptr});
    check_range(*m_edit, chunk, first);
    if (do_normals())
      store_normals(chunk, normals);
    if (m_splats) {
      keep_resting_coordinates(rest, m_scan->largest_coordinate(), chunk.points());
      transform_splats(chunk, *m_splats, gradients, m_run);
    }
    return handles;
  }

  static void
  move_rigidly(const pcs::Similarity& motion, Table::Point_3& point, Table::Vector_3* normal)
  {
    if (motion.is_identity()) // keeps the positions exactly
      return;
    const Vec3 p = motion(to_vec3(point));
    point = {p.x(), p.y(), p.z()};
    if (normal != nullptr) {
      const Vec3 n = motion.rotation() * Vec3(normal->x(), normal->y(), normal->z());
      *normal = {n.x(), n.y(), n.z()};
    }
  }

  const Options& m_options;
  Run_report& m_run;
  Progress_line m_progress;
  const Edit* m_region_edit;       // null: all points may move
  std::vector<bool> m_is_inside;   // whether each point of the file may move; empty: all may
  std::vector<char> m_kept_inside; // the same for the kept points
  Table m_empty;                   // with the properties of the input
  std::shared_ptr<pcs::IO::Mesh_faces> m_faces; // null: none
  std::optional<Edit> m_edit;
  std::optional<Edit_scan> m_scan; // refers to m_edit
  std::vector<pcs::Similarity> m_motions;
  Kept_points m_kept;
  std::optional<Splat_properties> m_splats; // empty: the points are no splats
  Gradients m_kept_gradients;               // of the kept points if they are splats
  std::size_t m_next_kept = 0; // the first one after the points processed by the second pass
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_STREAMED_DEFORMATION_H
