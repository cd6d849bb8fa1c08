#include "stochastic_platoon/math/simulation/trajectory.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "stochastic_platoon/math/channel/link.hpp"
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

std::vector<double> values_of(const Signal& signal, const Trajectory& predecessor, const Trajectory& of, double slope) {
  std::vector<double> values;
  if (signal.is_input) return {of.input.begin() + 1, of.input.end()};
  for (std::size_t k = 1; k < of.position.size(); ++k) {
    check_interruption();
    Signal::Own<double> own{};
    for (std::size_t j = 0; j < own.size(); ++j) {
      const std::size_t back = std::min(j, k);
      own[j] = position_before(of.position[k - back], j - back, slope);
    }
    values.push_back(signal(predecessor.position[k], own));
  }
  return values;
}

}  // namespace

void for_each_trajectory(const PlatoonModel& model, const WhiteNoise& noise, std::size_t followers, std::int64_t steps,
                         std::uint64_t realization, const std::vector<std::string>& signals,
                         const std::function<void(const Trajectory&)>& take) {
  const auto count = static_cast<std::size_t>(steps);
  const double slope = start_slope(model);
  Trajectory predecessor = of_leader(model, count, sends_input(model, 0, followers) || has_limits(model));
  take(predecessor);
  for (std::uint32_t i = 1; i <= followers; ++i) {
    const bool hears = vehicle(model, i).radio() != nullptr,
               has_input = sends_input(model, i, followers) || measures_input(model, signals, i);
    FollowerVehicle follower(model, noise, i);
    Link link(model, noise, i);
    std::optional<Link> radio;
    if (hears) radio.emplace(model, noise, i, 1);
    Trajectory of;
    of.position.resize(1);
    follower.start(realization, 1, of.position);
    if (has_input) of.input.push_back(0.0);
    for (std::size_t k = 0; k < count; ++k) {
      check_interruption();
      const std::int64_t sent_at = static_cast<std::int64_t>(k) - 1;
      double received, heard = 0.0, position, input = 0.0;
      const LinkEnds before = k > 0 ? LinkEnds{&predecessor.position[k - 1], &of.position[k - 1]} : LinkEnds{};
      link.transmit(sent_at, realization, &predecessor.position[k], 1, &received, before);
      if (hears) radio->transmit(sent_at, realization, &predecessor.input[k], 1, &heard, before);
      follower.step(&received, &position, hears ? &heard : nullptr, has_input ? &input : nullptr);
      of.position.push_back(position);
      of.received.push_back(received);
      if (hears) of.received_input.push_back(heard);
      if (has_input) of.input.push_back(input);
    }
    const FollowerSignals computed = signals_of(model, signals, i);
    of.signals.push_back(values_of(computed.error, predecessor, of, slope));
    for (const Signal& signal : computed.requested) of.signals.push_back(values_of(signal, predecessor, of, slope));
    take(of);
    predecessor = std::move(of);
  }
}

}  // namespace platoon
