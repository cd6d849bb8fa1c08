#include "stochastic_platoon/math/links/chain_moments.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/math/links/chain_follower.hpp"
#include "stochastic_platoon/math/links/leader_motion.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/linear_model.hpp"

namespace platoon {

std::vector<SignalMoments> chain_moments(const PlatoonModel& model, const SignalLists& signals, std::int64_t steps) {
  const std::size_t followers = signals.size();
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  const auto count = static_cast<Eigen::Index>(steps) + 1;
  const bool plain = hears_predecessors_only(model);
  for (const VehicleModel& vehicle : pattern(model)) {
    if (plain) unit_equilibrium(vehicle.loop.realization);
  }
  Motion leader =
      leader_motion(start_slope(model) != 0.0 ? in_moving_frame(model) : model, static_cast<std::size_t>(steps));
  leader.input.resize(leader.position.size(), 0.0L);
  const bool has_inputs = has_radios(model) || std::any_of(signals.front().begin(), signals.front().end(),
                                                           [](const Signal& signal) { return signal.is_input; });
  const Eigen::Index blocks = has_inputs ? 2 : 1;
  Ahead ahead;
  std::vector<SignalMoments> moments(signals.front().size(), {steps, followers});
  for (std::size_t i = 1; i <= followers; ++i) {
    const ChainFollower follower(model, i, count, blocks);
    const Moved own = follower.behind(ahead, leader);
    for (std::size_t s = 0; s < moments.size(); ++s)
      follower.add_moments(signals[i - 1][s], own, ahead, leader, moments[s]);
    ahead = ahead.behind(i, follower.placed(own), farthest_ahead(model));
  }
  return moments;
}

SignalMoments chain_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  return chain_moments(model, signal_lists(model, {}, followers), steps).front();
}

bool needs_chain_moments(const PlatoonModel& model) {
  if (has_bursts(model)) return true;
  const bool plain = hears_predecessors_only(model);
  if (plain && start_slope(model) == 0.0) return false;
  const std::vector<VehicleModel> vehicles = pattern(model);
  return std::any_of(vehicles.begin(), vehicles.end(), [plain](const VehicleModel& of) {
    return std::any_of(of.inputs.begin(), of.inputs.end(), [plain](const Input& input) {
      return input.link.loses() && (!plain || input.signal == InputSignal::position);
    });
  });
}

std::int64_t most_chain_steps(const PlatoonModel& model, std::size_t followers, double share_of_time) {
  constexpr double kMostCells = 1e8, kMostSteps = 2000.0;  // followers x steps^2, and steps
  std::size_t most_inputs = 1;
  for (const VehicleModel& of : pattern(model)) most_inputs = std::max(most_inputs, of.inputs.size());
  const std::size_t blocks = farthest_ahead(model) * (has_radios(model) ? 2 : 1);
  const double most = std::min(kMostSteps, std::sqrt(share_of_time * kMostCells / static_cast<double>(followers)));
  return static_cast<std::int64_t>(most / static_cast<double>(std::max(most_inputs, blocks)));
}

}  // namespace platoon
