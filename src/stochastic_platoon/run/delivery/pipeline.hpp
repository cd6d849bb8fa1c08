#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace platoon {

/// Whether follower i of 1 .. N publishes ahead, that is, publishes its step k + 1 on its predecessor's step k. The
/// other followers publish their step k.
///
/// T is strictly proper: a follower that has its predecessor's step k can compute its own step k + 1. If all publish
/// ahead, no vehicle waits for another, but vehicle N is N steps ahead: the leader's first step triggers N^2 / 2
/// messages, and with a window of w steps w + N / 2 messages per vehicle are in flight. The pipeline depth is therefore
/// bounded in long strings, L = min(N, depth). The followers that publish ahead are spread evenly: follower i does if
/// and only if floor(L i / N) > floor(L (i - 1) / N).
constexpr bool publishes_ahead(std::size_t follower, std::size_t followers, std::size_t depth) {
  const std::size_t ahead = std::min(followers, depth);
  return ahead * follower / followers > ahead * (follower - 1) / followers;
}

/// Number of messages of all vehicles 0 .. N that the leader's first step triggers in a batch of `steps` steps (0:
/// endless). Vehicle i then sends 1 + floor(L i / N) messages, at most steps + 1.
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
