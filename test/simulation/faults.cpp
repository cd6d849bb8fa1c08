#include "simulation/faults.hpp"

#include <stochastic_platoon/Position.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "simulation/machine.hpp"
#include "simulation/uniform.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon::simulation {

namespace {

const char* const kNames[] = {"kill",      "stop",  "pause",  "cut",   "slow",      "full_disk",
                              "set_clock", "stray", "tamper", "order", "interrupt", "power"};

}  // namespace

std::string to_string(const Fault& fault) {
  return formatted("%s %u %.3f", kNames[static_cast<int>(fault.kind)], fault.which, fault.extent);
}

Plan plan_of(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  // Shares in per cent, in the order of FaultKind.
  constexpr int kShares[] = {20, 8, 14, 18, 12, 5, 2, 5, 6, 6, 3, 1};
  Plan plan{seed, {}};
  const std::size_t count = 20 + random() % 80;
  while (plan.faults.size() < count) {
    auto left = static_cast<int>(random() % 100);
    int kind = 0;
    while (left >= kShares[kind]) left -= kShares[kind++];
    const double wait = -std::log(1.0 - uniform(random)) * (random() % 4 == 0 ? 0.5 : 0.05);
    plan.faults.push_back(
        {static_cast<FaultKind>(kind), wait, static_cast<std::uint32_t>(random() >> 33), uniform(random)});
  }
  return plan;
}

std::string disturb_connection(World& world, const Fault& fault) {
  const auto connections = world.all_connections();
  if (connections.empty()) return "no connection";
  const auto& connection = connections[fault.which % connections.size()];
  if (fault.kind == FaultKind::cut)
    world.cut(connection);
  else
    connection->slow_until = world.now() + 3.0 * fault.extent;
  return connection->sent.lock()->topic + " to " + connection->received.lock()->node->name();
}

void fill_disk(World& world, const Fault& fault) {
  Machine::limit_files(1 + static_cast<std::size_t>(20000.0 * fault.extent));
  world.after(3.0 * fault.extent, nullptr, [] { Machine::limit_files(0); });
}

std::optional<ros::SerializedMessage> tampered(const ros::SerializedMessage& position, std::uint32_t which) {
  auto changed = boost::make_shared<stochastic_platoon::Position>(
      *boost::static_pointer_cast<const stochastic_platoon::Position>(position.message));
  switch (which % 5) {
    case 0:
      return std::nullopt;
    case 1:
      changed->step += 1;
      break;
    case 2:
      changed->position.pop_back();
      break;
    case 3:
      changed->position.front() = std::numeric_limits<double>::quiet_NaN();
      break;
    default:
      changed->run += 1;
      break;
  }
  ros::SerializedMessage other = position;
  other.message = changed;
  return other;
}

}  // namespace platoon::simulation
