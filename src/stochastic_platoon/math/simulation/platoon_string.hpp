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

  /// An input of a follower.
  struct Wire {
    std::size_t source;
    InputSignal signal;
    Link link;
    std::optional<Signal> difference;  ///< what it carries, formed from positions
  };

  struct Follower {
    FollowerVehicle vehicle;
    std::vector<Wire> wires;
  };

  /// What a vehicle does in some steps from `from` on.
  struct Motion {
    std::vector<AlignedValues> positions;  ///< y(from - before_), ..., y(from - 1), y(from), ...
    std::vector<AlignedValues> inputs;     ///< v(k) = u(k-1) from step from - 1 on, of a vehicle whose input is needed
  };

  void start(std::uint64_t first, std::size_t count);
  void begin(std::size_t i);
  void keep(std::size_t i, std::size_t steps);
  void move_leader(std::size_t steps, std::size_t count);
  void move(std::size_t i, std::int64_t from, std::size_t steps, std::uint64_t first, std::size_t count,
            const PositionSink& sink);
  Motion& motion(std::size_t i) { return i == 0 ? leader_motion_ : motions_[i % motions_.size()]; }

  LeaderVehicle leader_;
  double slope_;  ///< start_slope() [m]
  std::vector<Follower> followers_;
  std::vector<bool> measured_, needs_input_;  ///< whether the input of a vehicle is measured, or also sent
  std::size_t before_;

  // Reused in every batch: no allocation in steady state.
  std::vector<std::vector<AlignedValues>> latest_;  ///< y_i at the latest steps, the oldest first, per vehicle
  std::vector<std::vector<double>> latest_inputs_;  ///< v_i(k) = u_i(k-1), likewise; empty for others
  Motion leader_motion_;
  std::vector<Motion> motions_;  ///< of the vehicles that the present one hears, in turn, and its own
  AlignedValues sent_;
  std::vector<AlignedValues> received_;
  FollowerVehicle::Received received_at_;
};

}  // namespace platoon
