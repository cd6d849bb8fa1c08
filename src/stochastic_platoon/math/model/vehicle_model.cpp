#include "stochastic_platoon/math/model/vehicle_model.hpp"

#include <algorithm>
#include <utility>

#include "stochastic_platoon/math/model/input.hpp"

namespace platoon {

VehicleModel::VehicleModel(ClosedLoop of, double steps) : loop(std::move(of)), headway(steps), inputs(1) {}
VehicleModel::VehicleModel(const VehicleModel&) = default;
VehicleModel::VehicleModel(VehicleModel&&) noexcept = default;
VehicleModel& VehicleModel::operator=(const VehicleModel&) = default;
VehicleModel& VehicleModel::operator=(VehicleModel&&) noexcept = default;
VehicleModel::~VehicleModel() = default;

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

const Input* VehicleModel::radio() const {
  return inputs.size() > 1 ? &inputs.back() : nullptr;
}

std::vector<std::size_t> VehicleModel::varied_inputs() const {
  std::vector<LossPlace> places;
  for (const Input& input : inputs)
    places.push_back({input.signal == InputSignal::position, input.link.loss.has_value(), input.packet});
  const std::size_t varied = varied_losses(places);
  std::vector<std::size_t> found;
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    if (losses_of(n) == varied) found.push_back(n);
  }
  return found;
}

const LinkModel& VehicleModel::varied_link() const {
  return inputs[varied_inputs().front()].link;
}

void VehicleModel::vary(const std::function<void(LinkModel&)>& change) {
  for (const std::size_t n : varied_inputs()) change(inputs[n].link);
}

std::size_t VehicleModel::losses_of(std::size_t n) const {
  return first_of_packet(inputs, n);
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
