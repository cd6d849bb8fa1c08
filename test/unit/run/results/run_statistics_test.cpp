#include "stochastic_platoon/run/results/run_statistics.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <future>
#include <mutex>

#include "stochastic_platoon/math/channel/awgn_channel.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "unit/monte_carlo.hpp"
#include "unit/paper_run.hpp"
#include "unit/same_gaps.hpp"
#include "unit/transmitted.hpp"

namespace platoon {
namespace {

// Positions of every vehicle at steps -1 .. steps - 1 of a batch, as the nodes publish them.
std::vector<std::vector<Positions>> positions_of(const Configuration& configuration, std::uint64_t first,
                                                 std::size_t count, std::int64_t steps) {
  const auto share = [](const std::vector<double>& values) {
    return std::make_shared<const std::vector<double>>(values);
  };
  std::vector<std::vector<Positions>> all(1);
  LeaderVehicle leader(configuration.model);
  all[0].push_back(share(std::vector<double>(count, leader.start())));
  for (std::int64_t k = 0; k < steps; ++k) all[0].push_back(share(std::vector<double>(count, leader.step())));
  for (std::uint32_t i = 1; i <= configuration.run.followers; ++i) {
    FollowerVehicle follower(configuration.model, configuration.run.seed, i);
    const AwgnChannel channel(configuration.model.default_vehicle().noise_variance, configuration.run.seed, i);
    std::vector<double> own;
    follower.start(first, count, own);
    all.push_back({share(own)});
    for (std::int64_t k = 0; k < steps; ++k) {
      follower.step(transmitted(channel, k - 1, first, *all[i - 1][static_cast<std::size_t>(k)]), own);
      all[i].push_back(share(own));
    }
  }
  return all;
}

DropReason take(RunStatistics& statistics, std::size_t vehicle, const MessageId& id, const Positions& positions) {
  return statistics.take(vehicle, {id, positions->size(), true}, positions);
}

Configuration endless_run() {
  Configuration configuration = paper_run("");
  configuration.run.steps = 0;
  configuration.run.realizations = configuration.run.batch = 1;
  configuration.run.burn_in = 30;
  return configuration;
}

// Passes the batch on step by step, up to `last_step`.
void receive_batch(RunStatistics& statistics, const Configuration& configuration, std::uint32_t attempt,
                   std::uint64_t first, std::int64_t last_step) {
  const std::size_t count = configuration.run.schedule().size(first);
  const auto all = positions_of(configuration, first, count, last_step + 1);
  for (std::int64_t k = kInitialStep; k <= last_step; ++k) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      ASSERT_EQ(take(statistics, i, {attempt, first, k}, all[i][static_cast<std::size_t>(k + 1)]), DropReason::none);
    }
  }
}

void expect_monte_carlo(const std::vector<Moments>& found, const Configuration& configuration,
                        std::uint64_t realizations) {
  const RunOptions& run = configuration.run;
  const Ensemble ensemble{run.seed, run.followers, run.steps, 8192, run.signals};
  const std::vector<Moments> expected = monte_carlo(configuration.model, ensemble, realizations).moments.totals();
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t c = 0; c < found.size(); ++c) {
    EXPECT_EQ(found[c].count, expected[c].count);
    EXPECT_EQ(found[c].mean, expected[c].mean);
    EXPECT_EQ(found[c].squared_deviations, expected[c].squared_deviations);
  }
}

TEST(RunStatistics, AreTheMonteCarlosToTheBit) {
  const Configuration configuration = paper_run("");
  RunStatistics statistics(configuration, std::nullopt);
  EXPECT_TRUE(statistics.averages().empty());
  for (const std::uint64_t first : {0, 8, 16}) receive_batch(statistics, configuration, 1, first, 2);
  EXPECT_TRUE(statistics.arrivals().complete());
  EXPECT_FALSE(statistics.averages().empty());
  EXPECT_EQ(statistics.averages().realizations(), 20u);
  EXPECT_EQ(statistics.result(true).last_step, 2);
  expect_monte_carlo(statistics.averages().moments(), configuration, 20);
  const RunResult result = statistics.result(true);
  EXPECT_TRUE(result.complete);
  EXPECT_EQ(result.realizations, 20u);
  EXPECT_EQ(result.tally.positions_received, positions_expected(configuration.run, 20));
  EXPECT_EQ(result.tally.attempts, 1u);
}

TEST(RunStatistics, FromSeveralThreadsAreTheMonteCarlosToTheBit) {
  Configuration configuration = paper_run("");
  configuration.run.followers = 5;
  configuration.run.steps = 40;
  configuration.run.realizations = 400;
  configuration.run.signals = {"gap", "speed", "jerk"};
  std::mutex mutex;
  RunStatistics statistics(configuration, std::nullopt);
  const BatchSchedule schedule = configuration.run.schedule();
  const auto receive_vehicles = [&](std::size_t first_vehicle) {
    for (std::uint64_t first = 0; !schedule.is_complete(first); first = schedule.next(first)) {
      const auto all = positions_of(configuration, first, schedule.size(first), configuration.run.steps);
      for (std::int64_t k = kInitialStep; k < configuration.run.steps; ++k) {
        for (std::size_t i = first_vehicle; i <= configuration.run.followers; i += 2) {
          const Positions& positions = all[i][static_cast<std::size_t>(k + 1)];
          std::unique_lock<std::mutex> lock(mutex);
          const MessageDescriptor descriptor{{1, first, k}, positions->size(), true};
          const SignalAssembly::Receipt receipt = statistics.receive(i, descriptor, positions);
          EXPECT_EQ(receipt.drop, DropReason::none);
          lock.unlock();
          const std::vector<ReducedSignals> signals = statistics.compute(receipt.due);
          lock.lock();
          statistics.settle(i, descriptor, signals);
        }
      }
    }
  };
  const auto other = std::async(std::launch::async, receive_vehicles, 1);
  receive_vehicles(0);
  other.wait();
  EXPECT_TRUE(statistics.arrivals().complete());
  expect_monte_carlo(statistics.averages().moments(), configuration, 400);
  const RunOptions& run = configuration.run;
  const EnsembleTotals expected =
      monte_carlo(configuration.model, {run.seed, run.followers, run.steps, 64, run.signals}, 400);
  expect_same_gaps(statistics.result(true).gaps, expected.gaps);
  EXPECT_EQ(statistics.result(true).signals.size(), 3u);
  EXPECT_EQ(statistics.tally().positions_received, positions_expected(configuration.run, 400));
}

TEST(RunStatistics, CommitABatchWithTheLastResultThatIsSettled) {
  const Configuration configuration = paper_run("");
  const auto all = positions_of(configuration, 0, 8, 3);
  RunStatistics statistics(configuration, std::nullopt);
  std::array<std::vector<std::vector<ReducedSignals>>, 3> computed;  // by vehicle and message
  for (std::int64_t k = -1; k <= 2; ++k) {
    for (std::size_t i = 0; i <= 2; ++i) {
      const SignalAssembly::Receipt receipt =
          statistics.receive(i, {{1, 0, k}, 8, true}, all[i][static_cast<std::size_t>(k + 1)]);
      computed[i].push_back(statistics.compute(receipt.due));
    }
  }
  EXPECT_TRUE(statistics.averages().empty());
  // Vehicle 2 first: its messages are in order, independent of the others.
  for (const std::size_t vehicle : {2, 0, 1}) {
    for (std::int64_t k = -1; k <= 2; ++k) {
      const std::vector<ReducedSignals>& signals = computed[vehicle][static_cast<std::size_t>(k + 1)];
      EXPECT_EQ(statistics.settle(vehicle, {{1, 0, k}, 8, true}, signals), vehicle == 1 && k == 2);
    }
  }
  expect_monte_carlo(statistics.averages().moments(), configuration, 8);
}

TEST(RunStatistics, CountNothingOfAnAttemptThatEndsWhileItsErrorsAreFormed) {
  const Configuration configuration = paper_run("");
  const auto all = positions_of(configuration, 0, 8, 3);
  RunStatistics statistics(configuration, std::nullopt);
  for (std::size_t i = 0; i <= 2; ++i) {
    for (std::int64_t k = -1; k <= 2; ++k) {
      const MessageDescriptor descriptor{{1, 0, k}, 8, true};
      const SignalAssembly::Receipt receipt =
          statistics.receive(i, descriptor, all[i][static_cast<std::size_t>(k + 1)]);
      EXPECT_EQ(receipt.drop, DropReason::none);
      if (i == 2 && k == 2) {
        EXPECT_EQ(take(statistics, 0, {2, 0, -1}, all[0][0]), DropReason::none);
      }
      EXPECT_FALSE(statistics.settle(i, descriptor, statistics.compute(receipt.due)));
    }
  }
  EXPECT_TRUE(statistics.averages().empty());
  EXPECT_EQ(statistics.tally().positions_received, 0u);
  for (std::size_t i = 0; i <= 2; ++i) {
    for (std::int64_t k = i == 0 ? 0 : -1; k <= 2; ++k) {
      EXPECT_EQ(take(statistics, i, {2, 0, k}, all[i][static_cast<std::size_t>(k + 1)]), DropReason::none);
    }
  }
  EXPECT_EQ(statistics.averages().realizations(), 8u);
  expect_monte_carlo(statistics.averages().moments(), configuration, 8);
}

TEST(RunStatistics, NumberTheAttemptsOfAnotherLaunchAnew) {
  Configuration configuration = paper_run("");
  RunStatistics before(configuration, std::nullopt);
  receive_batch(before, configuration, 22, 0, 2);
  const Checkpoint checkpoint = before.checkpoint();
  configuration.run.launch_id = "the next launch";
  RunStatistics after(configuration, checkpoint);
  EXPECT_EQ(after.arrivals().attempt(), 0u);
  receive_batch(after, configuration, 1, 8, 2);
  EXPECT_EQ(after.tally().attempts, 1u);
  expect_monte_carlo(after.averages().moments(), configuration, 16);
}

TEST(RunStatistics, CountNothingOfAnUnfinishedBatch) {
  const Configuration configuration = paper_run("");
  RunStatistics statistics(configuration, std::nullopt);
  receive_batch(statistics, configuration, 1, 0, 2);
  receive_batch(statistics, configuration, 1, 8, 1);
  expect_monte_carlo(statistics.averages().moments(), configuration, 8);
  receive_batch(statistics, configuration, 4, 8, 2);
  expect_monte_carlo(statistics.averages().moments(), configuration, 16);
  EXPECT_EQ(statistics.tally().positions_received, positions_expected(configuration.run, 16));
  EXPECT_EQ(statistics.tally().attempts, 4u);
}

TEST(RunStatistics, GoOnFromTheirCheckpointToTheBit) {
  const Configuration configuration = paper_run("");
  RunStatistics before(configuration, std::nullopt);
  receive_batch(before, configuration, 3, 0, 2);
  const Checkpoint checkpoint = before.checkpoint();
  EXPECT_EQ(checkpoint.launch_id, "this launch");
  EXPECT_EQ(checkpoint.identity, statistics_identity(configuration));
  RunStatistics after(configuration, checkpoint);
  EXPECT_EQ(after.averages().realizations(), 8u);
  EXPECT_EQ(after.arrivals().committed(), 8u);
  EXPECT_EQ(after.arrivals().attempt(), 3u);
  receive_batch(after, configuration, 4, 8, 2);
  receive_batch(after, configuration, 4, 16, 2);
  expect_monte_carlo(after.averages().moments(), configuration, 20);
  EXPECT_EQ(after.tally().positions_received, positions_expected(configuration.run, 20));
}

TEST(RunStatistics, OfAnEndlessRunAreTimeAveragesAfterTheBurnIn) {
  Configuration configuration = endless_run();
  RunStatistics statistics(configuration, std::nullopt);
  EXPECT_TRUE(statistics.averages().empty());
  receive_batch(statistics, configuration, 1, 0, 49);
  EXPECT_EQ(statistics.result(false).last_step, 49);
  EXPECT_EQ(statistics.averages().realizations(), 1u);
  ASSERT_EQ(statistics.averages().moments().size(), 2u);
  const auto all = positions_of(configuration, 0, 1, 50);
  const Signal error = tracking_error(configuration.model, 1);
  for (std::size_t i = 1; i <= 2; ++i) {
    Moments expected;
    for (std::size_t k = 31; k <= 50; ++k) {
      expected.add(error(all[i - 1][k]->front(), {all[i][k]->front(), all[i][k - 1]->front()}));
    }
    EXPECT_EQ(statistics.averages().moments()[i - 1].count, 20u);
    EXPECT_EQ(statistics.averages().moments()[i - 1].mean, expected.mean);
    EXPECT_EQ(statistics.averages().moments()[i - 1].squared_deviations, expected.squared_deviations);
  }
  EXPECT_EQ(statistics.tally().positions_received, 3u * 51u);
}

// A leader at another position that moves like the model's departs from the model only at the jump.
TEST(RunStatistics, OfAnEndlessRunLeaveOutAManoeuvreOfTheLeader) {
  Configuration configuration = endless_run();
  RunStatistics undisturbed(configuration, std::nullopt), statistics(configuration, std::nullopt);
  auto all = positions_of(configuration, 0, 1, 160);
  constexpr std::int64_t kJump = 60;
  for (std::int64_t k = kInitialStep; k < 160; ++k) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Positions& sent = all[i][static_cast<std::size_t>(k + 1)];
      ASSERT_EQ(take(undisturbed, i, {1, 0, k}, sent), DropReason::none);
      const double moved = k >= kJump ? 2.5 : 0.0;
      const auto elsewhere = std::make_shared<const std::vector<double>>(1, sent->front() + moved);
      ASSERT_EQ(take(statistics, i, {1, 0, k}, elsewhere), DropReason::none);
      if (i == 0) {
        EXPECT_EQ(statistics.result(false).manoeuvre, k == kJump) << k;
      }
    }
  }
  EXPECT_FALSE(undisturbed.leader_departs());
  EXPECT_EQ(undisturbed.averages().moments()[0].count, 130u);
  EXPECT_EQ(statistics.averages().moments()[0].count, 130u - 31u);  // steps 60 .. 90
  EXPECT_EQ(statistics.averages().moments()[1].count, 130u - 31u);  // 61 .. 91
  EXPECT_EQ(undisturbed.result(false).counted_from, 30);
  EXPECT_EQ(statistics.result(false).counted_from, 92);
}

TEST(RunStatistics, OfAnEndlessRunGoOnWithANewAttemptAfterItsOwnBurnIn) {
  Configuration configuration = endless_run();
  RunStatistics statistics(configuration, std::nullopt);
  receive_batch(statistics, configuration, 1, 0, 49);
  receive_batch(statistics, configuration, 2, 0, 39);
  EXPECT_EQ(statistics.result(false).last_step, 39);
  EXPECT_EQ(statistics.averages().moments()[0].count, 20u + 10u);
  EXPECT_EQ(statistics.tally().positions_received, 3u * (51u + 41u));
  EXPECT_EQ(statistics.result(false).last_steps, (std::vector<std::int64_t>{39, 39}));
}

TEST(RunStatistics, OfAnEndlessRunGoOnFromTheirCheckpointAndNumberTheAttemptsOn) {
  Configuration configuration = endless_run();
  RunStatistics before(configuration, std::nullopt);
  receive_batch(before, configuration, 3, 0, 49);
  configuration.run.launch_id = "the next launch";
  RunStatistics after(configuration, before.checkpoint());
  EXPECT_FALSE(after.averages().empty());
  EXPECT_EQ(after.arrivals().attempt(), 3u);  // each attempt is another realization
  receive_batch(after, configuration, 4, 0, 39);
  EXPECT_EQ(after.averages().moments()[1].count, 20u + 10u);
}

}  // namespace
}  // namespace platoon
