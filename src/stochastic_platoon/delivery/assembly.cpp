#include "stochastic_platoon/delivery/assembly.hpp"

#include <algorithm>
#include <utility>

namespace platoon {

Assembly::Assembly(const BatchSchedule& schedule, std::size_t followers, const TrackingError& error,
                   std::uint64_t first, std::uint32_t attempt, AssemblyEvents events)
    : schedule_(schedule),
      error_(error),
      events_(std::move(events)),
      attempt_(attempt),
      start_(first),
      committed_(first),
      vehicles_(followers + 1, Vehicle(schedule)) {}

Verdict Assembly::receive(std::size_t vehicle, const Turn& turn, const Positions& positions) {
  Vehicle& sender = vehicles_.at(vehicle);
  if (turn.attempt < attempt_) return Verdict::stale;
  if (turn.attempt > attempt_ && turn.first_realization != committed_) return Verdict::out_of_turn;
  const Verdict verdict = sender.sequence.receive(turn, *positions);
  if (verdict != Verdict::in_turn) return verdict;
  if (turn.attempt > attempt_) restart(turn.attempt);
  sender.positions.push_back(positions);
  const std::int64_t step = sender.end() - 1;
  if (vehicle > 0) form_errors(vehicle);
  if (vehicle + 1 < vehicles_.size()) form_errors(vehicle + 1);
  let_go(vehicle);
  count_arrival(step, positions->size());
  return verdict;
}

void Assembly::restart(std::uint32_t attempt) {
  attempt_ = attempt;
  start_ = committed_;
  acknowledged_ = 0;
  positions_in_batch_ = 0;
  arrivals_.clear();
  for (Vehicle& vehicle : vehicles_) {
    vehicle.positions.clear();
    vehicle.first_kept = 0;
    vehicle.formed = 0;
  }
  events_.restarted();
}

// The name of the count-th step of the attempt.
Turn Assembly::turn_of(std::int64_t count) const {
  if (schedule_.endless()) return {attempt_, start_, count - 1};
  const std::int64_t per_batch = schedule_.steps + 1;
  const auto batches = static_cast<std::uint64_t>(count / per_batch);
  const std::uint64_t first = std::min(start_ + batches * schedule_.batch, schedule_.realizations);
  return {attempt_, first, count % per_batch - 1};
}

void Assembly::form_errors(std::size_t follower) {
  Vehicle& own = vehicles_[follower];
  const Vehicle& predecessor = vehicles_[follower - 1];
  for (; own.formed < std::min(own.end(), predecessor.end()); ++own.formed) {
    const Turn turn = turn_of(own.formed);
    if (turn.step == kInitialStep) continue;
    const std::vector<double>& present = own.at(own.formed);
    buffer_.resize(present.size());
    error_(predecessor.at(own.formed).data(), present.data(), own.at(own.formed - 1).data(), present.size(),
           buffer_.data());
    events_.errors(follower, turn, buffer_);
  }
  let_go(follower);
  let_go(follower - 1);
}

// Step k of a vehicle is needed for its own errors at k and k + 1 and for its follower's at k.
void Assembly::let_go(std::size_t vehicle) {
  Vehicle& owner = vehicles_[vehicle];
  std::int64_t needed = vehicle > 0 ? owner.formed - 1 : owner.end();
  if (vehicle + 1 < vehicles_.size()) needed = std::min(needed, vehicles_[vehicle + 1].formed);
  while (owner.first_kept < needed && !owner.positions.empty()) {
    owner.positions.pop_front();
    ++owner.first_kept;
  }
}

void Assembly::count_arrival(std::int64_t step, std::size_t size) {
  const auto place = static_cast<std::size_t>(step - acknowledged_);
  if (arrivals_.size() <= place) arrivals_.resize(place + 1);
  ++arrivals_[place].vehicles;
  arrivals_[place].positions += size;
  while (!arrivals_.empty() && arrivals_.front().vehicles == vehicles_.size()) {
    positions_in_batch_ += arrivals_.front().positions;
    arrivals_.pop_front();
    const Turn turn = turn_of(acknowledged_++);
    if (!schedule_.is_last_step(turn.step)) continue;
    committed_ = schedule_.next(turn.first_realization);
    events_.batch_complete({turn.first_realization, std::exchange(positions_in_batch_, 0)});
  }
}

Acknowledgement Assembly::acknowledgement() const {
  if (acknowledged_ == 0) return {attempt_, committed_, kNothingYet};
  const Turn turn = turn_of(acknowledged_ - 1);
  if (schedule_.is_last_step(turn.step)) return {attempt_, committed_, kNothingYet};
  return turn;
}

std::vector<std::optional<Turn>> Assembly::latest() const {
  std::vector<std::optional<Turn>> turns;
  for (const Vehicle& vehicle : vehicles_) {
    const std::optional<Turn>& turn = vehicle.sequence.latest();
    turns.push_back(turn && turn->attempt == attempt_ ? turn : std::nullopt);
  }
  return turns;
}

}  // namespace platoon
