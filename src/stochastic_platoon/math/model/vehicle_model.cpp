#include "stochastic_platoon/math/model/vehicle_model.hpp"

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
  return one.signal == other.signal && one.gain == other.gain && one.noise_variance == other.noise_variance &&
         one.link == other.link && one.ahead == other.ahead && one.packet == other.packet;
}

std::size_t source_of(const Input& input, std::size_t follower) {
  return input.ahead == Input::kLeader || input.ahead > follower ? 0 : follower - input.ahead;
}

bool VehicleModel::hears_predecessor_only() const {
  const auto is_plain = [](const Input& input) { return input.ahead == 1 && input.packet.empty(); };
  return !constant_spacing && own_acceleration == 0.0 && inputs.size() <= 2 &&
         std::all_of(inputs.begin(), inputs.end(), is_plain) && inputs.front().signal == InputSignal::position &&
         inputs.front().gain == 1.0 && (inputs.size() == 1 || inputs.back().signal == InputSignal::input);
}

const Input& VehicleModel::position() const {
  for (const Input& input : inputs) {
    if (input.signal == InputSignal::position) return input;
  }
  return inputs.front();
}

std::vector<std::size_t> VehicleModel::varied_inputs() const {
  std::size_t last = inputs.size() - 1;
  if (!hears_predecessor_only()) {
    while (last > 0 && !inputs[last].link.loss) --last;
    if (!inputs[last].link.loss) last = inputs.size() - 1;
  }
  std::vector<std::size_t> found;
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    if (losses_of(n) == losses_of(last)) found.push_back(n);
  }
  return found;
}

std::size_t VehicleModel::losses_of(std::size_t n) const {
  for (std::size_t j = 0; j < n && !inputs[n].packet.empty(); ++j) {
    if (inputs[j].packet == inputs[n].packet) return j;
  }
  return n;
}

double spacing_in_vehicles(const VehicleModel& vehicle, std::size_t follower) {
  double sum = 0.0;
  for (const Input& input : vehicle.inputs) {
    if (input.signal == InputSignal::position)
      sum += input.gain * static_cast<double>(follower - source_of(input, follower));
  }
  return sum;
}

double own_speed_gain(const VehicleModel& vehicle, double sample_period) {
  double sum = 0.0;
  for (const Input& input : vehicle.inputs) {
    if (input.signal == InputSignal::speed) sum += input.gain / sample_period;
  }
  return sum;
}

}  // namespace platoon
