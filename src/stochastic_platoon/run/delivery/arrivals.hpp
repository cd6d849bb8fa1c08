#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "stochastic_platoon/run/delivery/message_order.hpp"

namespace platoon {

/// A batch whose every message has arrived.
struct CompleteBatch {
  std::uint64_t first_realization;
  std::uint64_t positions_received;  ///< of the batch, over all streams: counted, not computed
};

/// A receiver's side of the delivery contract over several streams of positions that belong together: judges
/// every message, knows up to where all streams have arrived, and commits whole batches in order.
///
/// A message is received in two steps, so that the work it causes can be done in between: admit() judges it,
/// count() lets it count once that work is done. Each stream's messages are admitted and counted in order.
///
/// An attempt may begin at the first batch that is not committed, or at an earlier one that another receiver
/// still needs: then what is committed already passes by and is acknowledged, without counting again.
class Arrivals {
public:
  struct Admission {
    DropReason drop;
    bool restarted = false;  ///< a new attempt begins with it: everything of unfinished batches is void
  };

  /// Realizations before `committed` are done with. `attempt` is the latest attempt known from before.
  Arrivals(const BatchSchedule& schedule, std::size_t streams, std::uint64_t committed, std::uint32_t attempt);

  /// Judges a message of a stream. Only those in turn have any effect. Throws std::out_of_range for a stream
  /// beyond the last.
  Admission admit(std::size_t stream, const MessageDescriptor& descriptor);

  /// Counts an admitted message, and returns the batch that became whole with it, unless it was committed
  /// before. Nothing happens if a newer attempt has begun since it was admitted.
  std::optional<CompleteBatch> count(std::size_t stream, const MessageDescriptor& descriptor);

  /// Takes realizations before `committed` as done with. Before the first message only.
  void resume_at(std::uint64_t committed) { start_ = committed_ = committed; }

  /// What to report to the leader.
  Acknowledgement acknowledgement() const;

  /// Name of the count-th step of the present attempt.
  MessageId id_of(std::int64_t count) const;

  /// Messages counted in the present attempt.
  std::uint64_t messages() const { return messages_; }

  bool complete() const { return schedule_.is_complete(committed_); }
  /// First realization that is not committed.
  std::uint64_t committed() const { return committed_; }
  std::uint32_t attempt() const { return attempt_; }

  /// The latest message of a stream, or of each, in the present attempt.
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
  std::vector<std::int64_t> arrived_;     ///< messages of the attempt that were counted, per stream
  std::deque<Step> open_;                 ///< of the steps that have not arrived from every stream
  std::int64_t acknowledged_ = 0;         ///< steps of the attempt that have
  std::uint64_t messages_ = 0;            ///< counted in the attempt
  std::uint64_t positions_in_batch_ = 0;  ///< of acknowledged steps of the batch in progress
};

}  // namespace platoon
