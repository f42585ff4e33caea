// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Memoisation of the matching of branch pairs below any parents.

#ifndef PCS_SHAPE_SPACE_MATCHING_MATCHING_MEMO_H
#define PCS_SHAPE_SPACE_MATCHING_MATCHING_MEMO_H

#include <pcs/core/rotations.h>
#include <pcs/shape_space/model/Matched_branch.h>

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <unordered_map>

namespace pcs {
namespace shape_space {

/// Two branches below any parents: the same question comes up for each way to continue the parents.
/// Turns are rounded before use, so that it is the same question, and so that it does not matter
/// who asks first.
class Matching_key
{
public:
  Matching_key(std::size_t start_1, std::size_t start_2, const Eigen::Matrix3d& rotation)
    : m_start_1(start_1), m_start_2(start_2)
  {
    const Eigen::Vector3d u = rotation_log(Quaternion(rotation));
    for (int i = 0; i < 3; ++i)
      m_turn[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(u[i] / turn_step));
  }

  bool operator==(const Matching_key& q) const
  {
    return m_start_1 == q.m_start_1 && m_start_2 == q.m_start_2 && m_turn == q.m_turn;
  }

  /// The one that is meant.
  Eigen::Matrix3d rotation() const
  {
    return rotation_exp(turn_step * Eigen::Vector3d(m_turn[0], m_turn[1], m_turn[2]))
        .toRotationMatrix();
  }

  struct Hash
  {
    std::size_t operator()(const Matching_key& q) const
    {
      std::size_t h = q.m_start_1 * 0x9e3779b97f4a7c15u + q.m_start_2;
      for (const int t : q.m_turn)
        h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9u + static_cast<std::size_t>(t + 1000);
      return h ^ (h >> 32);
    }
  };

private:
  static constexpr double turn_step = 0.25; // [rad]

  std::size_t m_start_1, m_start_2;
  std::array<int, 3> m_turn;
};

/// Answers to questions, kept by any number of threads.
class Matching_memo
{
public:
  using Result = std::shared_ptr<const Matched_branch>;

  /// Null where there is none yet; a null result is an answer.
  const Result* find(const Matching_key& question)
  {
    Shard& shard = shard_of(question);
    const std::lock_guard<std::mutex> lock(shard.mutex);
    const auto it = shard.results.find(question);
    return it == shard.results.end() ? nullptr : &it->second; // stays where it is
  }

  void keep(const Matching_key& question, const Result& result)
  {
    Shard& shard = shard_of(question);
    const std::lock_guard<std::mutex> lock(shard.mutex);
    shard.results.emplace(question, result);
  }

  void forget()
  {
    for (Shard& shard : m_shards)
      shard.results.clear();
  }

private:
  struct Shard
  {
    std::mutex mutex;
    std::unordered_map<Matching_key, Result, Matching_key::Hash> results;
  };
  Shard& shard_of(const Matching_key& question)
  {
    return m_shards[Matching_key::Hash()(question) % m_shards.size()];
  }

  std::array<Shard, 64> m_shards;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_MATCHING_MEMO_H
