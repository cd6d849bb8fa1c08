#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/statistics/error_averages.hpp"
#include "stochastic_platoon/run/delivery/signal_assembly.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// Statistics of a run from the positions of its vehicles, from topics or from a bag: a SignalAssembly connected to the
/// run's ErrorAverages.
///
/// A message passes three steps:
///
///     receive()  judges it and returns the signals that are due,
///     compute()  forms and reduces them: it is pure, and the only part that takes long,
///     settle()   counts the result, and commits the batch that it completes.
///
/// Several threads may do so, each for its own vehicles: receive() and settle() under one lock, compute() without a
/// lock.
class RunStatistics {
public:
  /// Starts from the checkpoint if there is one, else with nothing committed.
  RunStatistics(const Configuration& configuration, const std::optional<Checkpoint>& start);

  /// The same, but treats realizations before `first_realization` as done, without their statistics.
  RunStatistics(const Configuration& configuration, std::uint64_t first_realization);

  /// The followers whose inputs are measured.
  const std::vector<std::size_t>& measured() const { return assembly_.measured(); }

  /// Takes the positions of vehicle 0 .. N or, from N + 1 on, the inputs of the measured() followers. A message that is
  /// not in turn has no effect: only one in turn is to be computed and settled.
  SignalAssembly::Receipt receive(std::size_t vehicle, const MessageDescriptor& descriptor, const Positions& positions);

  std::vector<ReducedSignals> compute(const std::vector<DueSignals>& due) const;

  /// Counts a message and its computed signals. Returns true if it completes a batch.
  bool settle(std::size_t vehicle, const MessageDescriptor& descriptor, const std::vector<ReducedSignals>& signals);

  /// All three steps at once. Returns why the message was dropped, if it was.
  DropReason take(std::size_t vehicle, const MessageDescriptor& descriptor, const Positions& positions);

  const Arrivals& arrivals() const { return assembly_.arrivals(); }
  const ErrorAverages& averages() const { return *averages_; }

  /// In an endless run: whether one of the leader's latest two steps deviates from the model, as in a manoeuvre; one
  /// that swings has single steps as in the model.
  bool leader_departs() const { return leader_departs_; }

  /// Notes a platoon time [ns]; the latest counts.
  void saw(std::uint64_t platoon_time);

  /// Wall time from the first position to the latest commit, over all launches [s].
  void set_wall_seconds(double seconds) { tally_.wall_seconds = seconds; }

  const Tally& tally() const { return tally_; }
  RunResult result(bool complete) const;

  /// The state from which another run can continue.
  Checkpoint checkpoint() const;

private:
  RunStatistics(const Configuration& configuration, const Checkpoint* start, std::uint64_t first_realization);
  ReducedSignals reduced(const DueSignals& due) const;
  void compare_leader(std::int64_t step, double position);

  Configuration configuration_;
  SignalCells cells_;
  std::vector<FollowerSignals> signals_;  ///< per follower
  Tally tally_;
  std::unique_ptr<ErrorAverages> averages_;
  SignalAssembly assembly_;

  /// Vehicle 0 of the model, for comparison with the actual leader, which may manoeuvre in an endless run.
  struct ModelLeader {
    LeaderVehicle vehicle;
    double ahead;   ///< [m] position of the actual leader minus that of the model
    bool departed;  ///< in its latest step
  };
  std::optional<ModelLeader> leader_;
  bool leader_departs_ = false;
};

}  // namespace platoon
