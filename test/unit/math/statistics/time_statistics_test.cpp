#include "stochastic_platoon/math/statistics/time_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace platoon {
namespace {

void add(TimeStatistics& statistics, std::size_t follower, std::int64_t step, double error) {
  statistics.add({follower, step, 0, 1, {std::vector<MomentNode>{{error, 0.0}}}});
}

TEST(TimeStatistics, LeaveTheBurnInOut) {
  TimeStatistics statistics(1, 10);
  for (std::int64_t k = 0; k < 14; ++k) add(statistics, 1, k, k < 10 ? 1e6 : static_cast<double>(k));
  EXPECT_EQ(statistics.moments()[0].count, 4u);
  EXPECT_DOUBLE_EQ(statistics.moments()[0].mean, 11.5);
  EXPECT_DOUBLE_EQ(statistics.moments()[0].variance(), 5.0 / 3.0);
}

TEST(TimeStatistics, WithoutBurnInTakeEveryStep) {
  TimeStatistics statistics(1, 0);
  add(statistics, 1, 0, 3.0);
  EXPECT_EQ(statistics.moments()[0].count, 1u);
}

TEST(TimeStatistics, AreUndefinedDuringTheBurnIn) {
  TimeStatistics statistics(1, 10);
  add(statistics, 1, 9, 3.0);
  EXPECT_EQ(statistics.moments()[0].count, 0u);
  EXPECT_TRUE(std::isnan(statistics.moments()[0].variance()));
}

TEST(TimeStatistics, KeepFollowersApart) {
  TimeStatistics statistics(3, 0);
  add(statistics, 1, 0, 1.0);
  add(statistics, 3, 0, 5.0);
  add(statistics, 3, 1, 7.0);
  ASSERT_EQ(statistics.moments().size(), 3u);
  EXPECT_EQ(statistics.moments()[0].mean, 1.0);
  EXPECT_EQ(statistics.moments()[1].count, 0u);
  EXPECT_EQ(statistics.moments()[2].mean, 6.0);
  EXPECT_THROW(add(statistics, 4, 0, 1.0), std::out_of_range);
  EXPECT_THROW(add(statistics, 0, 0, 1.0), std::out_of_range);
}

TEST(TimeStatistics, HaveTheSameBitsForAnyOrderOfTheSteps) {
  TimeStatistics in_order(1, 2), shuffled(1, 2);
  const auto error = [](std::int64_t k) { return 1.0 / static_cast<double>(3 + k * k % 17); };
  for (std::int64_t k = 0; k < 40; ++k) add(in_order, 1, k, error(k));
  for (std::int64_t k = 0; k < 40; k += 4) {
    for (const std::int64_t j : {2, 0, 3, 1}) add(shuffled, 1, k + j, error(k + j));
  }
  EXPECT_EQ(shuffled.moments()[0].count, 38u);
  EXPECT_EQ(shuffled.moments()[0].mean, in_order.moments()[0].mean);
  EXPECT_EQ(shuffled.moments()[0].squared_deviations, in_order.moments()[0].squared_deviations);
}

TEST(TimeStatistics, WaitForAMissingStep) {
  TimeStatistics statistics(1, 0);
  EXPECT_TRUE(statistics.empty());
  add(statistics, 1, 1, 5.0);
  EXPECT_TRUE(statistics.empty());
  add(statistics, 1, 0, 3.0);
  EXPECT_EQ(statistics.last_step(1), 1);
  EXPECT_EQ(statistics.moments()[0].mean, 4.0);
}

TEST(TimeStatistics, ContinueAfterARestartWithTheSameBurnIn) {
  TimeStatistics statistics(2, 5);
  for (std::int64_t k = 0; k < 8; ++k) add(statistics, 2, k, 4.0);
  statistics.restart();
  EXPECT_EQ(statistics.last_step(2), -1);
  EXPECT_FALSE(statistics.empty());
  ASSERT_EQ(statistics.moments().size(), 2u);
  EXPECT_EQ(statistics.moments()[1].count, 3u);
  for (std::int64_t k = 0; k < 6; ++k) add(statistics, 2, k, 9.0);
  EXPECT_EQ(statistics.moments()[1].count, 4u);
  EXPECT_DOUBLE_EQ(statistics.moments()[1].mean, (3.0 * 4.0 + 9.0) / 4.0);
  EXPECT_EQ(statistics.last_step(1), -1);
  EXPECT_EQ(statistics.last_step(2), 5);
  for (std::int64_t k = 0; k < 3; ++k) add(statistics, 1, k, 9.0);
  EXPECT_EQ(statistics.last_step(1), 2);
}

TEST(TimeStatistics, EqualThoseOfTheWholeSampleAfterInterruptions) {
  TimeStatistics broken(1, 0);
  Moments expected;
  for (std::int64_t k = 0; k < 20; ++k) {
    const double error = std::sin(static_cast<double>(k));
    if (k % 7 == 0) broken.restart();
    add(broken, 1, k % 7, error);
    expected.add(error);
  }
  EXPECT_EQ(broken.moments()[0].count, 20u);
  EXPECT_NEAR(broken.moments()[0].mean, expected.mean, 1e-15);
  EXPECT_NEAR(broken.moments()[0].variance(), expected.variance(), 1e-15);
}

TEST(TimeStatistics, ContinueEarlierAverages) {
  TimeStatistics statistics(1, 1, {Moments{2, 5.0, 8.0}});
  EXPECT_FALSE(statistics.empty());
  add(statistics, 1, 0, 100.0);
  add(statistics, 1, 1, 8.0);
  EXPECT_EQ(statistics.moments()[0].count, 3u);
  EXPECT_DOUBLE_EQ(statistics.moments()[0].mean, 6.0);
}

// The leader's step a reaches follower i at its step a + i - 1.
TEST(TimeStatistics, LeaveOutAManoeuvreAndABurnInBehindIt) {
  constexpr std::int64_t kBurnIn = 5, kFrom = 20, kTo = 29;
  for (const std::size_t follower : {1, 2, 4}) {
    TimeStatistics statistics(4, kBurnIn);
    statistics.saw_leader(-2, true);
    const auto hops = static_cast<std::int64_t>(follower) - 1;
    Moments expected;
    for (std::int64_t k = 0; k < 60; ++k) {
      add(statistics, follower, k, static_cast<double>(k * k % 31));
      statistics.saw_leader(k - hops, k - hops < kFrom || k - hops > kTo);
      const bool counts = k >= kBurnIn && (k < kFrom + hops || k > kTo + hops + kBurnIn);
      if (counts) expected.add(static_cast<double>(k * k % 31));
      ASSERT_EQ(statistics.moments()[follower - 1].count, expected.count) << k;
      const std::int64_t end = std::min(k - hops, kTo);  // of the manoeuvre, as far as it is reported
      ASSERT_EQ(statistics.counted_from(), end < kFrom ? kBurnIn : end + 1 + kBurnIn + 3) << k;
    }
    EXPECT_EQ(statistics.moments()[follower - 1].mean, expected.mean);
    EXPECT_EQ(statistics.moments()[follower - 1].squared_deviations, expected.squared_deviations);
  }
}

TEST(TimeStatistics, WaitForTheStepOfTheLeaderThatAnErrorDependsOn) {
  TimeStatistics statistics(3, 0);
  statistics.saw_leader(-2, true);
  for (std::int64_t k = 0; k < 8; ++k) add(statistics, 3, k, 1.0);
  EXPECT_EQ(statistics.moments()[2].count, 1u);  // step 0 depends on the leader's step -2
  statistics.saw_leader(3, true);
  EXPECT_EQ(statistics.moments()[2].count, 6u);
  statistics.saw_leader(4, false);
  EXPECT_EQ(statistics.moments()[2].count, 6u);
  statistics.restart();
  for (std::int64_t k = 0; k < 3; ++k) add(statistics, 3, k, 1.0);
  statistics.saw_leader(2, true);
  EXPECT_EQ(statistics.moments()[2].count, 9u);
}

Moments moments_of(const std::vector<double>& values) {
  Moments all;
  for (const double value : values) all.add(value);
  return all;
}

TEST(TimeStatistics, AreProvisionalUntilTheBurnInIsOverAndForgetTheStart) {
  TimeStatistics statistics(2, 10);
  EXPECT_TRUE(statistics.provisional().empty());
  for (std::int64_t k = 0; k < 10; ++k) add(statistics, 1, k, k < 3 ? 1e6 : static_cast<double>(k));
  ASSERT_EQ(statistics.provisional().size(), 2u);
  const Moments expected = moments_of({3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0});
  EXPECT_EQ(statistics.provisional()[0].count, 7u);
  EXPECT_DOUBLE_EQ(statistics.provisional()[0].mean, expected.mean);
  EXPECT_DOUBLE_EQ(statistics.provisional()[0].variance(), expected.variance());
  EXPECT_EQ(statistics.provisional()[1].count, 0u);
  EXPECT_EQ(statistics.moments()[0].count, 0u);
  add(statistics, 1, 10, 4.0);
  EXPECT_TRUE(statistics.provisional().empty());
  add(statistics, 2, 0, 5.0);
  EXPECT_EQ(statistics.provisional()[0].count, 0u);  // its average has begun
  EXPECT_EQ(statistics.provisional()[1].mean, 5.0);
  EXPECT_EQ(statistics.moments()[0].mean, 4.0);
}

TEST(TimeStatistics, HaveProvisionalMomentsOfHalfTheStepsAtLeast) {
  TimeStatistics statistics(1, 1000);
  for (std::int64_t k = 0; k < 1000; ++k) {
    add(statistics, 1, k, static_cast<double>(k));
    const Moments of = statistics.provisional()[0];
    ASSERT_GE(2 * of.count, static_cast<std::uint64_t>(k));
    // The latest ones: k - count + 1 .. k.
    ASSERT_NEAR(of.mean, static_cast<double>(k) - 0.5 * static_cast<double>(of.count - 1), 1e-9) << k;
  }
}

TEST(TimeStatistics, LeaveAManoeuvreOutOfTheProvisionalMoments) {
  for (const std::size_t follower : {1, 3}) {
    TimeStatistics statistics(3, 50);
    statistics.saw_leader(-2, true);
    const auto hops = static_cast<std::int64_t>(follower) - 1;
    for (std::int64_t k = 0; k < 40; ++k) {
      const bool manoeuvre = k - hops >= 10 && k - hops < 20;
      add(statistics, follower, k, manoeuvre ? 1e6 : 1.0);
      statistics.saw_leader(k - hops, !manoeuvre);
      ASSERT_LE(statistics.provisional()[follower - 1].mean, 1.0) << k;
    }
    EXPECT_GE(statistics.provisional()[follower - 1].count, 15u);
  }
}

TEST(TimeStatistics, AreNotProvisionalBehindEarlierAveragesAndBeginAgainWithARestart) {
  TimeStatistics earlier(1, 10, {Moments{2, 5.0, 8.0}}), restarted(1, 10);
  add(earlier, 1, 0, 1.0);
  EXPECT_TRUE(earlier.provisional().empty());
  add(restarted, 1, 0, 1.0);
  restarted.restart();
  EXPECT_TRUE(restarted.provisional().empty());
  add(restarted, 1, 0, 3.0);
  EXPECT_EQ(restarted.provisional()[0].mean, 3.0);
}

// The next value of x(k) = 0.9 x(k-1) + n(k).
class Correlated {
public:
  explicit Correlated(unsigned seed) : random_(seed) {}
  double next() { return value_ = 0.9 * value_ + normal_(random_); }

private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  double value_ = 0.0;
};

TEST(TimeStatistics, MeasureTheirStandardErrors) {
  constexpr unsigned kRuns = 400;
  Moments means, variances, errors_of_mean, errors_of_variance;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    TimeStatistics statistics(1, 50);
    Correlated sequence(seed);
    for (std::int64_t k = 0; k < 5050; ++k) add(statistics, 1, k, sequence.next());
    const Moments of = statistics.moments()[0];
    const IndependentShare share = statistics.shares()[0];
    ASSERT_EQ(of.count, 5000u);
    EXPECT_TRUE(std::isnan(share.expected));
    means.add(of.mean);
    variances.add(of.variance());
    errors_of_mean.add(std::pow(standard_error_of_mean(of.variance(), of.count, share.mean), 2));
    errors_of_variance.add(std::pow(standard_error_of_variance(of.variance(), of.count, share.variance), 2));
  }
  // The scatter of 400 runs has a relative standard error of sqrt(2 / 400) = 7 %; an independent share would be wrong
  // by factors of 19 and 9.5.
  EXPECT_NEAR(errors_of_mean.mean / means.variance(), 1.0, 0.25);
  EXPECT_NEAR(errors_of_variance.mean / variances.variance(), 1.0, 0.25);
}

TEST(TimeStatistics, HaveNoStandardErrorsForFewOrStronglyCorrelatedSteps) {
  TimeStatistics few(1, 0), drifting(1, 0);
  for (std::int64_t k = 0; k < 31; ++k) add(few, 1, k, static_cast<double>(k % 5));
  for (std::int64_t k = 0; k < 5000; ++k) add(drifting, 1, k, static_cast<double>(k));
  EXPECT_TRUE(std::isnan(few.shares()[0].variance));
  EXPECT_TRUE(std::isnan(drifting.shares()[0].mean));
  EXPECT_TRUE(std::isnan(drifting.shares()[0].variance));
}

TEST(TimeStatistics, MeasureTheSameSharesOverARestart) {
  TimeStatistics whole(1, 0), restarted(1, 0);
  Correlated first(7), second(7);
  for (std::int64_t k = 0; k < 4000; ++k) add(whole, 1, k, first.next());
  for (std::int64_t k = 0; k < 1000; ++k) add(restarted, 1, k, second.next());
  restarted.restart();
  for (std::int64_t k = 0; k < 3000; ++k) add(restarted, 1, k, second.next());
  EXPECT_EQ(restarted.shares()[0].mean, whole.shares()[0].mean);
  EXPECT_EQ(restarted.shares()[0].variance, whole.shares()[0].variance);
}

}  // namespace
}  // namespace platoon
