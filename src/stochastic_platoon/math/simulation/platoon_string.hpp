#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"

namespace platoon {

/// The whole string in one thread, with the vehicles, links and signals of the nodes, called one after the other.
class PlatoonString {
public:
  /// `before`: number of earlier own positions in every call of the sink, from 1 to Signal::kHighestOrder. `signals`:
  /// names, for which inputs are measured.
  PlatoonString(const PlatoonModel& model, const WhiteNoise& noise, std::size_t followers, std::size_t before = 1,
                const std::vector<std::string>& signals = {});

  /// Receives the positions of follower i and its predecessor at step k, from which its signals follow.
  using PositionSink = std::function<void(std::size_t follower, std::int64_t step, const SignalPositions& positions)>;

  /// Runs realizations first .. first + count - 1 through steps -1 .. steps - 1 and calls `sink` for every follower and
  /// every k >= 0.
  void run(std::uint64_t first, std::size_t count, std::int64_t steps, const PositionSink& sink);

private:
  // Steps that a vehicle advances before its follower, so that its state stays in the L1 cache.
  static constexpr std::int64_t kStepsAtOnce = 16;

  LeaderVehicle leader_;
  double slope_;  ///< start_slope() [m]
  std::vector<FollowerVehicle> followers_;
  std::vector<Link> links_;
  std::vector<std::optional<Link>> radios_;  ///< one per follower
  std::vector<bool> measured_;               ///< whether the input of a vehicle is measured
  std::size_t before_;

  // Reused in every batch: no allocation in steady state.
  std::vector<std::vector<AlignedValues>> latest_;  ///< y_i at the latest steps, the oldest first, per vehicle
  std::vector<AlignedValues> predecessor_;  ///< y_{i-1}(from - before_), ..., y_{i-1}(from - 1), y_{i-1}(from), ...
  std::vector<AlignedValues> own_;          ///< the same of y_i
  std::vector<std::vector<double>> latest_inputs_;  ///< v_i(k) = u_i(k-1), likewise; empty for others
  std::vector<AlignedValues> predecessor_inputs_, own_inputs_;
  AlignedValues received_, heard_;
};

}  // namespace platoon
