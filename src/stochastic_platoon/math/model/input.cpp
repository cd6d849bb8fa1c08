#include "stochastic_platoon/math/model/input.hpp"

#include <algorithm>

namespace platoon {

const char* name_of(InputSignal signal) {
  switch (signal) {
    case InputSignal::position:
      return "position";
    case InputSignal::speed:
      return "speed";
    case InputSignal::acceleration:
      return "acceleration";
    default:
      return "input";
  }
}

bool operator==(const Input& one, const Input& other) {
  // All members have names, so that a new one does not compile until it is compared.
  const auto& [signal, noise_variance, gain, link, ahead, packet] = one;
  return signal == other.signal && gain == other.gain && noise_variance == other.noise_variance && link == other.link &&
         ahead == other.ahead && packet == other.packet;
}

std::size_t source_of(const Input& input, std::size_t follower) {
  return input.ahead == Input::kLeader || input.ahead > follower ? 0 : follower - input.ahead;
}

std::size_t varied_losses(const std::vector<LossPlace>& inputs) {
  const auto is_position = [](const LossPlace& of) { return of.is_position; };
  const bool positions_alone = std::all_of(inputs.begin(), inputs.end(), is_position);
  std::size_t last = 0;
  bool loses = false;
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    if (inputs[n].is_position && !positions_alone) continue;
    const std::size_t first = first_of_packet(inputs, n);
    if (loses && !inputs[first].loses) continue;
    last = first;
    loses = inputs[first].loses;
  }
  return last;
}

}  // namespace platoon
