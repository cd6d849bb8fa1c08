#pragma once

#include <cstdint>
#include <vector>

namespace platoon {

/// What a link or channel makes of these values.
template <class Channel, class... Ends>
std::vector<double> transmitted(Channel&& channel, std::int64_t step, std::uint64_t first_realization,
                                const std::vector<double>& sent, const Ends&... ends) {
  std::vector<double> received(sent.size());
  channel.transmit(step, first_realization, sent.data(), sent.size(), received.data(), ends...);
  return received;
}

}  // namespace platoon
