#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/model/vehicle_limits.hpp"

namespace platoon {

struct PlatoonModel;
struct SignalPositions;

/// How often a follower was at its limits: the input at the lower and at the upper one, then the speed.
using AtLimits = std::array<std::uint64_t, 4>;

/// The limits of one follower and the sample period, by which its speed follows from its positions [s].
struct CountedLimits {
  VehicleLimits limits;
  double sample_period;
};

/// The limits of followers 1, ..., `followers`; empty if no vehicle has any.
std::vector<CountedLimits> counted_limits(const PlatoonModel& model, std::size_t followers);

/// The realizations at the limits at one step. The input is limited exactly; a speed D y / T_s counts within 1e-6 m/s,
/// as positions of kilometres are rounded.
AtLimits count_at_limits(const CountedLimits& counted, const SignalPositions& positions);

/// The steps at the limits of every follower, as a pure function of the set of realizations.
class LimitTable {
public:
  explicit LimitTable(std::size_t followers = 0) : followers_(followers) {}

  bool empty() const { return followers_.empty(); }
  const std::vector<AtLimits>& followers() const { return followers_; }

  void add(std::size_t follower, const AtLimits& more);
  /// Throws std::invalid_argument for another number of followers.
  void merge(const LimitTable& other);

private:
  std::vector<AtLimits> followers_;
};

}  // namespace platoon
