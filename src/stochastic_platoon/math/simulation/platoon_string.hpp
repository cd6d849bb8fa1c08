#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/link.hpp"
#include "stochastic_platoon/math/model/tracking_error.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"

namespace platoon {

/// The whole string in one thread, with the vehicles, links and errors of the nodes, called one after the other.
class PlatoonString {
public:
  PlatoonString(const PlatoonModel& model, std::uint64_t seed, std::size_t followers);

  using ErrorSink = std::function<void(std::size_t follower, std::int64_t step, const std::vector<double>& errors)>;

  /// Runs realizations first .. first + count - 1 through steps -1 .. steps - 1 and passes zeta_i(k) to `sink` for
  /// every k >= 0.
  void run(std::uint64_t first, std::size_t count, std::int64_t steps, const ErrorSink& sink);

private:
  // Steps that a vehicle advances before its follower, so that its state stays in the L1 cache.
  static constexpr std::int64_t kStepsAtOnce = 32;

  LeaderVehicle leader_;
  std::vector<FollowerVehicle> followers_;
  std::vector<Link> links_;
  std::vector<std::optional<Link>> radios_;  ///< one per follower
  std::vector<TrackingError> error_;

  // Reused in every batch: no allocation in steady state.
  std::vector<std::vector<double>> latest_;         ///< y_i at the latest step, per vehicle
  std::vector<AlignedValues> predecessor_;          ///< y_{i-1}(from - 1), y_{i-1}(from), ...
  std::vector<AlignedValues> own_;                  ///< y_i(from - 1), y_i(from), ...
  std::vector<std::vector<double>> latest_inputs_;  ///< v_i(k) = u_i(k-1), likewise; empty for vehicles that send none
  std::vector<AlignedValues> predecessor_inputs_, own_inputs_;
  AlignedValues received_, heard_;
  std::vector<double> errors_;
};

}  // namespace platoon
