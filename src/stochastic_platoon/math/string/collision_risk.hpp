#pragma once

#include <optional>
#include <vector>

#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "stochastic_platoon/math/string/stationary_signals.hpp"

namespace platoon {

/// Probabilities of a collision, g < 0 for the gap g of a follower; one value per follower, and the limits in an
/// endless string if they exist. The limit in a mixed string is the largest over the places of the pattern.
struct CollisionRisk {
  std::vector<double> probability;        ///< P(g < 0) per step, stationary
  std::vector<double> rate;               ///< new collisions per step, stationary: P(g(k-1) >= 0, g(k) < 0)
  std::vector<double> bound;              ///< see collision_bounds()
  std::vector<double> required_distance;  ///< [m] standstill distance at which P(g < 0) has a given value, at least 0
  /// [m] distance of all followers at which P(g < 0 of any follower) is at most the given value: each one has its N-th
  /// part
  double platoon_required_distance;
  std::optional<double> limit_probability, limit_rate, limit_required_distance;
};

/// Upper bound per follower, at most 1, of the probability of a collision in the run, given the moments of its gaps at
/// steps 0, ..., steps - 1:
/// \f[ P(\min_k g(k) < 0) \le P(g(0) < 0) + \sum_{k \ge 1} P(g(k-1) \ge 0, g(k) < 0). \f]
std::vector<double> collision_bounds(const SignalMoments& gaps, std::size_t steps);

/// Collisions of a platoon, given the moments of its gaps. Throws std::invalid_argument unless
/// has_normal_errors(model).
///
/// `table`: as for collision_bounds(). `probability`: in (0, 1/2), of a negative gap at the required distance. NaN
/// where the gap has no stationary moments.
CollisionRisk collision_risk(const PlatoonModel& model, const StationarySignal& gap, const SignalMoments& table,
                             std::size_t steps, double probability);

}  // namespace platoon
