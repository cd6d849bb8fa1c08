#include "stochastic_platoon/delivery/assembly.hpp"

#include <algorithm>
#include <utility>

namespace platoon {

Assembly::Assembly(const BatchSchedule& schedule, std::size_t followers, const TrackingError& error,
                   std::uint64_t first, std::uint32_t attempt, AssemblyEvents events)
    : error_(error),
      events_(std::move(events)),
      vehicles_(followers + 1),
      arrivals_(
          schedule, followers + 1, first, attempt,
          {[this] { restart(); }, [this](const CompleteBatch& batch) { events_.batch_complete(batch); }}) {}

Verdict Assembly::receive(std::size_t vehicle, const Turn& turn, const Positions& positions) {
  return arrivals_.receive(vehicle, turn, *positions, [&] { take(vehicle, positions); });
}

void Assembly::take(std::size_t vehicle, const Positions& positions) {
  vehicles_[vehicle].positions.push_back(positions);
  std::vector<Due> due;
  if (vehicle > 0) find_due(vehicle, due);
  if (vehicle + 1 < vehicles_.size()) find_due(vehicle + 1, due);
  let_go(vehicle);
  if (due.empty()) return;
  events_.arithmetic([&] { form_errors(due); });
}

void Assembly::find_due(std::size_t follower, std::vector<Due>& due) {
  Vehicle& own = vehicles_[follower];
  const Vehicle& predecessor = vehicles_[follower - 1];
  for (; own.formed < std::min(own.end(), predecessor.end()); ++own.formed) {
    const Turn turn = arrivals_.turn_of(own.formed);
    if (turn.step == kInitialStep || turn.first_realization < arrivals_.committed()) continue;
    due.push_back({follower, turn, predecessor.at(own.formed), own.at(own.formed), own.at(own.formed - 1)});
  }
  let_go(follower);
  let_go(follower - 1);
}

void Assembly::form_errors(const std::vector<Due>& all) {
  const std::shared_lock<std::shared_mutex> lock(forming_);
  thread_local std::vector<double> errors;
  for (const Due& due : all) {
    if (due.turn.attempt < attempt_) return;
    errors.resize(due.own->size());
    error_(due.predecessor->data(), due.own->data(), due.own_before->data(), errors.size(), errors.data());
    events_.errors(due.follower, due.turn, errors);
  }
}

void Assembly::restart() {
  const std::lock_guard<std::shared_mutex> lock(forming_);
  vehicles_.assign(vehicles_.size(), Vehicle());
  attempt_ = arrivals_.attempt();
  events_.restarted();
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

}  // namespace platoon
