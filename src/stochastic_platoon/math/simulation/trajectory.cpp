#include "stochastic_platoon/math/simulation/trajectory.hpp"

#include <algorithm>
#include <deque>
#include <utility>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

Trajectory of_leader(const PlatoonModel& model, std::size_t steps, bool has_input) {
  LeaderVehicle leader(model);
  Trajectory of;
  of.position.push_back(leader.start());
  if (has_input) of.input.push_back(0.0);
  for (std::size_t k = 0; k < steps; ++k) {
    check_interruption();
    of.position.push_back(leader.step());
    if (has_input) of.input.push_back(leader.input());
  }
  return of;
}

// y(k), y(k-1), ...; index k of the positions.
Signal::Recent<double> recent_positions(const Trajectory& of, std::size_t k, double slope) {
  Signal::Recent<double> recent{};
  for (std::size_t j = 0; j < recent.size(); ++j) {
    const std::size_t back = std::min(j, k);
    recent[j] = position_before(of.position[k - back], j - back, slope);
  }
  return recent;
}

std::vector<double> values_of(const Signal& signal, const Trajectory& predecessor, const Trajectory& of, double slope) {
  std::vector<double> values;
  if (signal.is_input && of.input.empty()) return values;
  if (signal.is_input) return {of.input.begin() + 1, of.input.end()};
  for (std::size_t k = 1; k < of.position.size(); ++k) {
    check_interruption();
    values.push_back(signal(recent_positions(predecessor, k, slope), recent_positions(of, k, slope)));
  }
  return values;
}

}  // namespace

void for_each_trajectory(const PlatoonModel& model, const WhiteNoise& noise, std::size_t followers, std::int64_t steps,
                         std::uint64_t realization, const std::vector<std::string>& signals,
                         const std::function<void(const Trajectory&)>& take) {
  const auto count = static_cast<std::size_t>(steps);
  const double slope = start_slope(model);
  const std::size_t farthest = farthest_ahead(model);
  Trajectory leader = of_leader(model, count, sends_input(model, 0, followers) || has_limits(model));
  leader.signals.resize(1);
  for (const Signal& signal : signals_of(model, signals, 1).requested) {
    const bool exists = !signal.is_relative() && !signal.is_input;
    leader.signals.push_back(exists ? values_of(signal, leader, leader, slope) : std::vector<double>());
  }
  std::deque<Trajectory> ahead{leader};  // trajectories of the vehicles directly ahead, the nearest first
  take(leader);
  for (std::uint32_t i = 1; i <= followers; ++i) {
    const std::vector<Input>& inputs = vehicle(model, i).inputs;
    const bool has_input = sends_input(model, i, followers) || measures_input(model, signals, i);
    FollowerVehicle follower(model, noise, i);
    std::vector<Link> links;
    std::vector<const Trajectory*> sources;
    for (std::uint32_t n = 0; n < inputs.size(); ++n) {
      links.emplace_back(model, noise, i, n);
      const std::size_t source = source_of(inputs[n], i);
      sources.push_back(source == 0 ? &leader : &ahead[i - 1 - source]);
    }
    const Trajectory& predecessor = ahead.front();
    Trajectory of;
    of.received.resize(inputs.size());
    of.position.resize(1);
    follower.start(realization, 1, of.position);
    if (has_input) of.input.push_back(0.0);
    std::vector<double> received(inputs.size());
    FollowerVehicle::Received places;
    for (const double& value : received) places.push_back(&value);
    for (std::size_t k = 0; k < count; ++k) {
      check_interruption();
      const std::int64_t sent_at = static_cast<std::int64_t>(k) - 1;
      double position, input = 0.0;
      const LinkEnds before = k > 0 ? LinkEnds{&predecessor.position[k - 1], &of.position[k - 1]} : LinkEnds{};
      for (std::size_t n = 0; n < inputs.size(); ++n) {
        const InputSignal signal = inputs[n].signal;
        double sent = signal == InputSignal::input ? sources[n]->input[k] : sources[n]->position[k];
        if (is_difference(signal))
          sent = difference(signal, model.sample_period)({}, recent_positions(*sources[n], k, slope));
        links[n].transmit(sent_at, realization, &sent, 1, &received[n], before);
        of.received[n].push_back(received[n]);
      }
      follower.step(places, &position, has_input ? &input : nullptr);
      of.position.push_back(position);
      if (has_input) of.input.push_back(input);
    }
    const FollowerSignals computed = signals_of(model, signals, i);
    of.signals.push_back(values_of(computed.error, predecessor, of, slope));
    for (const Signal& signal : computed.requested) of.signals.push_back(values_of(signal, predecessor, of, slope));
    take(of);
    ahead.push_front(std::move(of));
    if (ahead.size() > farthest) ahead.pop_back();
  }
}

}  // namespace platoon
