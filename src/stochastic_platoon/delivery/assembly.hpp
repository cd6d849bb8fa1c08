#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <vector>

#include "stochastic_platoon/delivery/arrivals.hpp"
#include "stochastic_platoon/model/tracking_error.hpp"

namespace platoon {

/// The positions of one vehicle at one step, shared with the message they came in.
using Positions = std::shared_ptr<const std::vector<double>>;

/// Does the work of forming errors.
using Arithmetic = std::function<void(const std::function<void()>& work)>;
inline void do_at_once(const std::function<void()>& work) {
  work();
}

/// What an Assembly tells; all of it from within receive().
struct AssemblyEvents {
  /// zeta_i(k) for the batch, k >= 0, one value per realization [m]. For each follower in the order of k.
  std::function<void(std::size_t follower, const Turn& turn, const std::vector<double>& errors)> errors;
  /// All errors of the batch have been told.
  std::function<void(const CompleteBatch&)> batch_complete;
  /// Everything of unfinished batches is void; a new attempt begins.
  std::function<void()> restarted;
  /// Who receives from several threads under one lock can let go of it for this work, the only part that
  /// takes long. The errors of a follower may then come in any order, but none of a void batch comes after
  /// restarted(), and all of a batch before batch_complete().
  Arithmetic arithmetic = do_at_once;
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

  /// What has arrived of the vehicles 0 .. followers, as streams of these numbers.
  const Arrivals& arrivals() const { return arrivals_; }

private:
  struct Vehicle {
    std::deque<Positions>
        positions;  ///< of steps first_kept, first_kept + 1, ... counted through the attempt
    std::int64_t first_kept = 0;
    std::int64_t formed = 0;  ///< steps whose error is formed (as a follower)
    std::int64_t end() const { return first_kept + static_cast<std::int64_t>(positions.size()); }
    const Positions& at(std::int64_t step) const {
      return positions[static_cast<std::size_t>(step - first_kept)];
    }
  };
  /// What the errors of a follower at a step are formed of.
  struct Due {
    std::size_t follower;
    Turn turn;
    Positions predecessor, own, own_before;
  };
  void take(std::size_t vehicle, const Positions& positions);
  void find_due(std::size_t follower, std::vector<Due>& due);
  void form_errors(const std::vector<Due>& due);
  void restart();
  void let_go(std::size_t vehicle);

  TrackingError error_;
  AssemblyEvents events_;
  std::vector<Vehicle> vehicles_;
  std::shared_mutex forming_;  ///< shared while errors are formed
  std::uint32_t attempt_ = 0;  ///< of which errors may be told, guarded by forming_
  Arrivals arrivals_;
};

}  // namespace platoon
