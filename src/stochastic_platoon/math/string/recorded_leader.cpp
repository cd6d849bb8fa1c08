#include "stochastic_platoon/math/string/recorded_leader.hpp"

#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"

namespace platoon {

std::vector<double> mean_errors_behind_recorded_leader(const PlatoonModel& model, std::size_t followers,
                                                       std::int64_t steps) {
  if (followers < 1 || steps < 1) throw std::invalid_argument("followers, steps: must be >= 1");
  const auto count = static_cast<std::size_t>(steps) + 1;
  if (model.recorded_leader.size() < count) {
    throw std::invalid_argument("recorded leader: " + std::to_string(model.recorded_leader.size()) +
                                " positions: must be at least steps + 1 = " + std::to_string(count));
  }
  PlatoonModel without_noise = model;
  without_noise.default_vehicle().initial_position.variance = 0.0;
  const Signal error = tracking_error(model, 1);
  std::vector<double> predecessor(model.recorded_leader.begin(),
                                  model.recorded_leader.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<double> errors;
  errors.reserve(followers * (count - 1));
  for (std::uint32_t i = 1; i <= followers; ++i) {
    FollowerVehicle follower(without_noise, 0, i);
    std::vector<double> own(1), positions;
    follower.start(0, 1, own);
    positions.push_back(own.front());
    for (std::size_t k = 0; k + 1 < count; ++k) {
      follower.step({predecessor[k]}, own);
      errors.push_back(error(predecessor[k + 1], {own.front(), positions.back()}));
      positions.push_back(own.front());
    }
    predecessor.swap(positions);
  }
  return errors;
}

}  // namespace platoon
