#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

namespace platoon {

struct CreditLimits {
  std::int64_t window;        ///< steps that may be unacknowledged, >= 1
  double stall_timeout;       ///< [s] without progress before a new attempt; 0: no new attempt once steps have flowed
  double first_step_timeout;  ///< [s] > 0, the same until a step of the attempt is acknowledged
};

/// The leader's side of the delivery contract: decides which step may be published now, and when a new attempt begins.
///
/// Uses no clock and no topic: the time is an argument [s]. Credit waits until every receiver has reported and starts
/// an attempt at the earliest realization that any of them still needs. It allows one step until the first
/// acknowledgement of the attempt, then `window` unacknowledged steps. The next attempt begins when the timeout passes
/// without progress, or as soon as a receiver's report shows that it has lost its state. The timeout grows by a factor
/// of 1.5 with each consecutive stall, so that a slow machine still makes progress; it is reset when a batch completes,
/// or when steps have flowed for as long as the timeout, but stays above the waits between the steps that have flowed.
/// With a stall_timeout of 0 no attempt is repeated once steps have flowed, even if messages are lost: a real vehicle
/// cannot go back.
class Credit {
public:
  Credit(const BatchSchedule& schedule, const CreditLimits& limits, const std::vector<std::string>& receivers);

  /// Takes a report. Returns false and ignores it if the receiver is unknown.
  ///
  /// `messages`: number of messages that the receiver has counted in the attempt. A larger number is progress as well,
  /// as the first step of a batch alone brings many messages, but only while no further step may be published: each
  /// published step brings messages even if another node is gone.
  bool acknowledge(const std::string& receiver, const Acknowledgement& report, double now, std::uint64_t messages = 0);

  /// The next message to publish, if credit allows one now; counts it as published.
  std::optional<MessageId> next(double now);

  /// Begins a new attempt if the present one has stalled; true if it did.
  bool retry_if_stalled(double now);

  /// Whether a vehicle that has lost messages of `attempt` may have it repeated now: the attempt is the present one,
  /// steps have flowed in it (while nodes start, the timeout decides), and the pause since the latest repetition of
  /// this kind has passed: 0.1 s, and 1.5 times longer with each one until a batch completes, in an endless run until
  /// ten pauses have passed. A flood of notices thus delays a batch but cannot prevent it.
  bool may_give_up(std::uint32_t attempt, double now) const;

  /// Begins a new attempt at once if may_give_up(); true if it did.
  bool give_up(std::uint32_t attempt, double now);

  /// True if every receiver has every realization.
  bool complete() const;

  std::uint32_t attempt() const { return attempt_; }

  /// Steps of the attempt that are published but not acknowledged by all receivers.
  std::int64_t unacknowledged() const { return published_ - (attempt_ > 0 ? acknowledged() : 0); }

private:
  struct Receiver {
    std::optional<Acknowledgement> latest;
    bool in_attempt = false;     ///< its latest report belongs to the present attempt
    std::uint64_t messages = 0;  ///< counted by the receiver in the attempt
  };
  std::int64_t acknowledged() const;
  bool all_reported() const;
  bool may_publish() const;
  bool may_begin() const;
  void begin_attempt(double now);
  void progressed(double now);

  BatchSchedule schedule_;
  CreditLimits limits_;
  std::map<std::string, Receiver> receivers_;
  std::uint32_t attempt_ = 0;   ///< 0: no attempt yet
  std::uint64_t start_ = 0;     ///< first realization of the attempt
  MessageId upcoming_{};        ///< the message to publish next
  std::int64_t published_ = 0;  ///< steps published in this attempt
  bool flowed_ = false;         ///< all receivers have acknowledged a step
  double flows_since_ = 0.0;    ///< [s] first acknowledgement of the attempt
  double longest_wait_ = 0.0;   ///< [s] for progress since then
  double last_activity_ = 0.0;  ///< [s]
  double first_step_patience_;  ///< [s] grows while attempts get no acknowledgement
  double patience_;             ///< [s] grows while attempts stall before their first batch completes
  double next_notice_ = 0.0;    ///< [s] earliest time of the next repetition by give_up()
  double notice_pause_;         ///< [s] grows with these repetitions as patience_ does
};

}  // namespace platoon
