#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/run/delivery/arrivals.hpp"

namespace platoon {

/// The positions of one vehicle at one step, shared with the message they came in [m].
using Positions = std::shared_ptr<const std::vector<double>>;

/// All that zeta_i(k) of a batch is formed of: y_{i-1}(k), y_i(k), y_i(k-1).
struct DueErrors {
  std::size_t follower;  ///< i >= 1
  MessageId id;          ///< k >= 0
  Positions predecessor, own, own_before;
};

/// The monitor's side of the delivery contract: puts the positions of all vehicles together, finds out which
/// tracking errors can be formed, and knows what has arrived. Memory is bounded by the leader's window: a
/// position is let go of once both errors that need it were handed out.
///
/// A message is received in two steps. receive() hands out the errors that are due with it; whoever forms
/// them needs nothing of this object meanwhile; settle() then lets the message count. So a batch is complete
/// only when all of its errors have been dealt with, by however many threads.
class ErrorAssembly {
public:
  struct Receipt {
    DropReason drop;
    bool restarted = false;      ///< a new attempt begins: everything of unfinished batches is void
    std::vector<DueErrors> due;  ///< for each follower in the order of k
  };

  /// Starts at realization `first`: those before are committed. `attempt` is the latest attempt known from
  /// before.
  ErrorAssembly(const BatchSchedule& schedule, std::size_t followers, std::uint64_t first, std::uint32_t attempt);

  /// Takes the positions of vehicle 0 .. followers. Only those in turn have any effect. Throws
  /// std::out_of_range for a vehicle beyond the last.
  Receipt receive(std::size_t vehicle, const MessageDescriptor& descriptor, const Positions& positions);

  /// Counts a message whose due errors are dealt with; see Arrivals::count().
  std::optional<CompleteBatch> settle(std::size_t vehicle, const MessageDescriptor& descriptor) {
    return arrivals_.count(vehicle, descriptor);
  }

  /// What has arrived of the vehicles 0 .. followers, as streams of these numbers.
  const Arrivals& arrivals() const { return arrivals_; }

private:
  struct Vehicle {
    std::deque<Positions> positions;  ///< of steps first_kept, first_kept + 1, ... of the attempt
    std::int64_t first_kept = 0;
    std::int64_t handed_out = 0;  ///< steps whose error, as a follower, was handed out
    std::int64_t end() const { return first_kept + static_cast<std::int64_t>(positions.size()); }
    const Positions& at(std::int64_t step) const { return positions[static_cast<std::size_t>(step - first_kept)]; }
  };
  void find_due(std::size_t follower, std::vector<DueErrors>& due);
  void let_go(std::size_t vehicle);

  std::vector<Vehicle> vehicles_;
  Arrivals arrivals_;
};

}  // namespace platoon
