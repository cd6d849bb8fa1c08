// The delivery contract as a whole: under all losses and kills, the statistics are those of an undisturbed run, to the
// bit.

#include <gtest/gtest.h>

#include "unit/monte_carlo.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/run/delivery/lossy_graph.hpp"
#include "unit/same_bits.hpp"

namespace platoon {
namespace {

constexpr std::size_t kFollowers = 3;
constexpr std::uint64_t kNoiseSeed = 5;
const BatchSchedule kSchedule{99, 4, 3};  // the last batch has three realizations

PlatoonModel example() {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().standstill_distance = 7.0;
  model.default_vehicle().initial_position = {0.8, 0.3};
  return model;
}

const EnsembleTotals& undisturbed() {
  static const EnsembleTotals table =
      monte_carlo(example(), {kNoiseSeed, kFollowers, kSchedule.steps, 99}, kSchedule.realizations);
  return table;
}

std::vector<std::uint64_t> all_batches() {
  std::vector<std::uint64_t> firsts;
  for (std::uint64_t first = 0; !kSchedule.is_complete(first); first = kSchedule.next(first)) firsts.push_back(first);
  return firsts;
}

struct Outcome {
  int kills = 0;
  std::uint32_t attempts = 0;
};

// Runs the graph with many seeds; every run must end like the undisturbed one.
Outcome expect_undisturbed_statistics(const Troubles& troubles, unsigned runs) {
  Outcome outcome;
  for (unsigned chance = 0; chance < runs && !testing::Test::HasFailure(); ++chance) {
    LossyGraph graph(example(), kSchedule, kFollowers, kNoiseSeed, troubles, chance);
    SCOPED_TRACE(chance);
    expect_same_bits(graph.run().moments, undisturbed().moments);
    EXPECT_EQ(graph.positions_received(),
              (kFollowers + 1) * static_cast<std::uint64_t>(kSchedule.steps + 1) * kSchedule.realizations);
    EXPECT_EQ(graph.recorded(), troubles.recorder ? all_batches() : std::vector<std::uint64_t>());
    outcome.kills += graph.kills();
    outcome.attempts += graph.attempts();
  }
  return outcome;
}

TEST(DeliveryContract, NeedsOneAttemptWithoutFaults) {
  EXPECT_EQ(expect_undisturbed_statistics({}, 20).attempts, 20u);
}

TEST(DeliveryContract, HoldsIfMessagesAreLost) {
  Troubles troubles;
  troubles.drop = 0.003;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).attempts, 120u);
}

TEST(DeliveryContract, HoldsIfAComponentIsKilled) {
  for (double Troubles::*component : {&Troubles::kill_follower, &Troubles::kill_leader, &Troubles::kill_monitor}) {
    Troubles troubles;
    troubles.*component = 0.002;
    EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
  }
}

TEST(DeliveryContract, HoldsUnderAllFaultsAtOnce) {
  Troubles troubles;
  troubles.drop = 0.001;
  troubles.kill_leader = troubles.kill_monitor = 0.0005;
  troubles.kill_follower = 0.001;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
}

TEST(DeliveryContract, HoldsForFollowersThatDoNotPublishAhead) {
  Troubles troubles;
  for (const std::size_t depth : {0, 1, 2}) {
    troubles.pipeline_depth = depth;
    EXPECT_EQ(expect_undisturbed_statistics(troubles, 10).attempts, 10u) << depth;
  }
  troubles.drop = 0.001;
  troubles.kill_follower = 0.002;
  troubles.pipeline_depth = 1;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
}

TEST(DeliveryContract, HoldsForARecorderBesideTheMonitorWithoutFaults) {
  Troubles troubles;
  troubles.recorder = true;
  EXPECT_EQ(expect_undisturbed_statistics(troubles, 20).attempts, 20u);
}

TEST(DeliveryContract, HoldsForARecorderBesideTheMonitorUnderAllFaults) {
  Troubles troubles;
  troubles.recorder = true;
  troubles.drop = 0.0005;
  troubles.kill_leader = troubles.kill_monitor = troubles.kill_recorder = troubles.kill_follower = 0.0005;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
}

}  // namespace
}  // namespace platoon
