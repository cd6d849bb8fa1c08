#include "stochastic_platoon/math/statistics/shard.hpp"

#include <stdexcept>
#include <string>

namespace platoon {

namespace {

constexpr std::uint64_t kSizesApart = 32;

std::uint64_t boundary(std::uint64_t index, std::uint64_t of, std::uint64_t realizations) {
  if (index == of) return realizations;
  // floor(I R / N) without I R, which needs more than 64 bits: R = q N + r, and I r < N^2.
  const std::uint64_t quotient = realizations / of, rest = realizations % of;
  const std::uint64_t place = index * quotient + index * rest / of;
  std::uint64_t grain = 1;
  while (2 * grain <= quotient / kSizesApart) grain *= 2;
  return place / grain * grain;
}

}  // namespace

RealizationRange range_of(const Shard& shard, std::uint64_t realizations) {
  if (shard.index >= shard.of || shard.of > realizations || shard.of > kMostShards) {
    throw std::invalid_argument("shard " + std::to_string(shard.index) + "/" + std::to_string(shard.of) +
                                ": must be I/N with I < N and N at most the " + std::to_string(realizations) +
                                " realizations and " + std::to_string(kMostShards));
  }
  return {boundary(shard.index, shard.of, realizations), boundary(shard.index + 1, shard.of, realizations)};
}

}  // namespace platoon
