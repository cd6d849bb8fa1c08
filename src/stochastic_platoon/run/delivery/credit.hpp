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
  double stall_timeout;       ///< [s] without progress before a new attempt; 0: never once steps have flowed
  double first_step_timeout;  ///< [s] > 0 the same while nothing of an attempt has been acknowledged
};

/// The leader's side of the delivery contract: which step may be published now, and when to begin again.
///
/// Knows no clock and no topic: the time is an argument [s]. It waits until every receiver has reported;
/// starts an attempt at the earliest realization any of them still needs; allows one step until the first
/// acknowledgement of the attempt and then `window` unacknowledged ones. The next attempt begins when the
/// timeout passes without progress, or as soon as a receiver shows that it has lost what it had. The timeout
/// grows by a factor of 1.5 with each consecutive stall, so that a machine too slow for it still gets through;
/// it is the first one again when a batch is through, or when steps have flowed for as long as the timeout.
/// With a stall_timeout of 0 nothing that has flowed is begun again, whatever was lost: a vehicle of the real
/// world cannot go back.
class Credit {
public:
  Credit(const BatchSchedule& schedule, const CreditLimits& limits, const std::vector<std::string>& receivers);

  /// Takes a report; `messages` are those that the receiver has counted in the attempt: progress, too, as the
  /// first step of a batch alone takes many of them, but not while steps are published that bring messages
  /// of their own whoever else is gone. Unknown receivers are ignored; returns false for them.
  bool acknowledge(const std::string& receiver, const Acknowledgement& report, double now, std::uint64_t messages = 0);

  /// The next message to publish, if credit allows one now; counts it as published.
  std::optional<MessageId> next(double now);

  /// Begins a new attempt if the present one has stalled; true if it did.
  bool retry_if_stalled(double now);

  /// A vehicle has missed messages of this attempt, which cannot come through. Begins a new one at once if it is
  /// the present one and steps have flowed in it: while nodes come up, it is the timeout that tells.
  void give_up(std::uint32_t attempt, double now);

  /// Every receiver has every realization.
  bool complete() const;

  std::uint32_t attempt() const { return attempt_; }

  /// Steps of the attempt that are published and not acknowledged by all.
  std::int64_t unacknowledged() const { return published_ - (attempt_ > 0 ? acknowledged() : 0); }

private:
  struct Receiver {
    std::optional<Acknowledgement> latest;
    bool in_attempt = false;     ///< its latest report is of the present attempt
    std::uint64_t messages = 0;  ///< that it has counted in the attempt
  };
  std::int64_t acknowledged() const;
  bool all_reported() const;
  bool may_publish() const;
  bool may_begin() const;
  void begin_attempt(double now);

  BatchSchedule schedule_;
  CreditLimits limits_;
  std::map<std::string, Receiver> receivers_;
  std::uint32_t attempt_ = 0;   ///< 0: none begun
  std::uint64_t start_ = 0;     ///< first realization of the attempt
  MessageId upcoming_{};        ///< the message to publish next
  std::int64_t published_ = 0;  ///< steps published in this attempt
  bool flowed_ = false;         ///< a step has been acknowledged by all
  double attempt_began_ = 0.0;  ///< [s]
  double last_activity_ = 0.0;  ///< [s]
  double first_step_patience_;  ///< [s] grows while attempts find no answer
  double patience_;             ///< [s] grows while attempts break off before their first batch is through
};

}  // namespace platoon
