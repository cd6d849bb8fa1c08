#include "stochastic_platoon/math/simulation/platoon_string.hpp"
#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"

#include <algorithm>

namespace platoon {

namespace {

// Earlier positions that the links need.
std::size_t earlier_positions(const PlatoonModel& model) {
  std::size_t before = depends_on_gap(model) ? 2 : 1;
  for (const VehicleModel& of : pattern(model)) {
    for (const Input& input : of.inputs) {
      if (input.signal == InputSignal::speed) before = std::max<std::size_t>(before, 2);
      if (input.signal == InputSignal::acceleration) before = std::max<std::size_t>(before, 3);
    }
  }
  return before;
}

}  // namespace

PlatoonString::PlatoonString(const PlatoonModel& model, const WhiteNoise& noise, std::size_t followers,
                             std::size_t before, const std::vector<std::string>& signals)
    : leader_(model),
      slope_(start_slope(model)),
      measured_{false},
      before_(std::max(before, earlier_positions(model))),
      motions_(farthest_ahead(model) + 1) {
  for (std::uint32_t i = 1; i <= followers; ++i) {
    measured_.push_back(measures_input(model, signals, i));
    followers_.push_back({FollowerVehicle(model, noise, i), {}});
    const std::vector<Input>& inputs = vehicle(model, i).inputs;
    for (std::uint32_t n = 0; n < inputs.size(); ++n) {
      followers_.back().wires.push_back(
          {source_of(inputs[n], i), inputs[n].signal, Link(model, noise, i, n), std::nullopt});
      if (is_difference(inputs[n].signal))
        followers_.back().wires.back().difference = difference(inputs[n].signal, model.sample_period);
    }
    received_.resize(std::max(received_.size(), inputs.size()));
  }
  needs_input_ = measured_;
  for (const Follower& follower : followers_) {
    for (const Wire& wire : follower.wires) {
      if (wire.signal == InputSignal::input) needs_input_[wire.source] = true;
    }
  }
  motions_.resize(std::min(motions_.size(), followers + 1));
  leader_motion_ = {std::vector<AlignedValues>(kStepsAtOnce + before_), std::vector<AlignedValues>(kStepsAtOnce + 1)};
  std::fill(motions_.begin(), motions_.end(), leader_motion_);
}

void PlatoonString::run(std::uint64_t first, std::size_t count, std::int64_t steps, const PositionSink& sink) {
  start(first, count);
  for (std::int64_t from = 0; from < steps; from += kStepsAtOnce) {
    const auto here = static_cast<std::size_t>(std::min(kStepsAtOnce, steps - from));
    begin(0);
    move_leader(here, count);
    for (std::size_t i = 1; i < latest_.size(); ++i) {
      if (i > motions_.size()) keep(i - motions_.size(), here);
      begin(i);
      move(i, from, here, first, count, sink);
    }
    const std::size_t last = latest_.size() - 1;
    for (std::size_t i = last - std::min(last, motions_.size()) + 1; i <= last; ++i) keep(i, here);
    keep(0, here);
  }
}

// Step -1.
void PlatoonString::start(std::uint64_t first, std::size_t count) {
  sent_.resize(count);
  for (AlignedValues& received : received_) received.resize(count);
  const bool any_input = std::find(needs_input_.begin(), needs_input_.end(), true) != needs_input_.end();
  const auto resize = [&](Motion& motion) {
    for (AlignedValues& positions : motion.positions) positions.resize(count);
    for (AlignedValues& inputs : motion.inputs) inputs.resize(any_input ? count : 0);
  };
  resize(leader_motion_);
  std::for_each(motions_.begin(), motions_.end(), resize);
  latest_.resize(followers_.size() + 1);
  latest_inputs_.assign(latest_.size(), {});
  for (std::size_t i = 0; i < latest_.size(); ++i) {
    if (needs_input_[i]) latest_inputs_[i].assign(count, 0.0);
    std::vector<double> at_start(count, leader_.start());
    if (i > 0) followers_[i - 1].vehicle.start(first, count, at_start);
    latest_[i].assign(before_, AlignedValues(at_start.begin(), at_start.end()));
    for (std::size_t b = 0; slope_ != 0.0 && b + 1 < before_; ++b) {
      for (double& position : latest_[i][b]) position = position_before(position, before_ - 1 - b, slope_);
    }
  }
}

void PlatoonString::begin(std::size_t i) {
  Motion& own = motion(i);
  for (std::size_t b = 0; b < before_; ++b) own.positions[b].swap(latest_[i][b]);
  if (needs_input_[i]) own.inputs[0].assign(latest_inputs_[i].begin(), latest_inputs_[i].end());
}

// To be called only after all followers have read the positions.
void PlatoonString::keep(std::size_t i, std::size_t steps) {
  Motion& own = motion(i);
  for (std::size_t b = 0; b < before_; ++b) own.positions[steps + b].swap(latest_[i][b]);
  if (needs_input_[i]) latest_inputs_[i].assign(own.inputs[steps].begin(), own.inputs[steps].end());
}

void PlatoonString::move_leader(std::size_t steps, std::size_t count) {
  for (std::size_t j = 1; j <= steps; ++j) {
    leader_motion_.positions[before_ - 1 + j].assign(count, leader_.step());
    if (needs_input_[0]) leader_motion_.inputs[j].assign(count, leader_.input());
  }
}

void PlatoonString::move(std::size_t i, std::int64_t from, std::size_t steps, std::uint64_t first, std::size_t count,
                         const PositionSink& sink) {
  Follower& follower = followers_[i - 1];
  Motion& own = motion(i);
  const Motion& predecessor = motion(i - 1);
  received_at_.resize(follower.wires.size());
  for (std::size_t j = 1; j <= steps; ++j) {
    const std::int64_t k = from + static_cast<std::int64_t>(j) - 1;
    const std::size_t at = before_ - 1 + j;  // of step k
    const LinkEnds before =
        before_ > 1 ? LinkEnds{predecessor.positions[at - 2].data(), own.positions[at - 2].data()} : LinkEnds{};
    for (std::size_t n = 0; n < follower.wires.size(); ++n) {
      Wire& wire = follower.wires[n];
      const Motion& source = motion(wire.source);
      const double* sent = source.positions[at - 1].data();
      if (wire.signal == InputSignal::input) sent = source.inputs[j - 1].data();
      if (wire.difference) {
        Signal::Recent<const double*> positions{};
        for (std::size_t b = 0; b + 1 <= std::min(before_, positions.size()); ++b)
          positions[b] = source.positions[at - 1 - b].data();
        (*wire.difference)({}, positions, count, sent_.data());
        sent = sent_.data();
      }
      wire.link.transmit(k - 1, first, sent, count, received_[n].data(), before);
      received_at_[n] = received_[n].data();
    }
    follower.vehicle.step(received_at_, own.positions[at].data(), needs_input_[i] ? own.inputs[j].data() : nullptr);
    SignalPositions positions{{}, {}, count};
    for (std::size_t b = 0; b <= before_; ++b) {
      positions.ahead[b] = predecessor.positions[at - b].data();
      positions.own[b] = own.positions[at - b].data();
    }
    if (measured_[i]) positions.input = own.inputs[j].data();
    sink(i, k, positions);
  }
}

}  // namespace platoon
