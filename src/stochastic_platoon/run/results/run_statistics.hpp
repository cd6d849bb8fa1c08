#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/tracking_error.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/statistics/error_averages.hpp"
#include "stochastic_platoon/run/delivery/error_assembly.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// Statistics of a run from the positions of its vehicles, whether they come from topics or from a bag: an
/// ErrorAssembly joined to the run's ErrorAverages.
///
/// A message passes in three steps:
///     receive()  judges it and returns the work that is due with it,
///     compute()  does that work: it is pure, and the only part that takes long,
///     settle()   counts the result, and commits the batch that is whole with it.
/// Several threads may do so, each for vehicles of its own: under one lock for receive() and settle(), and
/// without any for compute().
class RunStatistics {
public:
  /// The work that a message causes.
  struct Work {
    std::size_t vehicle;
    MessageDescriptor descriptor;
    std::vector<DueErrors> due;
  };
  struct Receipt {
    DropReason drop;
    Work work;  ///< of a message that is in turn: to be computed and settled
  };
  struct Computed {
    std::size_t vehicle;
    MessageDescriptor descriptor;
    std::vector<ReducedErrors> errors;
  };

  /// Starts from the checkpoint if there is one, else with nothing committed.
  RunStatistics(const Configuration& configuration, const std::optional<Checkpoint>& start);

  /// The same with realizations before `first_realization` taken as done with, though nothing is known of
  /// them.
  RunStatistics(const Configuration& configuration, std::uint64_t first_realization);

  /// The positions of vehicle 0 .. N. What is not in turn has no effect.
  Receipt receive(std::size_t vehicle, const MessageDescriptor& descriptor, const Positions& positions);

  Computed compute(const Work& work) const;

  /// Whether a batch became whole with it.
  bool settle(const Computed& computed);

  /// All three at once; whether the message was dropped.
  DropReason take(std::size_t vehicle, const MessageDescriptor& descriptor, const Positions& positions);

  const Arrivals& arrivals() const { return assembly_.arrivals(); }
  const ErrorAverages& averages() const { return *averages_; }

  /// Of an endless run: whether the leader's latest step is not by the model, as it manoeuvres.
  bool leader_departs() const { return leader_departs_; }

  /// The latest platoon time seen [ns].
  void saw(std::uint64_t platoon_time);

  /// Wall time from the first position to the latest commit, over all launches [s].
  void set_wall_seconds(double seconds) { tally_.wall_seconds = seconds; }

  const Tally& tally() const { return tally_; }
  RunResult result(bool complete) const;

  /// What another run can go on from.
  Checkpoint checkpoint() const;

private:
  RunStatistics(const Configuration& configuration, std::uint64_t first_realization, const Tally& start,
                const EarlierAverages& earlier);
  ReducedErrors reduced(const DueErrors& due) const;
  void compare_leader(std::int64_t step, double position);

  Configuration configuration_;
  std::vector<TrackingError> error_;  ///< of every follower
  KeptMoments kept_;
  Tally tally_;
  std::unique_ptr<ErrorAverages> averages_;
  ErrorAssembly assembly_;

  /// Vehicle 0 as the model has it, beside the one that drives: of an endless run, where it may be told otherwise.
  struct ModelLeader {
    LeaderVehicle vehicle;
    double ahead;  ///< of it the one that drives [m]
  };
  std::optional<ModelLeader> leader_;
  bool leader_departs_ = false;
};

}  // namespace platoon
