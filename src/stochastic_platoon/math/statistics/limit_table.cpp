#include "stochastic_platoon/math/statistics/limit_table.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace detail {

PLATOON_VECTOR_CLONES
std::uint64_t count_equal(const double* values, std::size_t count, double value) {
  std::uint64_t found = 0;
  for (std::size_t r = 0; r < count; ++r) found += values[r] == value ? 1u : 0u;
  return found;
}

// Of displacements up to, or down to, those of a limit.
PLATOON_VECTOR_CLONES
std::array<std::uint64_t, 2> count_beyond(const double* own, const double* before, std::size_t count, double lower,
                                          double upper) {
  std::uint64_t low = 0, high = 0;
  for (std::size_t r = 0; r < count; ++r) {
    const double moved = own[r] - before[r];
    low += moved <= lower ? 1u : 0u;
    high += moved >= upper ? 1u : 0u;
  }
  return {low, high};
}

}  // namespace detail

std::vector<CountedLimits> counted_limits(const PlatoonModel& model, std::size_t followers) {
  std::vector<CountedLimits> counted;
  for (std::size_t i = 1; i <= followers && has_limits(model); ++i)
    counted.push_back({vehicle(model, i).limits, model.sample_period});
  return counted;
}

AtLimits count_at_limits(const CountedLimits& counted, const SignalPositions& positions) {
  constexpr double kSame = 1e-6;  // [m/s]
  const std::optional<Interval>&input = counted.limits.input, &speed = counted.limits.speed;
  AtLimits found{};
  if (input && positions.input != nullptr) {
    found[0] = detail::count_equal(positions.input, positions.count, input->lower);
    found[1] = detail::count_equal(positions.input, positions.count, input->upper);
  }
  if (speed) {
    const auto [low, high] = detail::count_beyond(positions.own[0], positions.own[1], positions.count,
                                                  (speed->lower + kSame) * counted.sample_period,
                                                  (speed->upper - kSame) * counted.sample_period);
    found[2] = low;
    found[3] = high;
  }
  return found;
}

void LimitTable::add(std::size_t follower, const AtLimits& more) {
  for (std::size_t j = 0; j < more.size(); ++j) followers_.at(follower - 1)[j] += more[j];
}

void LimitTable::merge(const LimitTable& other) {
  if (other.followers_.size() != followers_.size())
    throw std::invalid_argument("limits of " + std::to_string(other.followers_.size()) + " followers: must be of " +
                                std::to_string(followers_.size()));
  for (std::size_t i = 0; i < followers_.size(); ++i) add(i + 1, other.followers_[i]);
}

}  // namespace platoon
