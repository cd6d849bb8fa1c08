#include "stochastic_platoon/run/delivery/arrivals.hpp"

#include <algorithm>
#include <utility>

namespace platoon {

Arrivals::Arrivals(const BatchSchedule& schedule, std::size_t streams, std::uint64_t committed, std::uint32_t attempt)
    : schedule_(schedule),
      attempt_(attempt),
      start_(committed),
      committed_(committed),
      orders_(streams, MessageOrder(schedule)),
      arrived_(streams, 0) {}

// An attempt must start a whole number of batches before the first uncommitted realization.
bool Arrivals::may_start_at(std::uint64_t first) const {
  if (first > committed_) return false;
  return complete() || (committed_ - first) % schedule_.batch == 0;
}

DropReason Arrivals::admit(std::size_t stream, const MessageDescriptor& descriptor) {
  const MessageId& id = descriptor.id;
  MessageOrder& order = orders_.at(stream);
  if (id.attempt < attempt_) return DropReason::stale;
  const bool new_attempt = id.attempt > attempt_;
  const bool may_start = new_attempt ? may_start_at(id.first_realization) : id.first_realization == start_;
  // A stream joins an attempt only at its start: earlier messages would be lost for good.
  const bool joins = new_attempt || !latest(stream);
  if (joins && id.step == kInitialStep && !may_start) return DropReason::out_of_turn;
  const DropReason drop = order.receive(descriptor);
  if (drop == DropReason::none && new_attempt) restart(id);
  return drop;
}

void Arrivals::restart(const MessageId& id) {
  attempt_ = id.attempt;
  start_ = id.first_realization;
  arrived_.assign(arrived_.size(), 0);
  open_.clear();
  acknowledged_ = 0;
  messages_ = 0;
  positions_in_batch_ = 0;
}

MessageId Arrivals::id_of(std::int64_t count) const {
  if (schedule_.endless()) return {attempt_, start_, count + kInitialStep};
  const std::int64_t per_batch = schedule_.steps + 1;
  const auto batches = static_cast<std::uint64_t>(count / per_batch);
  const std::uint64_t first = std::min(start_ + batches * schedule_.batch, schedule_.realizations);
  return {attempt_, first, count % per_batch + kInitialStep};
}

// As every stream is in order, a message completes at most its own step.
std::optional<CompleteBatch> Arrivals::count(std::size_t stream, const MessageDescriptor& descriptor) {
  if (descriptor.id.attempt < attempt_) return std::nullopt;
  ++messages_;
  const auto place = static_cast<std::size_t>(arrived_[stream]++ - acknowledged_);
  if (open_.size() <= place) open_.resize(place + 1);
  ++open_[place].streams;
  open_[place].positions += descriptor.size;
  if (place > 0 || open_.front().streams < orders_.size()) return std::nullopt;
  positions_in_batch_ += open_.front().positions;
  open_.pop_front();
  const MessageId id = id_of(acknowledged_++);
  if (!schedule_.is_last_step(id.step)) return std::nullopt;
  const CompleteBatch batch{id.first_realization, std::exchange(positions_in_batch_, 0)};
  if (id.first_realization < committed_) return std::nullopt;
  committed_ = schedule_.next(id.first_realization);
  return batch;
}

Acknowledgement Arrivals::acknowledgement() const {
  if (acknowledged_ == 0) return {attempt_, start_, kNothingYet};
  const MessageId id = id_of(acknowledged_ - 1);
  if (!schedule_.is_last_step(id.step)) return id;
  return {attempt_, schedule_.next(id.first_realization), kNothingYet};
}

std::optional<MessageId> Arrivals::latest(std::size_t stream) const {
  const std::optional<MessageId>& id = orders_.at(stream).latest();
  return id && id->attempt == attempt_ ? id : std::nullopt;
}

std::vector<std::optional<MessageId>> Arrivals::latest() const {
  std::vector<std::optional<MessageId>> ids;
  for (std::size_t stream = 0; stream < orders_.size(); ++stream) ids.push_back(latest(stream));
  return ids;
}

std::vector<std::optional<MessageId>> Arrivals::latest_of_any_attempt() const {
  std::vector<std::optional<MessageId>> ids;
  for (const MessageOrder& order : orders_) ids.push_back(order.latest());
  return ids;
}

}  // namespace platoon
