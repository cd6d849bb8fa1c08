#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/delivery/sequence.hpp"
#include "stochastic_platoon/model/tracking_error.hpp"

namespace platoon {

/// The positions of one vehicle at one step, shared with the message they came in.
using Positions = std::shared_ptr<const std::vector<double>>;

/// A batch whose every position has arrived.
struct CompleteBatch {
  std::uint64_t first_realization;
  std::uint64_t positions_received;  ///< counted, not computed
};

/// What an Assembly tells; all of it from within receive().
struct AssemblyEvents {
  /// zeta_i(k) for the batch, k >= 0, one value per realization [m]. For each follower in the order of k.
  std::function<void(std::size_t follower, const Turn& turn, const std::vector<double>& errors)> errors;
  /// All errors of the batch have been told.
  std::function<void(const CompleteBatch&)> batch_complete;
  /// Everything of unfinished batches is void; a new attempt begins.
  std::function<void()> restarted;
};

/// The monitor's side of the delivery contract: puts the positions of all vehicles together, forms the
/// tracking errors and knows what has arrived. Memory is bounded by the leader's window: a position is let go
/// once both errors that need it are formed.
class Assembly {
public:
  /// Starts at realization `first`: those before are committed. `attempt` is the latest attempt known from
  /// before.
  Assembly(const BatchSchedule& schedule, std::size_t followers, const TrackingError& error,
           std::uint64_t first, std::uint32_t attempt, AssemblyEvents events);

  /// Takes the positions of vehicle 0 .. followers. Only those in turn have any effect.
  Verdict receive(std::size_t vehicle, const Turn& turn, const Positions& positions);

  /// What to report to the leader.
  Acknowledgement acknowledgement() const;

  bool complete() const { return schedule_.is_complete(committed_); }

  /// First realization of the batch that is not committed yet.
  std::uint64_t committed() const { return committed_; }

  /// The latest turn of each vehicle in the present attempt.
  std::vector<std::optional<Turn>> latest() const;

private:
  struct Vehicle {
    explicit Vehicle(const BatchSchedule& schedule) : sequence(schedule) {}
    Sequence sequence;
    std::deque<Positions> positions;  ///< of steps first_kept, first_kept + 1, ...
    std::int64_t first_kept = 0;      ///< steps are counted from the attempt's start, through all its batches
    std::int64_t formed = 0;          ///< steps whose error is formed (as a follower)
    std::int64_t end() const { return first_kept + static_cast<std::int64_t>(positions.size()); }
    const std::vector<double>& at(std::int64_t step) const {
      return *positions[static_cast<std::size_t>(step - first_kept)];
    }
  };
  Turn turn_of(std::int64_t count) const;
  void restart(std::uint32_t attempt);
  void form_errors(std::size_t follower);
  void let_go(std::size_t vehicle);
  void count_arrival(std::int64_t step, std::size_t size);

  BatchSchedule schedule_;
  TrackingError error_;
  AssemblyEvents events_;
  std::uint32_t attempt_;
  std::uint64_t start_;      ///< first realization of the attempt
  std::uint64_t committed_;  ///< realizations before this one are done with
  std::vector<Vehicle> vehicles_;
  struct Arrival {
    std::size_t vehicles = 0;
    std::uint64_t positions = 0;
  };
  std::deque<Arrival> arrivals_;          ///< of the steps not yet acknowledged
  std::int64_t acknowledged_ = 0;         ///< steps of the attempt that have arrived from every vehicle
  std::uint64_t positions_in_batch_ = 0;  ///< of acknowledged steps of the batch in progress
  std::vector<double> buffer_;
};

}  // namespace platoon
