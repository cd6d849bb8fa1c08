#include "stochastic_platoon/ros/observation/overview.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

TEST(SpreadSteps, AreAllStepsOfAShortRunAndSomeOfALongOne) {
  EXPECT_EQ(spread_steps(1, 100), (std::vector<std::int64_t>{0}));
  EXPECT_EQ(spread_steps(4, 100), (std::vector<std::int64_t>{0, 1, 2, 3}));
  EXPECT_EQ(spread_steps(1001, 5), (std::vector<std::int64_t>{0, 250, 500, 750, 1000}));
  EXPECT_EQ(spread_steps(7, 2), (std::vector<std::int64_t>{0, 6}));
  EXPECT_THROW(spread_steps(0, 5), std::invalid_argument);
  EXPECT_THROW(spread_steps(5, 1), std::invalid_argument);
}

class OverviewTest : public ResultTest {
protected:
  void make_long(std::size_t followers, std::int64_t steps) {
    configuration_.run.followers = followers;
    configuration_.run.steps = steps;
    if (steps == 0) configuration_.run.burn_in = 200;
    predict_again();
  }

  auto overview(const RunResult& result) const { return overview_of(configuration_.run, prediction_, result); }

  /// Averages over ten thousand steps of two followers.
  RunResult averages(double variance) const {
    RunResult found = result();
    found.last_steps = {9999, 9999};
    found.moments.assign(2, {10000, 0.0, 9999.0 * variance});
    return found;
  }
};

TEST_F(OverviewTest, HasEveryCellOfAShortRun) {
  RunResult result = this->result();
  result.tally.attempts = 3;
  result.counted_from = 17;
  result.manoeuvre = true;
  const auto overview = this->overview(result);
  EXPECT_EQ(overview.attempt, 3U);
  EXPECT_EQ(overview.counted_from, 17);
  EXPECT_TRUE(overview.manoeuvre);
  ASSERT_EQ(overview.step, (std::vector<std::int64_t>{0, 1, 2}));
  ASSERT_EQ(overview.variance.size(), 6U);
  for (std::size_t c = 0; c < 6; ++c) {
    EXPECT_EQ(overview.mean[c], result.moments[c].mean);
    EXPECT_EQ(overview.variance[c], result.moments[c].variance());
    EXPECT_EQ(overview.theoretical_mean[c], prediction_.mean[c]);
    EXPECT_EQ(overview.theoretical_variance[c], prediction_.variance[c]);
  }
  const Agreement found = *measured_agreement(configuration_.run, prediction_, result);
  EXPECT_EQ(overview.max_abs_z_mean, found.max_abs_z_mean);
  EXPECT_EQ(overview.max_abs_z_variance, found.max_abs_z_variance);
  EXPECT_EQ(overview.plausible_z, largest_plausible_score(12));
  EXPECT_TRUE(overview.complete);
  EXPECT_TRUE(overview.string_stable);
  EXPECT_EQ(overview.limit_variance, *prediction_.stability.limit_variance);
}

TEST_F(OverviewTest, HasStandardErrorAndScoreOfTheLastStep) {
  const RunResult result = this->result();
  const auto overview = this->overview(result);
  ASSERT_EQ(overview.standard_error.size(), 2U);
  for (std::size_t i = 1; i <= 2; ++i) {
    const std::size_t c = cell(i, 2, 3);
    EXPECT_EQ(overview.standard_error[i - 1], standard_error_of_variance(prediction_.variance[c], 20));
    EXPECT_EQ(
        overview.variance_score[i - 1],
        scores({result.moments[c], prediction_.mean[c], prediction_.variance[c], prediction_.rounding[c]}).variance);
  }
}

TEST_F(OverviewTest, OfALongCompleteRunHasSomeCellsAndTheLargestScoreOfAll) {
  make_long(300, 200);
  RunResult result = this->result();
  result.moments[cell(150, 100, 200)].mean += 100.0;  // step 100 is not among the columns
  auto overview = this->overview(result);
  EXPECT_EQ(overview.step.size(), 66U);  // 20000 cells
  EXPECT_EQ(overview.step.back(), 199);
  EXPECT_EQ(overview.variance.size(), 300U * 66U);
  EXPECT_EQ(overview.variance.back(), result.moments.back().variance());
  EXPECT_GT(overview.max_abs_z_mean, 100.0);
  result.complete = false;
  overview = this->overview(result);
  EXPECT_LT(overview.max_abs_z_mean, 1.0);
  EXPECT_EQ(overview.plausible_z, largest_plausible_score(2 * 300 * 66));
}

TEST_F(OverviewTest, OfALongRunDoesNotScoreVariancesThatTheTheoryCannotJudge) {
  lose_packets({0.1, 2.0, {1.0}});
  make_long(300, 67);
  RunResult result = result_with_fourth_moments();
  for (const bool complete : {false, true}) {
    result.complete = complete;
    const auto overview = this->overview(result);
    EXPECT_EQ(overview.step.size(), 66U);
    EXPECT_TRUE(std::isfinite(overview.max_abs_z_mean));
    EXPECT_TRUE(std::isnan(overview.max_abs_z_variance)) << overview.max_abs_z_variance;
    for (const double score : overview.variance_score) ASSERT_TRUE(std::isnan(score)) << score;
  }
}

TEST_F(OverviewTest, HasTheTheoryBeforeTheFirstMeasurement) {
  for (const std::int64_t steps : {3, 0}) {
    make_long(2, steps);
    const auto overview = this->overview({});
    ASSERT_EQ(overview.mean.size(), prediction_.mean.size());
    for (std::size_t c = 0; c < overview.mean.size(); ++c) {
      EXPECT_TRUE(std::isnan(overview.mean[c]));
      EXPECT_TRUE(std::isnan(overview.variance[c]));
      EXPECT_EQ(overview.theoretical_variance[c], prediction_.variance[c]);
    }
    EXPECT_TRUE(std::isnan(overview.max_abs_z_mean));
    EXPECT_TRUE(overview.string_stable);
    EXPECT_FALSE(overview.complete);
  }
}

TEST_F(OverviewTest, OfAveragesOverTimeHasOneColumn) {
  make_long(2, 0);
  RunResult result = this->result();
  result.last_step = 431;
  result.last_steps = {431, 430};
  const auto overview = this->overview(result);
  EXPECT_TRUE(overview.time_average);
  EXPECT_EQ(overview.step, (std::vector<std::int64_t>{431}));
  EXPECT_EQ(overview.variance.size(), 2U);
  const double share = prediction_.error_correlation[1].of(result.moments[1].count, result.tally.attempts).variance;
  EXPECT_EQ(overview.standard_error[1],
            standard_error_of_variance(prediction_.variance[1], result.moments[1].count, share));
  EXPECT_LT(overview.standard_error[0],
            2.0 * standard_error_of_variance(prediction_.variance[0], result.moments[0].count));
  EXPECT_GT(overview.variance_score[1], 0.0);
  EXPECT_TRUE(std::isnan(overview.max_abs_z_mean)) << "20 steps are too few";
}

TEST_F(OverviewTest, HasProvisionalAveragesBesideNone) {
  make_long(2, 0);
  RunResult result;
  result.last_steps = {40, 40};
  result.provisional = {Moments{20, 0.1, 1.9}, Moments{}};
  const auto overview = this->overview(result);
  EXPECT_TRUE(std::isnan(overview.mean[0]));
  EXPECT_TRUE(std::isnan(overview.variance[0]));
  ASSERT_EQ(overview.provisional_mean.size(), 2U);
  EXPECT_EQ(overview.provisional_mean[0], 0.1);
  EXPECT_DOUBLE_EQ(overview.provisional_variance[0], 0.1);
  EXPECT_TRUE(std::isnan(overview.provisional_mean[1]));
  EXPECT_TRUE(std::isnan(overview.provisional_variance[1]));
  EXPECT_TRUE(this->overview(averages(1.0)).provisional_mean.empty());
}

TEST_F(OverviewTest, OfAveragesOverManyStepsHasTheLargestScore) {
  make_long(2, 0);
  RunResult result = averages(prediction_.variance[0]);
  result.moments[1].squared_deviations = 9999.0 * 1.05 * prediction_.variance[1];
  const auto overview = this->overview(result);
  EXPECT_EQ(overview.max_abs_z_mean, 0.0);
  EXPECT_EQ(overview.max_abs_z_variance, overview.variance_score[1]);
  EXPECT_EQ(overview.plausible_z, largest_plausible_score(4));
}

TEST_F(OverviewTest, HasTheRealizationsThatAVerdictNeeds) {
  EXPECT_TRUE(std::isnan(overview({}).realizations_needed));
  lose_packets({0.01, {}, {1.0}});
  RunResult result = result_with_fourth_moments();
  const auto overview = this->overview(result);
  EXPECT_TRUE(std::isnan(overview.max_abs_z_variance));
  EXPECT_EQ(overview.realizations_needed, *realizations_needed(configuration_.run, prediction_, result));
  EXPECT_GT(overview.realizations_needed, 20.0);
  for (Moments& of : result.moments) {
    of.count *= 10000;
    of.squared_deviations *= 10000.0;
    of.fourth_deviations *= 10000.0;
  }
  result.realizations *= 10000;
  const auto later = this->overview(result);
  EXPECT_GT(later.plausible_z, largest_plausible_score(12));
  EXPECT_TRUE(std::isnan(later.realizations_needed));
  EXPECT_GT(later.variance_score[1], 1.0);
}

TEST_F(OverviewTest, HasNoScoreOfFewQuantisedErrors) {
  configuration_.model.default_vehicle().position().link.quantisation_step = 0.5;
  predict_again();
  RunResult result = result_with_fourth_moments();
  for (const std::uint64_t count : {20u, 999u, 1000u}) {
    for (Moments& of : result.moments) {
      const double factor = static_cast<double>(count) / static_cast<double>(std::exchange(of.count, count));
      of.squared_deviations *= factor;
      of.fourth_deviations *= factor;
    }
    result.realizations = count;
    const auto overview = this->overview(result);
    EXPECT_EQ(std::isnan(overview.max_abs_z_variance), count < 1000) << count;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(std::isnan(overview.variance_score[i]), count < 1000) << count;
      EXPECT_GT(overview.standard_error[i], 0.0) << count;
    }
  }
}

TEST_F(OverviewTest, OfAveragesOverTimeHasNoStandardErrorsIfPacketsAreLost) {
  make_long(2, 0);
  lose_packets({0.1, {}, {1.0}});
  const auto overview = this->overview(averages(1.0));
  EXPECT_TRUE(std::isnan(overview.standard_error[0]));
  EXPECT_TRUE(std::isnan(overview.variance_score[1]));
  EXPECT_TRUE(std::isnan(overview.max_abs_z_variance));
}

}  // namespace
}  // namespace platoon
