#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace platoon {

/// Whether follower i of 1 .. N publishes ahead: its step k + 1 on its predecessor's step k; the others publish their
/// step k.
///
/// T is strictly proper: a follower that has its predecessor's step k knows its own step k + 1. If all publish ahead,
/// no vehicle waits for another, but vehicle N is N steps ahead: the leader's first step sets N^2 / 2 messages going,
/// and with a window of w steps w + N / 2 messages a vehicle are on their way. In long strings the depth of this
/// pipeline is therefore bounded, L = min(N, depth), and the followers that publish ahead are spread evenly: i is one
/// of them if and only if floor(L i / N) > floor(L (i - 1) / N).
constexpr bool publishes_ahead(std::size_t follower, std::size_t followers, std::size_t depth) {
  const std::size_t ahead = std::min(followers, depth);
  return ahead * follower / followers > ahead * (follower - 1) / followers;
}

/// Messages of all vehicles 0 .. N that the leader's first step sets going, of a batch of `steps` steps: vehicle i has
/// then sent 1 + floor(L i / N), or all that there are. 0 steps: an endless batch.
inline std::uint64_t messages_of_first_step(std::size_t followers, std::size_t depth, std::int64_t steps) {
  const std::uint64_t all = steps == 0 ? UINT64_MAX : static_cast<std::uint64_t>(steps) + 1;
  std::uint64_t messages = 1, sent = 1;
  for (std::size_t i = 1; i <= followers; ++i) {
    sent += publishes_ahead(i, followers, depth) ? 1 : 0;
    messages += std::min(sent, all);
  }
  return messages;
}

}  // namespace platoon
