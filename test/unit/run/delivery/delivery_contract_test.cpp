// The delivery contract as a whole: under all losses and kills, the statistics are those of an undisturbed run, to the
// bit.

#include <gtest/gtest.h>

#include "unit/monte_carlo.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/run/delivery/lossy_graph.hpp"

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

bool same_bits(const EnsembleTotals& left, const EnsembleTotals& right) {
  const std::vector<Moments> one = left.moments.totals(), other = right.moments.totals();
  bool same = left.count() == right.count() && one.size() == other.size();
  for (std::size_t c = 0; same && c < one.size(); ++c) {
    same = one[c].mean == other[c].mean && one[c].squared_deviations == other[c].squared_deviations;
  }
  return same;
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
    EXPECT_TRUE(same_bits(graph.run(), undisturbed())) << "chance " << chance;
    EXPECT_EQ(graph.positions_received(),
              (kFollowers + 1) * static_cast<std::uint64_t>(kSchedule.steps + 1) * kSchedule.realizations)
        << "chance " << chance;
    EXPECT_EQ(graph.recorded(), troubles.recorder ? all_batches() : std::vector<std::uint64_t>())
        << "chance " << chance;
    outcome.kills += graph.kills();
    outcome.attempts += graph.attempts();
  }
  return outcome;
}

TEST(DeliveryContract, NeedsOneAttemptWhenNothingGoesWrong) {
  EXPECT_EQ(expect_undisturbed_statistics({}, 20).attempts, 20u);
}

TEST(DeliveryContract, HoldsWhenMessagesAreLost) {
  Troubles troubles;
  troubles.drop = 0.003;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).attempts, 120u);
}

TEST(DeliveryContract, HoldsWhenFollowersAreKilled) {
  Troubles troubles;
  troubles.kill_follower = 0.002;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
}

TEST(DeliveryContract, HoldsWhenTheLeaderIsKilled) {
  Troubles troubles;
  troubles.kill_leader = 0.002;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
}

TEST(DeliveryContract, HoldsWhenTheMonitorIsKilled) {
  Troubles troubles;
  troubles.kill_monitor = 0.002;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
}

TEST(DeliveryContract, HoldsWhenEverythingGoesWrongAtOnce) {
  Troubles troubles;
  troubles.drop = 0.001;
  troubles.kill_leader = troubles.kill_monitor = 0.0005;
  troubles.kill_follower = 0.001;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
}

TEST(DeliveryContract, HoldsForFollowersThatDoNotLead) {
  Troubles troubles;
  for (const std::size_t lead : {0, 1, 2}) {
    troubles.pipeline_depth = lead;
    EXPECT_EQ(expect_undisturbed_statistics(troubles, 10).attempts, 10u) << lead;
  }
  troubles.drop = 0.001;
  troubles.kill_follower = 0.002;
  troubles.pipeline_depth = 1;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
}

TEST(DeliveryContract, HoldsForARecorderBesideTheMonitorWhenNothingGoesWrong) {
  Troubles troubles;
  troubles.recorder = true;
  EXPECT_EQ(expect_undisturbed_statistics(troubles, 20).attempts, 20u);
}

TEST(DeliveryContract, HoldsForARecorderBesideTheMonitorWhenEverythingGoesWrong) {
  Troubles troubles;
  troubles.recorder = true;
  troubles.drop = 0.0005;
  troubles.kill_leader = troubles.kill_monitor = troubles.kill_recorder = troubles.kill_follower = 0.0005;
  EXPECT_GT(expect_undisturbed_statistics(troubles, 60).kills, 60);
}

}  // namespace
}  // namespace platoon
