#pragma once

#include <cstdint>

namespace platoon {

/// Realizations first .. end - 1.
struct RealizationRange {
  std::uint64_t first, end;

  std::uint64_t size() const { return end - first; }
};

/// Largest number of shards of a run.
constexpr std::uint64_t kMostShards = 1000000;

/// Part I of N of a run's realizations, 0 <= I < N.
struct Shard {
  std::uint64_t index;  ///< I
  std::uint64_t of;     ///< N
};

/// The realizations of a shard of a run of R realizations, N <= R: b_I .. b_{I+1} - 1, with b_N = R and b_I = floor(I R
/// / N), rounded down to a multiple of the largest power of two that is at most R / (32 N), or of 1.
///
/// No shard is empty. Each has R / N realizations to within R / (32 N) + 1 and consists of few nodes of the binary tree
/// over all realizations, along which sums are formed (see MomentTable), so any N gives the same bits as a single run.
/// Throws std::invalid_argument unless I < N <= min(R, kMostShards).
RealizationRange range_of(const Shard& shard, std::uint64_t realizations);

}  // namespace platoon
