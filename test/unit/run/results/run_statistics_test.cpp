#include "stochastic_platoon/run/results/run_statistics.hpp"

#include <gtest/gtest.h>

#include <array>
#include <future>
#include <mutex>

#include "unit/run/results/run_statistics_fixture.hpp"

namespace platoon {
namespace {

TEST_F(RunStatisticsTest, EqualThoseOfAMonteCarloToTheBit) {
  RunStatistics statistics(configuration_, std::nullopt);
  EXPECT_TRUE(statistics.averages().empty());
  for (const std::uint64_t first : {0, 8, 16}) receive_batch(statistics, 1, first);
  EXPECT_TRUE(statistics.arrivals().complete());
  EXPECT_FALSE(statistics.averages().empty());
  EXPECT_EQ(statistics.averages().realizations(), 20u);
  EXPECT_EQ(statistics.result(true).last_step, 2);
  expect_monte_carlo(statistics, 20);
  const RunResult result = statistics.result(true);
  EXPECT_TRUE(result.complete);
  EXPECT_EQ(result.realizations, 20u);
  EXPECT_EQ(result.tally.positions_received, positions_expected(configuration_.run, 20));
  EXPECT_EQ(result.tally.attempts, 1u);
}

TEST_F(RunStatisticsTest, OfSeveralThreadsEqualThoseOfAMonteCarloToTheBit) {
  configuration_.run.followers = 5;
  configuration_.run.steps = 40;
  configuration_.run.realizations = 400;
  configuration_.run.signals = {"gap", "speed", "jerk"};
  std::mutex mutex;
  RunStatistics statistics(configuration_, std::nullopt);
  const BatchSchedule schedule = configuration_.run.schedule();
  const auto receive_vehicles = [&](std::size_t first_vehicle) {
    for (std::uint64_t first = 0; !schedule.is_complete(first); first = schedule.next(first)) {
      const BatchPositions all = positions_of(first, configuration_.run.steps);
      for (std::int64_t k = kInitialStep; k < configuration_.run.steps; ++k) {
        for (std::size_t i = first_vehicle; i <= configuration_.run.followers; i += 2) {
          std::unique_lock<std::mutex> lock(mutex);
          const MessageDescriptor descriptor{{1, first, k}, all.at(i, k)->size(), true};
          const SignalAssembly::Receipt receipt = statistics.receive(i, descriptor, all.at(i, k));
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
  expect_monte_carlo(statistics, 400);
  expect_same_gaps(statistics.result(true).gaps, monte_carlo_of(400).gaps);
  EXPECT_EQ(statistics.result(true).signals.size(), 3u);
  EXPECT_EQ(statistics.tally().positions_received, positions_expected(configuration_.run, 400));
}

TEST_F(RunStatisticsTest, CommitABatchWithTheLastResultThatIsSettled) {
  const BatchPositions all = positions_of(0, 3);
  RunStatistics statistics(configuration_, std::nullopt);
  std::array<std::vector<std::vector<ReducedSignals>>, 3> computed;  // by vehicle and message
  for (std::int64_t k = -1; k <= 2; ++k) {
    for (std::size_t i = 0; i <= 2; ++i)
      computed[i].push_back(statistics.compute(statistics.receive(i, {{1, 0, k}, 8, true}, all.at(i, k)).due));
  }
  EXPECT_TRUE(statistics.averages().empty());
  // Vehicle 2 first: its messages are in order, independent of the others.
  for (const std::size_t vehicle : {2, 0, 1}) {
    for (std::int64_t k = -1; k <= 2; ++k) {
      const std::vector<ReducedSignals>& signals = computed[vehicle][static_cast<std::size_t>(k + 1)];
      EXPECT_EQ(statistics.settle(vehicle, {{1, 0, k}, 8, true}, signals), vehicle == 1 && k == 2);
    }
  }
  expect_monte_carlo(statistics, 8);
}

TEST_F(RunStatisticsTest, IgnoreAnAttemptThatEndsWhileItsErrorsAreFormed) {
  const BatchPositions all = positions_of(0, 3);
  RunStatistics statistics(configuration_, std::nullopt);
  for (std::size_t i = 0; i <= 2; ++i) {
    for (std::int64_t k = -1; k <= 2; ++k) {
      const MessageDescriptor descriptor{{1, 0, k}, 8, true};
      const SignalAssembly::Receipt receipt = statistics.receive(i, descriptor, all.at(i, k));
      EXPECT_EQ(receipt.drop, DropReason::none);
      if (i == 2 && k == 2) {
        EXPECT_EQ(take(statistics, 0, {2, 0, -1}, all.at(0, -1)), DropReason::none);
      }
      EXPECT_FALSE(statistics.settle(i, descriptor, statistics.compute(receipt.due)));
    }
  }
  EXPECT_TRUE(statistics.averages().empty());
  EXPECT_EQ(statistics.tally().positions_received, 0u);
  for (std::size_t i = 0; i <= 2; ++i) {
    for (std::int64_t k = i == 0 ? 0 : -1; k <= 2; ++k)
      EXPECT_EQ(take(statistics, i, {2, 0, k}, all.at(i, k)), DropReason::none);
  }
  EXPECT_EQ(statistics.averages().realizations(), 8u);
  expect_monte_carlo(statistics, 8);
}

TEST_F(RunStatisticsTest, NumberTheAttemptsOfAnotherLaunchFromOne) {
  RunStatistics before(configuration_, std::nullopt);
  receive_batch(before, 22, 0);
  configuration_.run.launch_id = "the next launch";
  RunStatistics after(configuration_, before.checkpoint());
  EXPECT_EQ(after.arrivals().attempt(), 0u);
  receive_batch(after, 1, 8);
  EXPECT_EQ(after.tally().attempts, 1u);
  expect_monte_carlo(after, 16);
}

TEST_F(RunStatisticsTest, IgnoreAnUnfinishedBatch) {
  RunStatistics statistics(configuration_, std::nullopt);
  receive_batch(statistics, 1, 0);
  receive_batch(statistics, 1, 8, 1);
  expect_monte_carlo(statistics, 8);
  receive_batch(statistics, 4, 8);
  expect_monte_carlo(statistics, 16);
  EXPECT_EQ(statistics.tally().positions_received, positions_expected(configuration_.run, 16));
  EXPECT_EQ(statistics.tally().attempts, 4u);
}

TEST_F(RunStatisticsTest, ContinueFromTheirCheckpointToTheSameBits) {
  RunStatistics before(configuration_, std::nullopt);
  receive_batch(before, 3, 0);
  const Checkpoint checkpoint = before.checkpoint();
  EXPECT_EQ(checkpoint.launch_id, "this launch");
  EXPECT_EQ(checkpoint.identity, statistics_identity(configuration_));
  RunStatistics after(configuration_, checkpoint);
  EXPECT_EQ(after.averages().realizations(), 8u);
  EXPECT_EQ(after.arrivals().committed(), 8u);
  EXPECT_EQ(after.arrivals().attempt(), 3u);
  receive_batch(after, 4, 8);
  receive_batch(after, 4, 16);
  expect_monte_carlo(after, 20);
  EXPECT_EQ(after.tally().positions_received, positions_expected(configuration_.run, 20));
}

}  // namespace
}  // namespace platoon
