#pragma once

#include <cstdint>
#include <optional>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

namespace platoon {

/// Reason why a receiver drops a message; none: the message is taken.
enum class DropReason {
  none,
  stale,         ///< belongs to an older attempt: expected after a restart, no fault
  missed_start,  ///< belongs to an attempt whose step -1 was missed: expected while links come up, no fault
  out_of_turn,   ///< a gap, a duplicate, a batch that is not due, or an attempt beyond kLastAttempt
  wrong_size,    ///< not one position per realization of the batch
  not_finite,    ///< a NaN or an infinity
  foreign_run,   ///< belongs to another run
};
constexpr std::size_t kDropReasons = 7;

/// "in turn" for none, "out of turn", ...
const char* to_string(DropReason drop);

/// The order in which one vehicle's positions must arrive: all steps of a batch from -1 on, then the next batch. A
/// newer attempt starts only with its step -1; messages of an older attempt are stale.
class MessageOrder {
public:
  explicit MessageOrder(const BatchSchedule& schedule) : schedule_(schedule) {}

  /// Judges a message and, if it is in turn, moves on.
  DropReason receive(const MessageDescriptor& descriptor);

  /// Whether a dropped message shows that earlier ones are lost: there is a gap, or the receiver started during the
  /// attempt. In an attempt whose start was missed, only steps from `first_loss` on count: while nodes start, the
  /// leader's first step can bring messages of earlier steps.
  bool has_missed(DropReason drop, const MessageId& id, std::int64_t first_loss) const;

  /// The latest message taken, if any.
  const std::optional<MessageId>& latest() const { return latest_; }

private:
  bool continues(const MessageId& id) const;

  BatchSchedule schedule_;
  std::optional<MessageId> latest_;
};

}  // namespace platoon
