// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Memoisation of the matching of branch pairs below any parents.

#ifndef PCS_SHAPE_SPACE_MATCHING_MATCHING_MEMO_H
#define PCS_SHAPE_SPACE_MATCHING_MATCHING_MEMO_H

#include <pcs/core/rotations.h>

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <unordered_map>

namespace pcs {
namespace shape_space {

/// Key of a pair of branches below any parents: the same pair is matched for each trial of the
/// parents. Rotations are rounded before use, so that trials with similar rotations have the same
/// key, and the order of trials does not matter.
class Matching_key
{
public:
  Matching_key(std::size_t start_1, std::size_t start_2, const Eigen::Matrix3d& rotation)
    : m_start_1(start_1), m_start_2(start_2)
  {
    const Eigen::Vector3d u = rotation_log(Quaternion(rotation));
    for (int i = 0; i < 3; ++i)
      m_rotation[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(u[i] / rotation_step));
  }

  bool operator==(const Matching_key& q) const
  {
    return m_start_1 == q.m_start_1 && m_start_2 == q.m_start_2 && m_rotation == q.m_rotation;
  }

  /// Returns the rounded rotation.
  Eigen::Matrix3d rotation() const
  {
    return rotation_exp(rotation_step *
                        Eigen::Vector3d(m_rotation[0], m_rotation[1], m_rotation[2]))
        .toRotationMatrix();
  }

  struct Hash
  {
    std::size_t operator()(const Matching_key& q) const
    {
      std::size_t h = q.m_start_1 * 0x9e3779b97f4a7c15u + q.m_start_2;
      for (const int t : q.m_rotation)
        h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9u + static_cast<std::size_t>(t + 1000);
      return h ^ (h >> 32);
    }
  };

private:
  static constexpr double rotation_step = 0.25; // [rad]

  std::size_t m_start_1, m_start_2;
  std::array<int, 3> m_rotation;
};

/// Values by key, for any number of threads.
template <class Value>
class Matching_memo
{
public:
  /// Returns null if there is no entry; the value stays where it is until `forget()`.
  const Value* find(const Matching_key& key) const
  {
    const Shard& shard = m_shards[shard_of(key)];
    const std::lock_guard<std::mutex> lock(shard.mutex);
    const auto it = shard.values.find(key);
    return it == shard.values.end() ? nullptr : &it->second; // rehashing keeps addresses
  }

  void keep(const Matching_key& key, const Value& value)
  {
    Shard& shard = m_shards[shard_of(key)];
    const std::lock_guard<std::mutex> lock(shard.mutex);
    shard.values.emplace(key, value);
  }

  void forget()
  {
    for (Shard& shard : m_shards)
      shard.values.clear();
  }

private:
  struct Shard
  {
    mutable std::mutex mutex;
    std::unordered_map<Matching_key, Value, Matching_key::Hash> values;
  };
  static std::size_t shard_of(const Matching_key& key)
  {
    return Matching_key::Hash()(key) % number_of_shards;
  }

  static constexpr std::size_t number_of_shards = 64;
  std::array<Shard, number_of_shards> m_shards;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_MATCHING_MEMO_H
