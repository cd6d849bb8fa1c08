#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "stochastic_platoon/delivery/sequence.hpp"

namespace platoon {

/// A batch whose every message has arrived.
struct CompleteBatch {
  std::uint64_t first_realization;
  std::uint64_t positions_received;  ///< of the batch, over all streams: counted, not computed
};

/// What Arrivals tells; all of it from within receive().
struct ArrivalEvents {
  /// A new attempt begins: everything of unfinished batches is void. Called before its first message counts.
  std::function<void()> restarted;
  /// A batch is whole that was not committed before.
  std::function<void(const CompleteBatch&)> batch_complete;
};

/// A receiver's side of the delivery contract over several streams of positions that belong together: judges
/// every message, knows up to where all streams have arrived, and commits whole batches in order.
///
/// An attempt may begin at the first batch that is not committed, or at an earlier one that another receiver
/// still needs: then what is committed already passes by and is acknowledged, without counting again.
class Arrivals {
public:
  /// Realizations before `committed` are done with. `attempt` is the latest attempt known from before.
  Arrivals(const BatchSchedule& schedule, std::size_t streams, std::uint64_t committed, std::uint32_t attempt,
           ArrivalEvents events);

  /// Takes a message of a stream. Only those in turn have any effect: then `take` is called, after
  /// restarted() and before batch_complete(), to keep the message. If messages of other streams are received
  /// meanwhile and begin a newer attempt, this one is stale.
  Verdict receive(std::size_t stream, const Turn& turn, const std::vector<double>& positions,
                  const std::function<void()>& take);

  /// Takes realizations before `committed` as done with. Before the first message only.
  void resume_at(std::uint64_t committed) { start_ = committed_ = committed; }

  /// What to report to the leader.
  Acknowledgement acknowledgement() const;

  /// Name of the count-th step of the present attempt.
  Turn turn_of(std::int64_t count) const;

  bool complete() const { return schedule_.is_complete(committed_); }
  /// First realization that is not committed.
  std::uint64_t committed() const { return committed_; }
  std::uint32_t attempt() const { return attempt_; }

  /// The latest turn of a stream, or of each, in the present attempt.
  std::optional<Turn> latest(std::size_t stream) const;
  std::vector<std::optional<Turn>> latest() const;

private:
  struct Step {
    std::size_t streams = 0;
    std::uint64_t positions = 0;
  };
  bool may_start_at(std::uint64_t first) const;
  void restart(const Turn& turn);
  void count(std::size_t stream, std::size_t size);

  BatchSchedule schedule_;
  ArrivalEvents events_;
  std::uint32_t attempt_;
  std::uint64_t start_;  ///< first realization of the attempt
  std::uint64_t committed_;
  std::vector<Sequence> sequences_;
  std::vector<std::int64_t> arrived_;     ///< steps of the attempt that have arrived, per stream
  std::deque<Step> open_;                 ///< of the steps that have not arrived from every stream
  std::int64_t acknowledged_ = 0;         ///< steps of the attempt that have
  std::uint64_t positions_in_batch_ = 0;  ///< of acknowledged steps of the batch in progress
};

}  // namespace platoon
