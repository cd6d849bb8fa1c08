#pragma once

#include <cstdint>
#include <vector>

namespace platoon {

/// Speed of the virtual leader from a step on.
struct SpeedChange {
  std::int64_t from_step;  ///< k >= 0
  double value;            ///< [m/s]
};

/// Virtual leader with piecewise constant speed: r_0(k+1) = r_0(k) + T_s speed(k), r_0(k) = 0 for k <= 0. The speed
/// before the first change is 0 (paper, assumption on the leader).
///
/// Throws std::invalid_argument unless the changes have finite speeds and strictly increasing steps >= 0, and
/// T_s > 0.
class LeaderProfile {
public:
  LeaderProfile(const std::vector<SpeedChange>& changes, double sample_period);

  /// r_0(k) [m].
  double position(std::int64_t step) const;

  /// Speed from step k to k + 1 [m/s].
  double speed(std::int64_t step) const;

  const std::vector<SpeedChange>& changes() const { return changes_; }

private:
  std::vector<SpeedChange> changes_;
  std::vector<double> position_at_change_;  ///< [m], one per change
  double sample_period_;                    ///< T_s [s]
};

}  // namespace platoon
