#pragma once

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

namespace platoon {

/// Decides when a receiver reports: at once if the leader may be waiting (an attempt or a batch has begun, or the run
/// is complete), otherwise after a quarter of the window. The leader then publishes several steps at a time, and the
/// nodes behind it wake up less often.
class ReportPace {
public:
  ReportPace(const BatchSchedule& schedule, std::int64_t window)
      : schedule_(schedule), stride_(std::max<std::int64_t>(window / 4, 1)) {}

  bool is_due(const Acknowledgement& present) const {
    if (present.attempt != reported_.attempt) return true;
    const std::uint64_t start = reported_.first_realization;
    const std::int64_t steps = steps_covered(schedule_, start, present) - steps_covered(schedule_, start, reported_);
    const bool leader_may_wait = reported_.step == kNothingYet || schedule_.is_complete(present.first_realization);
    return steps >= (leader_may_wait ? 1 : stride_);
  }

  void note_report(const Acknowledgement& present) { reported_ = present; }

private:
  BatchSchedule schedule_;
  std::int64_t stride_;  ///< steps between reports
  Acknowledgement reported_{0, 0, kNothingYet};
};

}  // namespace platoon
