#include "stochastic_platoon/math/simulation/platoon_string.hpp"

#include <algorithm>

namespace platoon {

PlatoonString::PlatoonString(const PlatoonModel& model, std::uint64_t seed, std::size_t followers)
    : leader_(model),
      predecessor_(kStepsAtOnce + 1),
      own_(kStepsAtOnce + 1),
      predecessor_inputs_(kStepsAtOnce + 1),
      own_inputs_(kStepsAtOnce + 1) {
  for (std::uint32_t i = 1; i <= followers; ++i) {
    followers_.emplace_back(model, seed, i);
    links_.emplace_back(model, seed, i);
    radios_.emplace_back();
    if (sends_input(model, i - 1, followers)) radios_.back().emplace(Link::radio(model, seed, i));
    error_.push_back(tracking_error(model, i));
  }
}

void PlatoonString::run(std::uint64_t first, std::size_t count, std::int64_t steps, const ErrorSink& sink) {
  received_.resize(count);
  errors_.resize(count);
  for (AlignedValues& positions : predecessor_) positions.resize(count);
  for (AlignedValues& positions : own_) positions.resize(count);
  const auto sends = [this](std::size_t i) { return i < radios_.size() && radios_[i].has_value(); };
  latest_.resize(followers_.size() + 1);
  latest_inputs_.assign(latest_.size(), {});
  for (std::size_t i = 0; i < radios_.size(); ++i) {
    if (!sends(i)) continue;
    heard_.resize(count);
    latest_inputs_[i].assign(count, 0.0);
    for (auto* inputs : {&predecessor_inputs_, &own_inputs_}) {
      for (AlignedValues& of_step : *inputs) of_step.resize(count);
    }
  }
  latest_[0].assign(count, leader_.start());
  for (std::size_t i = 1; i < latest_.size(); ++i) followers_[i - 1].start(first, count, latest_[i]);
  for (std::int64_t from = 0; from < steps; from += kStepsAtOnce) {
    const auto here = static_cast<std::size_t>(std::min(kStepsAtOnce, steps - from));
    const auto begin = [&](std::size_t i) {
      own_[0].assign(latest_[i].begin(), latest_[i].end());
      if (sends(i)) own_inputs_[0].assign(latest_inputs_[i].begin(), latest_inputs_[i].end());
    };
    const auto end = [&](std::size_t i) {
      latest_[i].assign(own_[here].begin(), own_[here].end());
      if (sends(i)) latest_inputs_[i].assign(own_inputs_[here].begin(), own_inputs_[here].end());
    };
    begin(0);
    for (std::size_t j = 1; j <= here; ++j) {
      own_[j].assign(count, leader_.step());
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
        links_[i - 1].transmit(k - 1, first, predecessor_[j - 1].data(), count, received_.data());
        if (radio) radio->transmit(k - 1, first, predecessor_inputs_[j - 1].data(), count, heard_.data());
        followers_[i - 1].step(received_.data(), own_[j].data(), radio ? heard_.data() : nullptr,
                               sends(i) ? own_inputs_[j].data() : nullptr);
        error_[i - 1](predecessor_[j].data(), own_[j].data(), own_[j - 1].data(), count, errors_.data());
        sink(i, k, errors_);
      }
      end(i);
    }
  }
}

}  // namespace platoon
