#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"

namespace platoon {

namespace {

// Minus the sum of the distances of followers 1 .. follower, each to its predecessor.
template <class Distance>
double place_of(const PlatoonModel& model, std::size_t follower, const Distance& distance) {
  if (is_homogeneous(model)) return -static_cast<double>(follower) * distance(model.default_vehicle());
  const auto distance_up_to = [&](std::size_t last) {
    double sum = 0.0;
    for (std::size_t i = 1; i <= last; ++i) sum += distance(vehicle(model, i));
    return sum;
  };
  const std::size_t length = model.string.size();
  const std::size_t patterns = follower / length;
  return -(static_cast<double>(patterns) * distance_up_to(length) + distance_up_to(follower % length));
}

}  // namespace

std::vector<double> steady_places(const PlatoonModel& model, std::size_t followers, double slope,
                                  const std::function<double(const VehicleModel& own, const Input& input)>& late) {
  std::vector<double> places{0.0};
  for (std::size_t i = 1; i <= followers; ++i) {
    const VehicleModel& own = vehicle(model, i);
    double place = -spacing_in_vehicles(own, i) * (slope * own.headway + own.standstill_distance);
    for (const Input& input : own.inputs) {
      const bool is_position = input.signal == InputSignal::position;
      place += is_position ? input.gain * (places[source_of(input, i)] - late(own, input)) : -late(own, input);
    }
    places.push_back(place);
  }
  return places;
}

bool starts_steady(const PlatoonModel& model) {
  return model.start ? *model.start == Start::steady : has_limits(model);
}

double start_slope(const PlatoonModel& model) {
  const std::vector<double>& recorded = model.recorded_leader;
  if (!starts_steady(model) || recorded.size() == 1) return 0.0;
  return recorded.empty() ? model.sample_period * model.leader.speed(0) : recorded[1] - recorded[0];
}

double start_place(const PlatoonModel& model, std::size_t follower) {
  const double slope = start_slope(model), place = place_in_formation(model, follower);
  if (!starts_steady(model)) return place;
  const double leader = model.recorded_leader.empty() ? 0.0 - slope : model.recorded_leader.front();
  if (!hears_predecessors_only(model)) {
    const auto late = [slope](const VehicleModel&, const Input& input) {
      return input.signal == InputSignal::position ? slope * static_cast<double>(input.link.delay) : 0.0;
    };
    return leader + steady_places(model, follower, slope, late).back();
  }
  return leader + place + slope * place_of(model, follower, [](const VehicleModel& own) {
                            return own.headway + static_cast<double>(own.position().link.delay);
                          });
}

double place_in_formation(const PlatoonModel& model, std::size_t follower) {
  return place_of(model, follower, [](const VehicleModel& own) { return own.standstill_distance; });
}

}  // namespace platoon
