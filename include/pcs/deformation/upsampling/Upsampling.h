// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Upsampling: affine maps of samples blended over all points, eight points at a time.

#ifndef PCS_DEFORMATION_UPSAMPLING_UPSAMPLING_H
#define PCS_DEFORMATION_UPSAMPLING_UPSAMPLING_H

#include <pcs/deformation/body/Sample_links.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Local_frame.h>
#include <pcs/deformation/model/Point_blocks.h>
#include <pcs/deformation/upsampling/Dirty_handles.h>
#include <pcs/deformation/upsampling/Target_corrections.h>
#include <pcs/deformation/upsampling/blend_block.h>
#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/streaming_stores.h>

#include <CGAL/tags.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// Moves the points of each block by the maps of its samples. The memory per point is about 2.5
/// bytes for each sample of its block.
class Upsampling
{
public:
  Upsampling() = default;

  /// \param n number of points; points with consecutive indices should be near each other
  /// \param row `row(i)` is the row of `links` that applies to point `i` in `[0, n)`
  template <class ConcurrencyTag = CGAL::Sequential_tag, class Row_at>
  static Upsampling build(std::size_t n, const Row_at& row, const Sample_links& links)
  {
    const std::size_t number_of_blocks = (n + lanes - 1) / lanes;
    std::vector<Part> parts((number_of_blocks + blocks_of_part - 1) / blocks_of_part);
    pcs::internal::for_each_block<ConcurrencyTag>(number_of_blocks,
                                                  blocks_of_part,
                                                  [&](std::size_t begin, std::size_t end) {
                                                    Part& part = parts[begin / blocks_of_part];
                                                    std::vector<Member> members;
                                                    for (std::size_t block = begin; block < end;
                                                         ++block) {
                                                      find_members(block, n, row, links, members);
                                                      part.add_block(members);
                                                    }
                                                    part.pair_index.clear();
                                                  });
    Upsampling result;
    result.join<ConcurrencyTag>(parts);
    return result;
  }

  /// Points and samples at rest, and the maps of the samples.
  struct Input
  {
    const Point_blocks& points;
    const std::vector<Vec3>& samples;
    const std::vector<Affine_map>& maps;
  };

  /// The handles with whose motions the points of a block are blended: those from
  /// `entry[first[block]]` up to, but not including, `entry[first[block + 1]]`. There are none if
  /// `first` is null.
  struct Fades
  {
    const std::uint32_t* first = nullptr;
    const Block_fade* entry = nullptr;
  };

  /// The motions of the points of a block. If `holder[block]` is neither `mixed_block` nor
  /// `still_block`, all points move with this handle. Otherwise the samples move the points whose
  /// bits in `is_blended[block]` are set.
  struct Block_motions
  {
    const std::uint8_t* is_blended = nullptr;
    const std::int32_t* holder = nullptr;
    const char* is_written = nullptr; ///< for each handle, a value of `Dirty_handles::find()`
    const Handle_map* handles = nullptr;
    Fades fades;
    const Target_corrections* corrections = nullptr; ///< null if no handle has targets
    const std::uint32_t* site_of_place = nullptr;    ///< of the body, for the corrections
  };

  /*!
    Computes the points of all blocks concurrently, and passes them to a `Writer`:

    | call | meaning |
    |---|---|
    | `write(i, position, normal, gradient)` | writes a point that the samples or the holder of a
      block move; `normal` is zero without normals, `gradient` is only set if `HasGradients` |
    | `does_stream()` | whether `stream()` may be called |
    | `stream(i, block_output)` | writes eight points from `i` on, bypassing the caches; returns
      `false` if it writes nothing, and `write` is called instead |
    | `expect(i)` | prefetches the output of `write`; called unless `does_stream()` |
    | `write_other(i)` | called for the points of a mixed block that are not blended, and for those
      of a block whose holder has `points_at_rest` |
  */
  template <class ConcurrencyTag, bool HasGradients, class Writer>
  void apply(const Input& in,
             const Local_frame& frame,
             const Block_motions& motions,
             const Writer& writer)
  {
    update_pairs<ConcurrencyTag>(in.samples, in.maps);
    const auto apply_to_all = [&](auto outputs) {
      apply_blocks<ConcurrencyTag, decltype(outputs)::value>(in.points, frame, motions, writer);
    };
    if constexpr (HasGradients)
      apply_to_all(std::integral_constant<Blend_outputs, Blend_outputs::gradients>());
    else if (in.points.has_normals())
      apply_to_all(std::integral_constant<Blend_outputs, Blend_outputs::normals>());
    else
      apply_to_all(std::integral_constant<Blend_outputs, Blend_outputs::positions>());
  }

  /// Returns the gradient of point `i` as the last `apply()` computed it, or would have with
  /// `HasGradients`. O(1): computes one block.
  Eigen::Matrix3d
  gradient(std::size_t i, const Point_blocks& points, const Block_motions& motions) const
  {
    Block_input in{};
    in.differences = m_differences.data();
    const Local_frame frame; // gradients do not depend on it
    in.frame_unit = frame.unit;
    in.frame_origin = frame.origin.data();
    in.handles = motions.handles;
    set_input(points, motions, i / lanes, in);
    Block_output out{};
    choose_blend_block<Blend_outputs::gradients>()(in, out);
    if (motions.corrections)
      motions.corrections->apply_to_block<Blend_outputs::gradients>(i / lanes,
                                                                    whole_block,
                                                                    motions.site_of_place,
                                                                    frame,
                                                                    points.has_normals(),
                                                                    out);
    Eigen::Matrix3d result;
    for (int k = 0; k < 9; ++k)
      result(k / 3, k % 3) = out.gradient[k][i % lanes];
    return result;
  }

private:
  struct Member
  {
    std::uint32_t sample;
    std::array<float, lanes> weight;
  };
  struct Sample_pair
  {
    std::uint32_t base, sample;
  };

  /// Finds the samples that move any point of a block, and the weight of each for every point.
  template <class Row_at>
  static void find_members(std::size_t block,
                           std::size_t n,
                           const Row_at& row,
                           const Sample_links& links,
                           std::vector<Member>& members)
  {
    members.clear();
    for (std::size_t l = 0; l < lanes; ++l) {
      const std::size_t i = row(std::min(block * lanes + l, n - 1));
      for (std::size_t b = 0; b < links.k; ++b) {
        const std::uint32_t s = links.sample[i * links.k + b];
        if (s == no_sample)
          break;
        auto found = std::find_if(members.begin(), members.end(), [s](const Member& m) {
          return m.sample == s;
        });
        if (found == members.end())
          found = members.insert(found, {s, {}});
        found->weight[l] += links.weight[i * links.k + b];
      }
    }
  }

  /// Returns the index of the member with the largest total weight, the base of the block. Only the
  /// weights of the other members are stored; the remainder is the weight of the base.
  static std::size_t find_base(const std::vector<Member>& members)
  {
    std::size_t base = 0;
    float largest = -1;
    for (std::size_t u = 0; u < members.size(); ++u) {
      float total = 0;
      for (const float w : members[u].weight)
        total += w;
      if (total > largest) {
        largest = total;
        base = u;
      }
    }
    return base;
  }

  /// Consecutive blocks, which are prepared together.
  struct Part
  {
    std::vector<std::uint32_t> base, end; ///< of each block; `end` counts the entries of the part
    std::vector<Block_entry> entry;       ///< with indices of `pairs`
    std::vector<Sample_pair> pairs;
    std::unordered_map<std::uint64_t, std::uint32_t> pair_index; // never iterated over

    void add_block(const std::vector<Member>& members)
    {
      const std::size_t b = find_base(members);
      base.push_back(members.empty() ? 0 : members[b].sample);
      for (std::size_t u = 0; u < members.size(); ++u) {
        if (u == b)
          continue;
        Block_entry added{index_of_pair({base.back(), members[u].sample}, pair_index, pairs), {}};
        for (std::size_t l = 0; l < lanes; ++l)
          added.weight[l] = static_cast<std::uint16_t>(
              weight_steps * static_cast<double>(members[u].weight[l]) + 0.5);
        entry.push_back(added);
      }
      end.push_back(static_cast<std::uint32_t>(entry.size()));
    }
  };
  static constexpr std::size_t blocks_of_part = 2048;

  /// Returns the index of a pair in `pairs`, to which new pairs are appended.
  static std::uint32_t index_of_pair(const Sample_pair& pair,
                                     std::unordered_map<std::uint64_t, std::uint32_t>& pair_index,
                                     std::vector<Sample_pair>& pairs)
  {
    const std::uint64_t key = std::uint64_t(pair.base) << 32 | pair.sample;
    const auto [found, is_new] = pair_index.emplace(key, static_cast<std::uint32_t>(pairs.size()));
    if (is_new)
      pairs.push_back(pair);
    return found->second;
  }

  /// Appends all parts. Pairs are numbered in the order of the blocks.
  template <class ConcurrencyTag>
  void join(std::vector<Part>& parts)
  {
    std::unordered_map<std::uint64_t, std::uint32_t> pair_index;
    std::vector<std::vector<std::uint32_t>> index_of(parts.size()); // of the pairs of a part
    std::vector<std::size_t> first_block(1, 0), first_entry(1, 0);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      for (const Sample_pair& pair : parts[p].pairs)
        index_of[p].push_back(index_of_pair(pair, pair_index, m_pairs));
      first_block.push_back(first_block.back() + parts[p].base.size());
      first_entry.push_back(first_entry.back() + parts[p].entry.size());
    }
    m_base.resize(first_block.back());
    m_first.assign(first_block.back() + 1, 0);
    m_entry.resize(first_entry.back());
    pcs::internal::for_each_index<ConcurrencyTag>(
        parts.size(),
        [&](std::size_t p) {
          Part& part = parts[p];
          for (std::size_t block = 0; block < part.base.size(); ++block) {
            m_base[first_block[p] + block] = part.base[block];
            m_first[first_block[p] + block + 1] =
                static_cast<std::uint32_t>(first_entry[p] + part.end[block]);
          }
          for (std::size_t e = 0; e < part.entry.size(); ++e) {
            m_entry[first_entry[p] + e] = part.entry[e];
            m_entry[first_entry[p] + e].pair = index_of[p][part.entry[e].pair];
          }
          part = Part();
        },
        1);
  }

  /// Computes the maps of the samples as bases, and the map differences between bases and the other
  /// samples of their blocks. Blocks with the same base and sample use the same difference.
  template <class ConcurrencyTag>
  void update_pairs(const std::vector<Vec3>& samples, const std::vector<Affine_map>& maps)
  {
    m_base_maps.resize(maps.size());
    pcs::internal::for_each_index<ConcurrencyTag>(maps.size(), [&](std::size_t s) {
      m_base_maps[s] = base_map(maps[s], samples[s].data());
    });
    m_differences.resize(m_pairs.size());
    pcs::internal::for_each_index<ConcurrencyTag>(m_pairs.size(), [&](std::size_t p) {
      const auto [base, sample] = m_pairs[p];
      m_differences[p] = map_difference(maps[base], maps[sample], samples[base].data());
    });
  }

  /// Returns a mask of the points of a block that are computed.
  static std::uint8_t computed(const Block_motions& motions, std::size_t block)
  {
    const std::int32_t holder = motions.holder[block];
    if (holder < 0)
      return motions.is_blended[block];
    return motions.is_written[holder] == points_moved ? whole_block : 0;
  }

  /// Whether a block without computed points has points for `write_other()`.
  static bool has_others(const Block_motions& motions, std::size_t block)
  {
    const std::int32_t holder = motions.holder[block];
    return holder < 0 ? holder == mixed_block : motions.is_written[holder] == points_at_rest;
  }

  template <class ConcurrencyTag, Blend_outputs Outputs, class Writer>
  void apply_blocks(const Point_blocks& points,
                    const Local_frame& frame,
                    const Block_motions& motions,
                    const Writer& writer) const
  {
    const auto blend = choose_blend_block<Outputs>();
    const bool does_stream = Outputs != Blend_outputs::gradients && writer.does_stream();
    pcs::internal::for_each_block<ConcurrencyTag>(
        m_base.size(),
        256,
        [&](std::size_t begin, std::size_t end) {
          // Each block is written while the next one is computed, since instructions that wait for
          // a result would stall speculative execution.
          Block_output out[2]{};
          Block_input in{};
          in.differences = m_differences.data();
          in.frame_unit = frame.unit;
          in.frame_origin = frame.origin.data();
          in.handles = motions.handles;
          std::uint8_t mask[2]{};
          const auto put = [&](std::size_t block) PCS_LAMBDA_INLINE {
            const std::size_t at = block % 2;
            if (mask[at] != 0 || has_others(motions, block))
              write_block<Outputs>(block, points.size(), mask[at], out[at], does_stream, writer);
          };
          for (std::size_t block = begin; block < end; ++block) {
            if (block + blocks_ahead < m_base.size() &&
                computed(motions, block + blocks_ahead) != 0)
              prefetch(points, block + blocks_ahead, does_stream, writer);
            mask[block % 2] = computed(motions, block);
            if (mask[block % 2] != 0) {
              set_input(points, motions, block, in);
              blend(in, out[block % 2]);
              if (motions.corrections)
                motions.corrections->apply_to_block<Outputs>(block,
                                                             mask[block % 2],
                                                             motions.site_of_place,
                                                             frame,
                                                             points.has_normals(),
                                                             out[block % 2]);
            }
            if (block != begin)
              put(block - 1);
          }
          put(end - 1);
          if (does_stream)
            pcs::internal::end_stream();
        });
  }

  /// Prefetches the input of a later block. The processor itself prefetches only up to the next
  /// page of 4 KB.
  template <class Writer>
  PCS_ALWAYS_INLINE void prefetch(const Point_blocks& points,
                                  std::size_t block,
                                  bool does_stream,
                                  const Writer& writer) const
  {
    if (!does_stream && (block + 1) * lanes <= points.size())
      pcs::internal::unroll<lanes>([&](auto l)
                                       PCS_LAMBDA_INLINE { writer.expect(block * lanes + l); });
    pcs::internal::prefetch(&points.positions(block), sizeof(Lane_vectors));
    if (points.has_normals())
      pcs::internal::prefetch(&points.normals(block), sizeof(Lane_vectors));
    // The number of bytes is fixed, since a branch on the true number would often be mispredicted.
    pcs::internal::prefetch(m_entry.data() + m_first[block], bytes_of_entries);
  }

  template <Blend_outputs Outputs, class Writer>
  PCS_ALWAYS_INLINE void write_block(std::size_t block,
                                     std::size_t number_of_points,
                                     std::uint8_t mask,
                                     const Block_output& out,
                                     bool does_stream,
                                     const Writer& writer) const
  {
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity();
    const std::size_t first = block * lanes;
    const std::size_t count = std::min(lanes, number_of_points - first);
    if (Outputs != Blend_outputs::gradients && mask == whole_block && count == lanes) {
      if (does_stream && writer.stream(first, out))
        return;
      // Most blocks are complete. A branch per point would cost more than the writing.
      pcs::internal::unroll<lanes>([&](auto l) PCS_LAMBDA_INLINE {
        writer.write(first + l, at(out.position, l), at(out.normal, l), gradient);
      });
      return;
    }
    for (std::size_t l = 0; l < count; ++l)
      if (mask >> l & 1) {
        if constexpr (Outputs == Blend_outputs::gradients)
          for (int k = 0; k < 9; ++k)
            gradient(k / 3, k % 3) = out.gradient[k][l];
        writer.write(first + l, at(out.position, l), at(out.normal, l), gradient);
      } else
        writer.write_other(first + l);
  }

  static Vec3 at(const Lane_vectors& v, std::size_t l)
  {
    return {v.value[0][l], v.value[1][l], v.value[2][l]};
  }

  void set_input(const Point_blocks& points,
                 const Block_motions& motions,
                 std::size_t block,
                 Block_input& in) const
  {
    in.base = &m_base_maps[m_base[block]];
    in.entry = m_entry.data() + m_first[block];
    in.entry_end = m_entry.data() + m_first[block + 1];
    in.rest = &points.positions(block);
    in.normal = points.has_normals() ? &points.normals(block) : nullptr;
    if (motions.fades.first) {
      in.fade = motions.fades.entry + motions.fades.first[block];
      in.fade_end = motions.fades.entry + motions.fades.first[block + 1];
    }
    const std::int32_t holder = motions.holder[block];
    in.holder = holder < 0 ? nullptr : motions.handles + holder;
  }

  static constexpr std::size_t blocks_ahead = 12;
  static constexpr std::size_t bytes_of_entries = 128; ///< enough for most blocks
  static constexpr std::uint8_t whole_block = 0xff;

  std::vector<std::uint32_t> m_base, m_first;
  pcs::internal::Huge_vector<Block_entry> m_entry;
  std::vector<Sample_pair> m_pairs;
  std::vector<Base_map> m_base_maps;
  std::vector<Map_difference> m_differences;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_UPSAMPLING_H
