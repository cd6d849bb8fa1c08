#include <gtest/gtest.h>

#include <limits>

#include "stochastic_platoon/math/string/settling_time.hpp"
#include "unit/run/results/run_statistics_fixture.hpp"

namespace platoon {
namespace {

/// An endless run with a burn-in of 30 steps.
class EndlessRunStatisticsTest : public RunStatisticsTest {
protected:
  EndlessRunStatisticsTest() {
    configuration_.run.steps = 0;
    configuration_.run.realizations = configuration_.run.batch = 1;
    configuration_.run.burn_in = 30;
  }
};

TEST_F(EndlessRunStatisticsTest, AreAveragesOverTimeBehindTheBurnIn) {
  RunStatistics statistics(configuration_, std::nullopt);
  EXPECT_TRUE(statistics.averages().empty());
  receive_batch(statistics, 1, 0, 49);
  EXPECT_EQ(statistics.result(false).last_step, 49);
  EXPECT_EQ(statistics.averages().realizations(), 1u);
  const BatchPositions all = positions_of(0, 50);
  const Signal error = tracking_error(configuration_.model, 1);
  std::vector<Moments> expected(2);
  for (std::size_t i = 1; i <= 2; ++i) {
    for (std::int64_t k = 30; k < 50; ++k) {
      expected[i - 1].add(error({all.at(i - 1, k)->front()}, {all.at(i, k)->front(), all.at(i, k - 1)->front()}));
    }
  }
  expect_same_bits(statistics.averages().moments(), expected);
  EXPECT_EQ(statistics.tally().positions_received, 3u * 51u);
}

// A leader at another position that moves like the model's departs from the model only at the jump.
TEST_F(EndlessRunStatisticsTest, LeaveOutAManoeuvreOfTheLeader) {
  RunStatistics undisturbed(configuration_, std::nullopt), statistics(configuration_, std::nullopt);
  const BatchPositions all = positions_of(0, 160);
  constexpr std::int64_t kJump = 60;
  for (std::int64_t k = kInitialStep; k < 160; ++k) {
    for (std::size_t i = 0; i < all.vehicles(); ++i) {
      ASSERT_EQ(take(undisturbed, i, {1, 0, k}, all.at(i, k)), DropReason::none);
      const double moved = k >= kJump ? 2.5 : 0.0;
      const auto elsewhere = std::make_shared<const std::vector<double>>(1, all.at(i, k)->front() + moved);
      ASSERT_EQ(take(statistics, i, {1, 0, k}, elsewhere), DropReason::none);
      if (i == 0) {
        EXPECT_EQ(statistics.result(false).manoeuvre, k == kJump || k == kJump + 1) << k;
      }
    }
    // At step 20 nothing is counted yet; at step 80 the averages have paused at the jump.
    const std::int64_t before = k < 30 ? -1 : kJump - 1;
    if (k == 20 || k == 80) {
      EXPECT_EQ(statistics.result(false).last_steps, (std::vector<std::int64_t>{before, k < 30 ? -1 : kJump})) << k;
      EXPECT_EQ(statistics.result(false).last_step, k);
    }
  }
  EXPECT_FALSE(undisturbed.leader_departs());
  EXPECT_EQ(undisturbed.averages().moments()[0].count, 130u);
  EXPECT_EQ(statistics.averages().moments()[0].count, 130u - 31u);  // steps 60 .. 90
  EXPECT_EQ(statistics.averages().moments()[1].count, 130u - 31u);  // 61 .. 91
  EXPECT_EQ(undisturbed.result(false).counted_from, 30);
  EXPECT_EQ(statistics.result(false).counted_from, 92);
}

TEST_F(EndlessRunStatisticsTest, AgreeWithoutNoiseButForTheRestOfTheStart) {
  configuration_.model.default_vehicle().position().noise_variance = 0.0;
  const std::int64_t needed = *settling_steps(configuration_.model, 2);
  configuration_.run.burn_in = needed;
  const Prediction prediction = predict(configuration_);
  const auto agreement = [&](std::int64_t burn_in) {
    configuration_.run.burn_in = burn_in;
    RunStatistics statistics(configuration_, std::nullopt);
    receive_batch(statistics, 1, 0, burn_in + 3000);
    EXPECT_GT(statistics.averages().moments()[1].variance(), 0.0);
    return measured_agreement(configuration_.run, prediction, statistics.result(false))->max_abs_z_variance;
  };
  EXPECT_EQ(agreement(needed), 0.0);
  EXPECT_EQ(agreement(needed / 3), std::numeric_limits<double>::infinity());
}

TEST_F(EndlessRunStatisticsTest, ContinueWithANewAttemptBehindItsOwnBurnIn) {
  RunStatistics statistics(configuration_, std::nullopt);
  receive_batch(statistics, 1, 0, 49);
  EXPECT_EQ(statistics.result(false).last_steps, (std::vector<std::int64_t>{49, 49}));
  receive_batch(statistics, 2, 0, 39);
  EXPECT_EQ(statistics.result(false).last_step, 39);
  EXPECT_EQ(statistics.averages().moments()[0].count, 20u + 10u);
  EXPECT_EQ(statistics.tally().positions_received, 3u * (51u + 41u));
  EXPECT_EQ(statistics.result(false).last_steps, (std::vector<std::int64_t>{39, 39}));
}

TEST_F(EndlessRunStatisticsTest, ContinueFromTheirCheckpointAndCountItsAttempts) {
  RunStatistics before(configuration_, std::nullopt);
  receive_batch(before, 3, 0, 49);
  configuration_.run.launch_id = "the next launch";
  RunStatistics after(configuration_, before.checkpoint());
  EXPECT_FALSE(after.averages().empty());
  EXPECT_EQ(after.arrivals().attempt(), 3u);  // each attempt is another realization
  receive_batch(after, 4, 0, 39);
  EXPECT_EQ(after.averages().moments()[1].count, 20u + 10u);
}

}  // namespace
}  // namespace platoon
