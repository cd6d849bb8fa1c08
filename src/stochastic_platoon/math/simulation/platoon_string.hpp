#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/link.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/statistics/batch_moments.hpp"

namespace platoon {

/// The whole string in one thread, with the vehicles, links and signals of the nodes, called one after the other.
class PlatoonString {
public:
  /// `signals`: names of the signals beside the tracking errors (see signal_kinds()).
  PlatoonString(const PlatoonModel& model, std::uint64_t seed, std::size_t followers,
                const std::vector<std::string>& signals = {});

  /// A signal of follower i at step k.
  struct SignalValues {
    std::size_t kind;  ///< 0 for zeta_i(k), then the signals in the order of their names
    std::size_t follower;
    std::int64_t step;
    const std::vector<double>* values;  ///< one per realization, valid during the call
  };
  /// Receives up to kCellsAtOnce of them at a time.
  using SignalSink = std::function<void(const std::vector<SignalValues>& group)>;

  /// Runs realizations first .. first + count - 1 through steps -1 .. steps - 1 and passes all signals to `sink` for
  /// every k >= 0.
  void run(std::uint64_t first, std::size_t count, std::int64_t steps, const SignalSink& sink);

private:
  void pass_on(const SignalSink& sink);

  // Steps that a vehicle advances before its follower, so that its state stays in the L1 cache.
  static constexpr std::int64_t kStepsAtOnce = 32;

  LeaderVehicle leader_;
  std::vector<FollowerVehicle> followers_;
  std::vector<Link> links_;
  std::vector<std::optional<Link>> radios_;   ///< one per follower
  std::vector<std::vector<Signal>> signals_;  ///< per follower
  std::size_t before_ = 1;                    ///< steps before the present one that the signals need

  // Reused in every batch: no allocation in steady state.
  std::vector<std::vector<std::vector<double>>> latest_;  ///< y_i at the latest steps, the oldest first, per vehicle
  std::vector<AlignedValues> predecessor_;  ///< y_{i-1}(from - before_), ..., y_{i-1}(from - 1), y_{i-1}(from), ...
  std::vector<AlignedValues> own_;          ///< the same of y_i
  std::vector<std::vector<double>> latest_inputs_;  ///< v_i(k) = u_i(k-1), likewise; empty for vehicles that send none
  std::vector<AlignedValues> predecessor_inputs_, own_inputs_;
  AlignedValues received_, heard_;
  std::array<std::vector<double>, kCellsAtOnce> values_;
  std::vector<SignalValues> group_;  ///< not passed on yet
};

}  // namespace platoon
