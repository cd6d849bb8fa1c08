#include "stochastic_platoon/delivery/assembly.hpp"

#include <algorithm>
#include <utility>

namespace platoon {

Assembly::Assembly(const BatchSchedule& schedule, std::size_t followers, const TrackingError& error,
                   std::uint64_t first, std::uint32_t attempt, AssemblyEvents events)
    : error_(error),
      events_(std::move(events)),
      vehicles_(followers + 1),
      arrivals_(schedule, followers + 1, first, attempt,
                {[this] {
                   vehicles_.assign(vehicles_.size(), Vehicle());
                   events_.restarted();
                 },
                 [this](const CompleteBatch& batch) { events_.batch_complete(batch); }}) {}

Verdict Assembly::receive(std::size_t vehicle, const Turn& turn, const Positions& positions) {
  return arrivals_.receive(vehicle, turn, *positions, [&] { take(vehicle, positions); });
}

void Assembly::take(std::size_t vehicle, const Positions& positions) {
  vehicles_[vehicle].positions.push_back(positions);
  if (vehicle > 0) form_errors(vehicle);
  if (vehicle + 1 < vehicles_.size()) form_errors(vehicle + 1);
  let_go(vehicle);
}

void Assembly::form_errors(std::size_t follower) {
  Vehicle& own = vehicles_[follower];
  const Vehicle& predecessor = vehicles_[follower - 1];
  for (; own.formed < std::min(own.end(), predecessor.end()); ++own.formed) {
    const Turn turn = arrivals_.turn_of(own.formed);
    if (turn.step == kInitialStep || turn.first_realization < arrivals_.committed()) continue;
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

}  // namespace platoon
