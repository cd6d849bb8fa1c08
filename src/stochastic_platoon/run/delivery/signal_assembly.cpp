#include "stochastic_platoon/run/delivery/signal_assembly.hpp"

#include <algorithm>

namespace platoon {

SignalAssembly::SignalAssembly(const BatchSchedule& schedule, std::size_t followers, std::uint64_t first,
                               std::uint32_t attempt, std::int64_t before)
    : vehicles_(followers + 1), arrivals_(schedule, followers + 1, first, attempt), before_(before) {}

SignalAssembly::Receipt SignalAssembly::receive(std::size_t vehicle, const MessageDescriptor& descriptor,
                                                const Positions& positions) {
  const bool is_newer = descriptor.id.attempt > arrivals_.attempt();
  Receipt receipt{arrivals_.admit(vehicle, descriptor)};
  if (receipt.drop != DropReason::none) return receipt;
  receipt.restarted = is_newer;
  if (receipt.restarted) vehicles_.assign(vehicles_.size(), Vehicle());
  vehicles_[vehicle].positions.push_back(positions);
  if (vehicle > 0) find_due(vehicle, receipt.due);
  if (vehicle + 1 < vehicles_.size()) find_due(vehicle + 1, receipt.due);
  let_go(vehicle);
  return receipt;
}

void SignalAssembly::find_due(std::size_t follower, std::vector<DueSignals>& due) {
  Vehicle& own = vehicles_[follower];
  const Vehicle& predecessor = vehicles_[follower - 1];
  for (; own.handed_out < std::min(own.end(), predecessor.end()); ++own.handed_out) {
    const std::int64_t k = own.handed_out;
    const MessageId id = arrivals_.id_of(k);
    if (id.step == kInitialStep || id.first_realization < arrivals_.committed()) continue;
    due.push_back({follower, id, predecessor.at(k), {}});
    for (std::int64_t j = 0; j <= before_; ++j)  // at most back to step -1
      due.back().own[static_cast<std::size_t>(j)] = own.at(k - std::min(j, id.step - kInitialStep));
  }
  let_go(follower);
  let_go(follower - 1);
}

// Step k of a vehicle is needed for its own signals at k to k + before_ and for its follower's at k.
void SignalAssembly::let_go(std::size_t vehicle) {
  Vehicle& owner = vehicles_[vehicle];
  std::int64_t needed = vehicle > 0 ? owner.handed_out - before_ : owner.end();
  if (vehicle + 1 < vehicles_.size()) needed = std::min(needed, vehicles_[vehicle + 1].handed_out);
  while (owner.first_kept < needed && !owner.positions.empty()) {
    owner.positions.pop_front();
    ++owner.first_kept;
  }
}

}  // namespace platoon
