#pragma once

#include <cstdint>
#include <deque>

#include "stochastic_platoon/run/delivery/credit.hpp"

namespace platoon {

/// A replay's side of the delivery contract towards one live vehicle: which recorded message may be sent now, and
/// when to begin again. Knows no clock and no topic: the time is an argument [s].
///
/// Recorded messages are numbered from 0. As Credit does for the leader, it allows one message until the first answer
/// of an attempt, and then `window` unanswered ones. An attempt that is not answered in time is followed by another
/// one, which begins with the batch of the first unanswered message. The timeouts grow by a factor of 1.5 with each
/// attempt in a row; an answer that no attempt before has got brings the first ones back. With a stall_timeout of 0
/// nothing is begun again once an answer came.
class ReplayCredit {
public:
  explicit ReplayCredit(const CreditLimits& limits);

  bool may_send() const;

  /// The next message is sent.
  void send(bool begins_batch, double now);

  /// The next answer has come.
  void answer(bool begins_batch, double now);

  /// Begins a new attempt if the present one has stalled; true if it did.
  bool retry_if_stalled(double now);

  /// An answer of the present attempt is lost. Begins a new one at once if this one has reached further than all before
  /// it; else the timeout decides, as for a vehicle that fails at the same message every time. True if it did.
  bool give_up(double now);

  /// Number of the message to send next.
  std::int64_t upcoming() const { return sent_; }

  /// Attempts that were given up.
  std::uint32_t repetitions() const { return repetitions_; }

  /// [s] When the latest answer came that none before it had reached; from the first message on.
  double last_progress() const { return last_progress_; }

private:
  bool may_begin() const { return limits_.stall_timeout > 0.0 || !flowed_; }
  void begin_again(double now);

  CreditLimits limits_;
  std::deque<std::int64_t> starts_;  ///< first messages of the batches that are under way
  std::int64_t sent_ = 0;            ///< messages
  std::int64_t answered_ = 0;        ///< of them; one more of a vehicle that publishes ahead
  std::int64_t most_answered_ = 0;   ///< in any attempt
  std::int64_t answered_in_attempt_ = 0;
  std::uint32_t repetitions_ = 0;
  bool progressed_ = false;     ///< in this attempt
  bool flowed_ = false;         ///< an answer has come
  double last_activity_ = 0.0;  ///< [s]
  double last_progress_ = 0.0;  ///< [s]
  double first_step_patience_;  ///< [s]
  double patience_;             ///< [s]
};

}  // namespace platoon
