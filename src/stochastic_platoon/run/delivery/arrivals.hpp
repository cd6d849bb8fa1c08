#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "stochastic_platoon/run/delivery/message_order.hpp"

namespace platoon {

/// A batch that has arrived completely.
struct CompleteBatch {
  std::uint64_t first_realization;
  std::uint64_t positions_received;  ///< of the batch, over all streams: counted, not computed
};

/// The receiver's side of the delivery contract for several related streams of positions: it judges every message,
/// tracks the steps that have arrived from all streams, and commits complete batches in order.
///
/// A message is received in two steps, so that its work can be done in between: admit() judges it, count() counts it
/// once that work is done. Each stream's messages are admitted and counted in order.
///
/// An attempt may begin at the first uncommitted batch, or at an earlier one that another receiver still needs: batches
/// that are already committed are then acknowledged without being counted again.
class Arrivals {
public:
  /// Realizations before `committed` are done. `attempt` is the latest known attempt.
  Arrivals(const BatchSchedule& schedule, std::size_t streams, std::uint64_t committed, std::uint32_t attempt);

  /// Judges a message of a stream. Only a message in turn has an effect: one of a newer attempt than attempt() begins
  /// that attempt and voids all results of unfinished batches. Throws std::out_of_range for a stream beyond the last.
  DropReason admit(std::size_t stream, const MessageDescriptor& descriptor);

  /// Counts an admitted message. Returns the batch that it completes, unless that batch was committed before. Has no
  /// effect if a newer attempt has begun since the message was admitted.
  std::optional<CompleteBatch> count(std::size_t stream, const MessageDescriptor& descriptor);

  /// Marks the realizations before `committed` as done. Only before the first message.
  void resume_at(std::uint64_t committed) { start_ = committed_ = committed; }

  /// The report to the leader.
  Acknowledgement acknowledgement() const;

  /// Id of step number `count` of the present attempt.
  MessageId id_of(std::int64_t count) const;

  /// Messages counted in the present attempt.
  std::uint64_t messages() const { return messages_; }

  bool complete() const { return schedule_.is_complete(committed_); }
  /// First realization that is not committed.
  std::uint64_t committed() const { return committed_; }
  std::uint32_t attempt() const { return attempt_; }

  /// The latest message of one stream, or of each stream, in the present attempt.
  std::optional<MessageId> latest(std::size_t stream) const;
  std::vector<std::optional<MessageId>> latest() const;

  /// The latest message of each stream in any attempt.
  std::vector<std::optional<MessageId>> latest_of_any_attempt() const;

private:
  struct Step {
    std::size_t streams = 0;
    std::uint64_t positions = 0;
  };
  bool may_start_at(std::uint64_t first) const;
  void restart(const MessageId& id);

  BatchSchedule schedule_;
  std::uint32_t attempt_;
  std::uint64_t start_;  ///< first realization of the attempt
  std::uint64_t committed_;
  std::vector<MessageOrder> orders_;
  std::vector<std::int64_t> arrived_;     ///< counted messages of the attempt, per stream
  std::deque<Step> open_;                 ///< steps that have not arrived from every stream
  std::int64_t acknowledged_ = 0;         ///< steps of the attempt that have arrived from every stream
  std::uint64_t messages_ = 0;            ///< counted in the attempt
  std::uint64_t positions_in_batch_ = 0;  ///< of acknowledged steps of the batch in progress
};

}  // namespace platoon
