#pragma once

#include <cstddef>
#include <cstdint>

namespace platoon {

/// One stage of the link into a follower. It changes positions in place, for a batch of realizations, each by
/// the same operations in the same order whatever batch it is in.
class LinkStage {
public:
  virtual ~LinkStage() = default;

  /// Whether step() depends on what came before it: then its steps must come in turn, from start() on.
  virtual bool keeps_state() const = 0;

  /// Step -1 of realizations first_realization .. + count - 1: fills its registers with these positions [m],
  /// which it passes on as they are.
  virtual void start(std::uint64_t first_realization, std::size_t count, const double* positions) = 0;

  /// Step k >= 0 of the same realizations.
  virtual void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) = 0;
};

}  // namespace platoon
