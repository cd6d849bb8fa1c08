#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/run/delivery/arrivals.hpp"

namespace platoon {

/// The positions of one vehicle at one step [m], shared with their message.
using Positions = std::shared_ptr<const std::vector<double>>;

/// The positions that form the signals of follower i at step k of a batch: y_{i-1}(k), y_{i-1}(k-1), ..., and y_i(k),
/// y_i(k-1), ..., with position_before() for steps before -1 and none for steps that no signal needs.
struct DueSignals {
  std::size_t follower;  ///< i >= 1
  MessageId id;          ///< k >= 0
  Signal::Recent<Positions> ahead, own;
  Positions input = {};  ///< u_i(k-1); null unless it is measured
};

/// The monitor's side of the delivery contract: combines the positions of all vehicles, finds the signals that can be
/// formed, and tracks the arrived messages. The leader's window bounds the memory: a position is released as soon as
/// all signals that need it have been handed out.
///
/// A message is received in two steps. receive() hands out the signals that are due; they are formed without access to
/// this object; settle() then counts the message. A batch is thus complete only when all of its signals have been
/// processed, by any number of threads.
class SignalAssembly {
public:
  struct Receipt {
    DropReason drop;
    bool restarted = false;            ///< a new attempt begins: all results of unfinished batches are void
    std::vector<DueSignals> due = {};  ///< for each follower in the order of k
  };

  /// Starts at realization `first`; earlier ones are committed. `attempt` is the latest known attempt. `before`: the
  /// signals of step k need the positions of steps k - before to k, 1 <= before <= Signal::kHighestOrder. `slope`:
  /// start_slope() [m]. `measured`: the followers whose inputs are measured, in ascending order.
  SignalAssembly(const BatchSchedule& schedule, std::size_t followers, std::uint64_t first, std::uint32_t attempt,
                 std::int64_t before = 1, double slope = 0.0, std::vector<std::size_t> measured = {});

  /// Takes the positions of vehicle 0 .. followers, or the inputs of a follower as stream input_stream(). Only a
  /// message in turn has an effect. Throws std::out_of_range for a stream beyond the last.
  Receipt receive(std::size_t stream, const MessageDescriptor& descriptor, const Positions& positions);

  /// Counts a message after its due signals have been processed; see Arrivals::count().
  std::optional<CompleteBatch> settle(std::size_t stream, const MessageDescriptor& descriptor) {
    return arrivals_.count(stream, descriptor);
  }

  /// The followers whose inputs are measured; the inputs of the first are stream followers + 1.
  const std::vector<std::size_t>& measured() const { return measured_; }

  /// The messages that have arrived; stream i is vehicle i = 0 .. followers; the inputs follow.
  const Arrivals& arrivals() const { return arrivals_; }

private:
  struct Vehicle {
    std::deque<Positions> positions;  ///< of steps first_kept, first_kept + 1, ... of the attempt
    std::int64_t first_kept = 0;
    std::int64_t handed_out = 0;  ///< steps whose signals as a follower were handed out
    bool is_measured = false;
    std::deque<Positions> inputs = {};  ///< of steps handed_out, handed_out + 1, ... if measured
    std::int64_t end() const { return first_kept + static_cast<std::int64_t>(positions.size()); }
    const Positions& at(std::int64_t step) const { return positions[static_cast<std::size_t>(step - first_kept)]; }
  };
  std::vector<Vehicle> vehicles_anew() const;
  void find_due(std::size_t follower, std::vector<DueSignals>& due);
  void let_go(std::size_t vehicle);

  std::size_t followers_;
  std::vector<std::size_t> measured_;
  std::vector<Vehicle> vehicles_;
  Arrivals arrivals_;
  std::int64_t before_;
  double slope_;
};

}  // namespace platoon
