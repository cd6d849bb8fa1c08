#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace platoon {

/// How the realizations of a run are cut into batches, and the steps of each.
struct BatchSchedule {
  std::uint64_t realizations;
  std::uint64_t batch;  ///< realizations per message; the last batch may be smaller
  std::int64_t steps;   ///< steps -1 .. steps - 1 per batch; 0 = one endless batch

  bool endless() const { return steps == 0; }
  bool is_last_step(std::int64_t step) const { return !endless() && step + 1 == steps; }
  bool is_complete(std::uint64_t first) const { return first >= realizations; }
  std::size_t size(std::uint64_t first) const {
    return first < realizations ? static_cast<std::size_t>(std::min(batch, realizations - first)) : 0;
  }
  std::uint64_t next(std::uint64_t first) const { return first + size(first); }
};

/// What names a vehicle's message within a run: which attempt, which batch, which step.
struct MessageId {
  std::uint32_t attempt;
  std::uint64_t first_realization;
  std::int64_t step;
};

/// The realization of the noise that a message's first position is of. An endless batch that is begun again is
/// another one: its averages go on, and noise that is repeated would be counted twice.
inline std::uint64_t first_noise_realization(const BatchSchedule& schedule, const MessageId& id) {
  if (!schedule.endless()) return id.first_realization;
  return id.attempt > 0 ? id.attempt - 1 : 0;
}

/// What delivery needs to know of a message of positions.
struct MessageDescriptor {
  MessageId id;
  std::size_t size;  ///< positions, one per realization
  bool finite;       ///< all of them
};

/// A receiver's report: all messages of this attempt up to this one have arrived, and every earlier batch is
/// committed. step = kNothingYet: nothing of this batch so far.
using Acknowledgement = MessageId;
constexpr std::int64_t kInitialStep = -1;
constexpr std::int64_t kNothingYet = -2;

/// Attempts beyond are nobody's: the leader begins some a second at most, and counts on from what is reported.
constexpr std::uint32_t kLastAttempt = std::uint32_t{1} << 31;

/// Whether there is such a step to report in a run of this schedule.
inline bool may_be_reported(const BatchSchedule& schedule, const Acknowledgement& report) {
  constexpr std::int64_t kMost = std::int64_t{1} << 46;  // of an endless run: what the noise can name
  return report.attempt <= kLastAttempt && report.first_realization <= schedule.realizations &&
         report.step >= kNothingYet && report.step < (schedule.endless() ? kMost : schedule.steps);
}

/// Steps that a report covers of an attempt that began at realization `start`; 0 for an earlier one. All
/// batches but the last have equal size, so whole ones can be counted.
inline std::int64_t steps_covered(const BatchSchedule& schedule, std::uint64_t start, const Acknowledgement& report) {
  if (report.first_realization < start) return 0;
  const auto batches =
      static_cast<std::int64_t>((report.first_realization - start + schedule.batch - 1) / schedule.batch);
  return batches * (schedule.steps + 1) + (report.step - kNothingYet);
}

}  // namespace platoon
