#pragma once

#include <cstddef>
#include <cstdint>

namespace platoon {

/// One stage of the link into a follower. It changes the positions of a batch of realizations in place. A realization
/// undergoes the same operations in the same order in every batch.
class LinkStage {
public:
  virtual ~LinkStage() = default;

  /// Whether step() depends on earlier steps. If so, steps must follow in order after start().
  virtual bool keeps_state() const = 0;

  /// Step -1 of realizations first_realization .. first_realization + count - 1: fills the registers as positions [m]
  /// that have always grown by `slope` per step leave them, and passes what it would have passed of these.
  virtual void start(std::uint64_t first_realization, std::size_t count, double* positions, double slope) = 0;

  /// Whether step() depends on the gap to the predecessor. If so, see_gaps() precedes every step k >= 0.
  virtual bool depends_on_gap() const { return false; }

  /// Receives the gaps of the same realizations at step k - 1 [m], before step k.
  virtual void see_gaps(std::size_t /*count*/, const double* /*gaps*/) {}

  /// Step k >= 0 of the same realizations.
  virtual void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) = 0;
};

}  // namespace platoon
