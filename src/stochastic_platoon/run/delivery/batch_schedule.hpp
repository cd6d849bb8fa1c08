#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace platoon {

/// Division of a run's realizations into batches, and the steps of each batch.
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

/// Identifies a vehicle's message within a run.
struct MessageId {
  std::uint32_t attempt;
  std::uint64_t first_realization;
  std::int64_t step;
};

/// Index of the noise realization of a message's first position. In an endless batch each attempt uses a new one: the
/// averages continue across attempts, and repeated noise would be counted twice.
inline std::uint64_t first_noise_realization(const BatchSchedule& schedule, const MessageId& id) {
  if (!schedule.endless()) return id.first_realization;
  return id.attempt > 0 ? id.attempt - 1 : 0;
}

/// The properties of a position message that delivery depends on.
struct MessageDescriptor {
  MessageId id;
  std::size_t size;  ///< positions, one per realization
  bool finite;       ///< all positions are finite
};

/// A receiver's report: all messages of this attempt up to this one have arrived, and every earlier batch is committed.
/// step = kNothingYet: no message of this batch has arrived.
using Acknowledgement = MessageId;
constexpr std::int64_t kInitialStep = -1;
constexpr std::int64_t kNothingYet = -2;

/// The largest valid attempt; receivers drop messages of a larger one. The leader starts a few attempts per second at
/// most, counting on from the largest reported one: a report of this very attempt would leave it none. Hence far below
/// the largest numbers of 31 and 32 bits, which a faulty vehicle may send.
constexpr std::uint32_t kLastAttempt = std::uint32_t{1} << 30;

/// Whether a run with this schedule has the reported step.
inline bool may_be_reported(const BatchSchedule& schedule, const Acknowledgement& report) {
  constexpr std::int64_t kMost = std::int64_t{1} << 46;  // for an endless run: the limit of the noise counter
  return report.attempt <= kLastAttempt && report.first_realization <= schedule.realizations &&
         report.step >= kNothingYet && report.step < (schedule.endless() ? kMost : schedule.steps);
}

/// Number of steps that a report covers in an attempt that began at realization `start`; 0 for an earlier report. All
/// batches but the last have equal size, so whole batches can be counted.
inline std::int64_t steps_covered(const BatchSchedule& schedule, std::uint64_t start, const Acknowledgement& report) {
  if (report.first_realization < start) return 0;
  const auto batches =
      static_cast<std::int64_t>((report.first_realization - start + schedule.batch - 1) / schedule.batch);
  return batches * (schedule.steps + 1) + (report.step - kNothingYet);
}

}  // namespace platoon
