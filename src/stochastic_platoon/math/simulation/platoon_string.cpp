#include "stochastic_platoon/math/simulation/platoon_string.hpp"

#include <algorithm>

namespace platoon {

PlatoonString::PlatoonString(const PlatoonModel& model, const WhiteNoise& noise, std::size_t followers,
                             std::size_t before, const std::vector<std::string>& signals)
    : leader_(model),
      slope_(start_slope(model)),
      before_(std::max(before, depends_on_gap(model) ? std::size_t{2} : std::size_t{1})),
      predecessor_(kStepsAtOnce + before_),
      own_(kStepsAtOnce + before_),
      predecessor_inputs_(kStepsAtOnce + 1),
      own_inputs_(kStepsAtOnce + 1) {
  measured_.push_back(false);
  for (std::uint32_t i = 1; i <= followers; ++i) {
    measured_.push_back(measures_input(model, signals, i));
    followers_.emplace_back(model, noise, i);
    links_.emplace_back(model, noise, i);
    radios_.emplace_back();
    if (sends_input(model, i - 1, followers)) radios_.back().emplace(Link(model, noise, i, 1));
  }
}

void PlatoonString::run(std::uint64_t first, std::size_t count, std::int64_t steps, const PositionSink& sink) {
  received_.resize(count);
  for (AlignedValues& positions : predecessor_) positions.resize(count);
  for (AlignedValues& positions : own_) positions.resize(count);
  const auto sends = [this](std::size_t i) { return measured_[i] || (i < radios_.size() && radios_[i].has_value()); };
  latest_.resize(followers_.size() + 1);
  latest_inputs_.assign(latest_.size(), {});
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    if (!sends(i)) continue;
    heard_.resize(count);
    latest_inputs_[i].assign(count, 0.0);
    for (auto* inputs : {&predecessor_inputs_, &own_inputs_}) {
      for (AlignedValues& of_step : *inputs) of_step.resize(count);
    }
  }
  for (std::size_t i = 0; i < latest_.size(); ++i) {
    std::vector<double> start(count, leader_.start());
    if (i > 0) followers_[i - 1].start(first, count, start);
    latest_[i].assign(before_, AlignedValues(start.begin(), start.end()));
    for (std::size_t b = 0; slope_ != 0.0 && b + 1 < before_; ++b) {
      for (double& position : latest_[i][b]) position = position_before(position, before_ - 1 - b, slope_);
    }
  }
  for (std::int64_t from = 0; from < steps; from += kStepsAtOnce) {
    const auto here = static_cast<std::size_t>(std::min(kStepsAtOnce, steps - from));
    const auto begin = [&](std::size_t i) {
      for (std::size_t b = 0; b < before_; ++b) own_[b].swap(latest_[i][b]);
      if (sends(i)) own_inputs_[0].assign(latest_inputs_[i].begin(), latest_inputs_[i].end());
    };
    const auto end = [&](std::size_t i) {
      if (sends(i)) latest_inputs_[i].assign(own_inputs_[here].begin(), own_inputs_[here].end());
    };
    // To be called only after the follower has read the positions.
    const auto keep_latest = [&](std::size_t i, std::vector<AlignedValues>& positions) {
      for (std::size_t b = 0; b < before_; ++b) positions[here + b].swap(latest_[i][b]);
    };
    begin(0);
    for (std::size_t j = 1; j <= here; ++j) {
      own_[before_ - 1 + j].assign(count, leader_.step());
      if (sends(0)) own_inputs_[j].assign(count, leader_.input());
    }
    end(0);
    for (std::size_t i = 1; i < latest_.size(); ++i) {
      own_.swap(predecessor_);
      own_inputs_.swap(predecessor_inputs_);
      begin(i);
      std::optional<Link>& radio = radios_[i - 1];
      for (std::size_t j = 1; j <= here; ++j) {
        const std::int64_t k = from + static_cast<std::int64_t>(j) - 1;
        const std::size_t at = before_ - 1 + j;  // of step k
        const LinkEnds before = before_ > 1 ? LinkEnds{predecessor_[at - 2].data(), own_[at - 2].data()} : LinkEnds{};
        links_[i - 1].transmit(k - 1, first, predecessor_[at - 1].data(), count, received_.data(), before);
        if (radio) radio->transmit(k - 1, first, predecessor_inputs_[j - 1].data(), count, heard_.data(), before);
        followers_[i - 1].step(received_.data(), own_[at].data(), radio ? heard_.data() : nullptr,
                               sends(i) ? own_inputs_[j].data() : nullptr);
        SignalPositions positions{predecessor_[at].data(), {}, count};
        for (std::size_t b = 0; b <= before_; ++b) positions.own[b] = own_[at - b].data();
        if (measured_[i]) positions.input = own_inputs_[j].data();
        sink(i, k, positions);
      }
      end(i);
      keep_latest(i - 1, predecessor_);
    }
    keep_latest(latest_.size() - 1, own_);
  }
}

}  // namespace platoon
