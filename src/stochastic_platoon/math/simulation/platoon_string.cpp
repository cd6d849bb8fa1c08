#include "stochastic_platoon/math/simulation/platoon_string.hpp"

#include <algorithm>

namespace platoon {

PlatoonString::PlatoonString(const PlatoonModel& model, std::uint64_t seed, std::size_t followers)
    : leader_(model), predecessor_(kStepsAtOnce + 1), own_(kStepsAtOnce + 1) {
  for (std::uint32_t i = 1; i <= followers; ++i) {
    followers_.emplace_back(model, seed, i);
    links_.emplace_back(model, seed, i);
    error_.push_back(tracking_error(model, i));
  }
}

void PlatoonString::run(std::uint64_t first, std::size_t count, std::int64_t steps, const ErrorSink& sink) {
  received_.resize(count);
  errors_.resize(count);
  for (AlignedValues& positions : predecessor_) positions.resize(count);
  for (AlignedValues& positions : own_) positions.resize(count);
  latest_.resize(followers_.size() + 1);
  latest_[0].assign(count, leader_.start());
  for (std::size_t i = 1; i < latest_.size(); ++i) followers_[i - 1].start(first, count, latest_[i]);
  for (std::int64_t from = 0; from < steps; from += kStepsAtOnce) {
    const auto here = static_cast<std::size_t>(std::min(kStepsAtOnce, steps - from));
    own_[0].assign(latest_[0].begin(), latest_[0].end());
    for (std::size_t j = 1; j <= here; ++j) own_[j].assign(count, leader_.step());
    latest_[0].assign(own_[here].begin(), own_[here].end());
    for (std::size_t i = 1; i < latest_.size(); ++i) {
      own_.swap(predecessor_);
      own_[0].assign(latest_[i].begin(), latest_[i].end());
      for (std::size_t j = 1; j <= here; ++j) {
        const std::int64_t k = from + static_cast<std::int64_t>(j) - 1;
        links_[i - 1].transmit(k - 1, first, predecessor_[j - 1].data(), count, received_.data());
        followers_[i - 1].step(received_.data(), own_[j].data());
        error_[i - 1](predecessor_[j].data(), own_[j].data(), own_[j - 1].data(), count, errors_.data());
        sink(i, k, errors_);
      }
      latest_[i].assign(own_[here].begin(), own_[here].end());
    }
  }
}

}  // namespace platoon
