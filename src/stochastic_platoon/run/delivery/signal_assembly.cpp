#include "stochastic_platoon/run/delivery/signal_assembly.hpp"
#include "stochastic_platoon/math/model/input.hpp"

#include <algorithm>
#include <utility>

namespace platoon {

SignalAssembly::SignalAssembly(const BatchSchedule& schedule, std::size_t followers, std::uint64_t first,
                               std::uint32_t attempt, std::int64_t before, double slope,
                               std::vector<std::size_t> measured)
    : followers_(followers),
      measured_(std::move(measured)),
      vehicles_(vehicles_anew()),
      arrivals_(schedule, followers + 1 + measured_.size(), first, attempt),
      before_(before),
      slope_(slope) {}

std::vector<SignalAssembly::Vehicle> SignalAssembly::vehicles_anew() const {
  std::vector<Vehicle> vehicles(followers_ + 1);
  for (const std::size_t follower : measured_) vehicles.at(follower).is_measured = true;
  return vehicles;
}

namespace {

Positions shifted(const Positions& first, std::int64_t steps, double slope) {
  if (steps == 0 || slope == 0.0) return first;
  auto before = std::make_shared<std::vector<double>>(*first);
  for (double& position : *before) position = position_before(position, static_cast<std::size_t>(steps), slope);
  return before;
}

}  // namespace

SignalAssembly::Receipt SignalAssembly::receive(std::size_t stream, const MessageDescriptor& descriptor,
                                                const Positions& positions) {
  const bool is_newer = descriptor.id.attempt > arrivals_.attempt();
  Receipt receipt{arrivals_.admit(stream, descriptor)};
  if (receipt.drop != DropReason::none) return receipt;
  receipt.restarted = is_newer;
  if (receipt.restarted) vehicles_ = vehicles_anew();
  const bool is_input = stream > followers_;
  const std::size_t vehicle = is_input ? measured_[stream - followers_ - 1] : stream;
  (is_input ? vehicles_[vehicle].inputs : vehicles_[vehicle].positions).push_back(positions);
  if (vehicle > 0) find_due(vehicle, receipt.due);
  if (!is_input && vehicle + 1 < vehicles_.size()) find_due(vehicle + 1, receipt.due);
  let_go(vehicle);
  return receipt;
}

void SignalAssembly::find_due(std::size_t follower, std::vector<DueSignals>& due) {
  Vehicle& own = vehicles_[follower];
  const Vehicle& predecessor = vehicles_[follower - 1];
  for (; own.handed_out < std::min(own.end(), predecessor.end()); ++own.handed_out) {
    Positions input;
    if (own.is_measured) {
      if (own.inputs.empty()) break;
      input = own.inputs.front();
      own.inputs.pop_front();
    }
    const std::int64_t k = own.handed_out;
    const MessageId id = arrivals_.id_of(k);
    if (id.step == kInitialStep || id.first_realization < arrivals_.committed()) continue;
    due.push_back({follower, id, {}, {}, input});
    for (std::int64_t j = 0; j <= before_; ++j) {
      const std::int64_t back = std::min(j, id.step - kInitialStep);  // at most to step -1
      due.back().ahead[static_cast<std::size_t>(j)] = shifted(predecessor.at(k - back), j - back, slope_);
      due.back().own[static_cast<std::size_t>(j)] = shifted(own.at(k - back), j - back, slope_);
    }
  }
  let_go(follower);
  let_go(follower - 1);
}

// Step k of a vehicle is needed for its own signals and for its follower's at k to k + before_.
void SignalAssembly::let_go(std::size_t vehicle) {
  Vehicle& owner = vehicles_[vehicle];
  std::int64_t needed = vehicle > 0 ? owner.handed_out - before_ : owner.end();
  if (vehicle + 1 < vehicles_.size()) needed = std::min(needed, vehicles_[vehicle + 1].handed_out - before_);
  while (owner.first_kept < needed && !owner.positions.empty()) {
    owner.positions.pop_front();
    ++owner.first_kept;
  }
}

}  // namespace platoon
