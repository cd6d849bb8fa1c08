#include "stochastic_platoon/math/model/input.hpp"

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
  return one.signal == other.signal && one.gain == other.gain && one.noise_variance == other.noise_variance &&
         one.link == other.link && one.ahead == other.ahead && one.packet == other.packet;
}

std::size_t source_of(const Input& input, std::size_t follower) {
  return input.ahead == Input::kLeader || input.ahead > follower ? 0 : follower - input.ahead;
}

}  // namespace platoon
