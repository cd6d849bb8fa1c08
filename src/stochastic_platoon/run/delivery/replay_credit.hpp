#pragma once

#include <cstdint>
#include <deque>

#include "stochastic_platoon/run/delivery/credit.hpp"

namespace platoon {

/// A replay's side of the delivery contract towards one live vehicle: decides which recorded message may be sent now,
/// and when a new attempt begins. Uses no clock and no topic: the time is an argument [s].
///
/// Recorded messages are numbered from 0. As Credit does for the leader, ReplayCredit allows one message until the
/// first answer of an attempt, then `window` unanswered ones. If the answer times out, a new attempt begins with the
/// batch of the first unanswered message. The timeouts grow by a factor of 1.5 with each consecutive attempt; an answer
/// beyond those of all earlier attempts resets them. With a stall_timeout of 0 no attempt is repeated after the first
/// answer.
class ReplayCredit {
public:
  explicit ReplayCredit(const CreditLimits& limits);

  bool may_send() const;

  /// Counts the next message as sent.
  void send(bool begins_batch, double now);

  /// Counts the next answer.
  void answer(bool begins_batch, double now);

  /// Begins a new attempt if the present one has stalled; true if it did.
  bool retry_if_stalled(double now);

  /// Begins a new attempt at once because an answer was lost, provided that the present attempt has got further than
  /// all before it. Otherwise, as with a vehicle that fails at the same message every time, the timeout decides. True
  /// if a new attempt began.
  bool give_up(double now);

  /// Number of the next message to send.
  std::int64_t upcoming() const { return sent_; }

  /// Number of abandoned attempts.
  std::uint32_t repetitions() const { return repetitions_; }

  /// [s] Time of the latest answer beyond all earlier ones, at first of the first message.
  double last_progress() const { return last_progress_; }

private:
  bool may_begin() const { return limits_.stall_timeout > 0.0 || !flowed_; }
  void begin_again(double now);

  CreditLimits limits_;
  std::deque<std::int64_t> starts_;  ///< first messages of the batches in progress
  std::int64_t sent_ = 0;            ///< messages
  std::int64_t answered_ = 0;        ///< messages; at most sent_, or sent_ + 1 for a vehicle that publishes ahead
  std::int64_t most_answered_ = 0;   ///< in any attempt
  std::int64_t answered_in_attempt_ = 0;
  std::uint32_t repetitions_ = 0;
  bool progressed_ = false;     ///< in this attempt
  bool flowed_ = false;         ///< an answer has arrived
  double last_activity_ = 0.0;  ///< [s]
  double last_progress_ = 0.0;  ///< [s]
  double first_step_patience_;  ///< [s]
  double patience_;             ///< [s]
};

}  // namespace platoon
