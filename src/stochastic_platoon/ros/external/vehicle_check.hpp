#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "stochastic_platoon/ros/external/simulated_predecessor.hpp"

namespace platoon {

/// Tests one vehicle against the vehicle contract, in place of leader, channel and monitor: batches of 1000 and of 1,
/// messages out of turn, newer and older attempts, the same batch again, a whole batch at once, another run, and a run
/// with other standstill distances and headways.
class VehicleCheck : SimulatedPredecessor {
public:
  /// The runs must have so many steps, or more.
  static constexpr std::int64_t kFewestSteps = 20;

  /// Called with each clause as soon as it is known to hold.
  using Holds = std::function<void(Clause)>;

  /// `present` and `next` are two runs of 1001 realizations in batches of 1000, with all vehicles at their nominal
  /// initial positions. `patience`: time limit for an answer [s].
  VehicleCheck(ros::NodeHandle platoon, const Configuration& present, const Configuration& next, std::size_t vehicle,
               double patience);

  using SimulatedPredecessor::missing_links;
  using SimulatedPredecessor::wait_for_vehicle;

  /// The first breach of the contract, or none. Serves the global callback queue while it runs.
  std::optional<BrokenClause> run(const Holds& holds);

private:
  void check_publishers();
  void check_batches();
  void check_turn();
  void check_attempts();
  void check_repetition();
  void check_queues();
  void check_runs();
  void check_spacing();

  Configuration present_, next_;
};

}  // namespace platoon
