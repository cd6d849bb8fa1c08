#include "stochastic_platoon/delivery/arrivals.hpp"

#include <algorithm>
#include <utility>

namespace platoon {

Arrivals::Arrivals(const BatchSchedule& schedule, std::size_t streams, std::uint64_t committed,
                   std::uint32_t attempt, ArrivalEvents events)
    : schedule_(schedule),
      events_(std::move(events)),
      attempt_(attempt),
      start_(committed),
      committed_(committed),
      sequences_(streams, Sequence(schedule)),
      arrived_(streams, 0) {}

// The batches of an attempt must meet the border of what is committed.
bool Arrivals::may_start_at(std::uint64_t first) const {
  if (first > committed_) return false;
  return complete() || (committed_ - first) % schedule_.batch == 0;
}

Verdict Arrivals::receive(std::size_t stream, const Turn& turn, const std::vector<double>& positions,
                          const std::function<void()>& take) {
  if (turn.attempt < attempt_) return Verdict::stale;
  const bool new_attempt = turn.attempt > attempt_;
  const bool may_start =
      new_attempt ? may_start_at(turn.first_realization) : turn.first_realization == start_;
  // A stream joins an attempt where the attempt began, or not at all: what came before is missing for good.
  const bool joins = new_attempt || arrived_.at(stream) == 0;
  if (joins && turn.step == kInitialStep && !may_start) return Verdict::out_of_turn;
  const Verdict verdict = sequences_.at(stream).receive(turn, positions);
  if (verdict != Verdict::in_turn) return verdict;
  if (new_attempt) restart(turn);
  take();
  if (turn.attempt < attempt_) return Verdict::stale;
  count(stream, positions.size());
  return verdict;
}

void Arrivals::restart(const Turn& turn) {
  attempt_ = turn.attempt;
  start_ = turn.first_realization;
  arrived_.assign(arrived_.size(), 0);
  open_.clear();
  acknowledged_ = 0;
  positions_in_batch_ = 0;
  events_.restarted();
}

Turn Arrivals::turn_of(std::int64_t count) const {
  if (schedule_.endless()) return {attempt_, start_, count + kInitialStep};
  const std::int64_t per_batch = schedule_.steps + 1;
  const auto batches = static_cast<std::uint64_t>(count / per_batch);
  const std::uint64_t first = std::min(start_ + batches * schedule_.batch, schedule_.realizations);
  return {attempt_, first, count % per_batch + kInitialStep};
}

void Arrivals::count(std::size_t stream, std::size_t size) {
  const auto place = static_cast<std::size_t>(arrived_[stream]++ - acknowledged_);
  if (open_.size() <= place) open_.resize(place + 1);
  ++open_[place].streams;
  open_[place].positions += size;
  while (!open_.empty() && open_.front().streams == sequences_.size()) {
    positions_in_batch_ += open_.front().positions;
    open_.pop_front();
    const Turn turn = turn_of(acknowledged_++);
    if (!schedule_.is_last_step(turn.step)) continue;
    const CompleteBatch batch{turn.first_realization, std::exchange(positions_in_batch_, 0)};
    if (turn.first_realization < committed_) continue;
    committed_ = schedule_.next(turn.first_realization);
    events_.batch_complete(batch);
  }
}

Acknowledgement Arrivals::acknowledgement() const {
  if (acknowledged_ == 0) return {attempt_, start_, kNothingYet};
  const Turn turn = turn_of(acknowledged_ - 1);
  if (!schedule_.is_last_step(turn.step)) return turn;
  return {attempt_, schedule_.next(turn.first_realization), kNothingYet};
}

std::optional<Turn> Arrivals::latest(std::size_t stream) const {
  const std::optional<Turn>& turn = sequences_.at(stream).latest();
  return turn && turn->attempt == attempt_ ? turn : std::nullopt;
}

std::vector<std::optional<Turn>> Arrivals::latest() const {
  std::vector<std::optional<Turn>> turns;
  for (std::size_t stream = 0; stream < sequences_.size(); ++stream) turns.push_back(latest(stream));
  return turns;
}

}  // namespace platoon
