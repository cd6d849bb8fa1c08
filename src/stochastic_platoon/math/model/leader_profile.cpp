#include "stochastic_platoon/math/model/leader_profile.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace platoon {

LeaderProfile::LeaderProfile(const std::vector<SpeedChange>& changes, double sample_period)
    : changes_(changes), sample_period_(sample_period) {
  if (!(sample_period > 0.0) || !std::isfinite(sample_period)) {
    throw std::invalid_argument("sample_period: " + std::to_string(sample_period) + ": must be finite and > 0 [s]");
  }
  double position = 0.0;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const SpeedChange& change = changes[i];
    if (!std::isfinite(change.value)) throw std::invalid_argument("leader speed: must be finite [m/s]");
    const bool in_order = i == 0 ? change.from_step >= 0 : change.from_step > changes[i - 1].from_step;
    if (!in_order) {
      throw std::invalid_argument("leader from_step: " + std::to_string(change.from_step) +
                                  ": must be >= 0 and increase from one entry to the next");
    }
    if (i > 0) {
      const auto lasted = static_cast<double>(change.from_step - changes[i - 1].from_step);
      position += lasted * (sample_period * changes[i - 1].value);
    }
    position_at_change_.push_back(position);
  }
}

double LeaderProfile::speed(std::int64_t step) const {
  double present = 0.0;
  for (std::size_t i = 0; i < changes_.size() && changes_[i].from_step <= step; ++i) present = changes_[i].value;
  return present;
}

double LeaderProfile::position(std::int64_t step) const {
  std::size_t passed = 0;
  while (passed < changes_.size() && changes_[passed].from_step < step) ++passed;
  if (passed == 0) return 0.0;
  const SpeedChange& current = changes_[passed - 1];
  const auto lasted = static_cast<double>(step - current.from_step);
  return position_at_change_[passed - 1] + lasted * (sample_period_ * current.value);
}

}  // namespace platoon
