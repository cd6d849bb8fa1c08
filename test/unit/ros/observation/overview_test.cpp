#include "stochastic_platoon/ros/observation/overview.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

Configuration long_run(std::size_t followers, std::int64_t steps) {
  Configuration configuration = paper_run("");
  configuration.run.followers = followers;
  configuration.run.steps = steps;
  if (steps == 0) configuration.run.burn_in = 200;
  return configuration;
}

TEST(SpreadSteps, AreAllOfFewAndSomeOfManyWithBothEnds) {
  EXPECT_EQ(spread_steps(1, 100), (std::vector<std::int64_t>{0}));
  EXPECT_EQ(spread_steps(4, 100), (std::vector<std::int64_t>{0, 1, 2, 3}));
  EXPECT_EQ(spread_steps(1001, 5), (std::vector<std::int64_t>{0, 250, 500, 750, 1000}));
  EXPECT_EQ(spread_steps(7, 2), (std::vector<std::int64_t>{0, 6}));
  EXPECT_THROW(spread_steps(0, 5), std::invalid_argument);
  EXPECT_THROW(spread_steps(5, 1), std::invalid_argument);
}

TEST(Overview, HasEachCellOfAShortRunInItsPlace) {
  const Configuration configuration = paper_run("");
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction, 0.5);
  result.tally.attempts = 3;
  result.counted_from = 17;
  result.manoeuvre = true;
  const auto overview = overview_of(configuration.run, prediction, result);
  EXPECT_EQ(overview.attempt, 3U);
  EXPECT_EQ(overview.counted_from, 17);
  EXPECT_TRUE(overview.manoeuvre);
  ASSERT_EQ(overview.step, (std::vector<std::int64_t>{0, 1, 2}));
  ASSERT_EQ(overview.variance.size(), 6U);
  for (std::size_t c = 0; c < 6; ++c) {
    EXPECT_EQ(overview.mean[c], result.moments[c].mean);
    EXPECT_EQ(overview.variance[c], result.moments[c].variance());
    EXPECT_EQ(overview.theoretical_mean[c], prediction.mean[c]);
    EXPECT_EQ(overview.theoretical_variance[c], prediction.variance[c]);
  }
  const Agreement found = *measured_agreement(configuration.run, prediction, result);
  EXPECT_EQ(overview.max_abs_z_mean, found.max_abs_z_mean);
  EXPECT_EQ(overview.max_abs_z_variance, found.max_abs_z_variance);
  EXPECT_EQ(overview.plausible_z, largest_plausible_score(12));
  EXPECT_TRUE(overview.complete);
  EXPECT_TRUE(overview.string_stable);
  EXPECT_EQ(overview.limit_variance, *prediction.stability.limit_variance);
}

TEST(Overview, HasStandardErrorAndScoreOfTheLastStep) {
  const Configuration configuration = paper_run("");
  const Prediction prediction = predict(configuration);
  const RunResult result = result_with(configuration, prediction, 0.5);
  const auto overview = overview_of(configuration.run, prediction, result);
  ASSERT_EQ(overview.standard_error.size(), 2U);
  for (std::size_t i = 1; i <= 2; ++i) {
    const std::size_t c = cell(i, 2, 3);
    EXPECT_EQ(overview.standard_error[i - 1], standard_error_of_variance(prediction.variance[c], 20));
    EXPECT_EQ(overview.variance_score[i - 1],
              scores({result.moments[c], prediction.mean[c], prediction.variance[c], prediction.rounding[c]}).variance);
  }
}

TEST(Overview, ThinsALongRunButKeepsTheLargestScoreOfAllItsCellsWhenItIsComplete) {
  const Configuration configuration = long_run(300, 200);
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction, 0.5);
  result.moments[cell(150, 100, 200)].mean += 100.0;  // step 100 is not among the columns
  auto overview = overview_of(configuration.run, prediction, result);
  EXPECT_EQ(overview.step.size(), 66U);  // 20000 cells
  EXPECT_EQ(overview.step.back(), 199);
  EXPECT_EQ(overview.variance.size(), 300U * 66U);
  EXPECT_EQ(overview.variance.back(), result.moments.back().variance());
  EXPECT_GT(overview.max_abs_z_mean, 100.0);
  result.complete = false;
  overview = overview_of(configuration.run, prediction, result);
  EXPECT_LT(overview.max_abs_z_mean, 1.0);
  EXPECT_EQ(overview.plausible_z, largest_plausible_score(2 * 300 * 66));
}

TEST(Overview, OfARunOfWhichNothingIsMeasuredYetIsItsTheory) {
  for (const std::int64_t steps : {3, 0}) {
    const Configuration configuration = long_run(2, steps);
    const Prediction prediction = predict(configuration);
    const auto overview = overview_of(configuration.run, prediction, {});
    ASSERT_EQ(overview.mean.size(), prediction.mean.size());
    for (std::size_t c = 0; c < overview.mean.size(); ++c) {
      EXPECT_TRUE(std::isnan(overview.mean[c]));
      EXPECT_TRUE(std::isnan(overview.variance[c]));
      EXPECT_EQ(overview.theoretical_variance[c], prediction.variance[c]);
    }
    EXPECT_TRUE(std::isnan(overview.max_abs_z_mean));
    EXPECT_TRUE(overview.string_stable);
    EXPECT_FALSE(overview.complete);
  }
}

TEST(Overview, OfAveragesOverTimeHasOneColumn) {
  const Configuration configuration = long_run(2, 0);
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction, 0.5);
  result.last_step = 431;
  result.last_steps = {431, 430};
  const auto overview = overview_of(configuration.run, prediction, result);
  EXPECT_TRUE(overview.time_average);
  EXPECT_EQ(overview.step, (std::vector<std::int64_t>{431}));
  EXPECT_EQ(overview.variance.size(), 2U);
  const double share = prediction.error_correlation[1].of(result.moments[1].count, result.tally.attempts).variance;
  EXPECT_EQ(overview.standard_error[1],
            standard_error_of_variance(prediction.variance[1], result.moments[1].count, share));
  EXPECT_LT(overview.standard_error[0],
            2.0 * standard_error_of_variance(prediction.variance[0], result.moments[0].count));
  EXPECT_GT(overview.variance_score[1], 0.0);
  EXPECT_TRUE(std::isnan(overview.max_abs_z_mean)) << "of 20 steps nobody can say it";
}

TEST(Overview, OfAveragesOverManyStepsHasTheLargestScore) {
  const Configuration configuration = long_run(2, 0);
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction);
  result.last_steps = {9999, 9999};
  result.moments.assign(2, {10000, 0.0, 9999.0 * prediction.variance[0]});
  result.moments[1].squared_deviations = 9999.0 * 1.05 * prediction.variance[1];
  const auto overview = overview_of(configuration.run, prediction, result);
  EXPECT_EQ(overview.max_abs_z_mean, 0.0);
  EXPECT_EQ(overview.max_abs_z_variance, overview.variance_score[1]);
  EXPECT_EQ(overview.plausible_z, largest_plausible_score(4));
}

TEST(Overview, SaysHowManyRealizationsAVerdictNeedsWhereThereIsNone) {
  Configuration configuration = paper_run("");
  EXPECT_TRUE(std::isnan(overview_of(configuration.run, predict(configuration), {}).realizations_needed));
  configuration.model.default_vehicle().link.loss = LossModel{0.01, {}, {1.0}};
  const Prediction prediction = predict(configuration);
  RunResult result = result_with_fourth_moments(configuration, prediction, 0.5);
  const auto overview = overview_of(configuration.run, prediction, result);
  EXPECT_TRUE(std::isnan(overview.max_abs_z_variance));
  EXPECT_EQ(overview.realizations_needed, *realizations_needed(configuration.run, prediction, result));
  EXPECT_GT(overview.realizations_needed, 20.0);
  for (Moments& of : result.moments) {
    of.count *= 10000;
    of.squared_deviations *= 10000.0;
    of.fourth_deviations *= 10000.0;
  }
  result.realizations *= 10000;
  const auto later = overview_of(configuration.run, prediction, result);
  EXPECT_GT(later.plausible_z, largest_plausible_score(12));
  EXPECT_TRUE(std::isnan(later.realizations_needed));
  EXPECT_GT(later.variance_score[1], 1.0);
}

TEST(Overview, OfAveragesOverTimeOfAStringThatLosesHasNoStandardErrors) {
  Configuration configuration = long_run(2, 0);
  configuration.model.default_vehicle().link.loss = LossModel{0.1, {}, {1.0}};
  const Prediction prediction = predict(configuration);
  RunResult result = result_with(configuration, prediction);
  result.last_steps = {9999, 9999};
  result.moments.assign(2, {10000, 0.0, 9999.0});
  const auto overview = overview_of(configuration.run, prediction, result);
  EXPECT_TRUE(std::isnan(overview.standard_error[0]));
  EXPECT_TRUE(std::isnan(overview.variance_score[1]));
  EXPECT_TRUE(std::isnan(overview.max_abs_z_variance));
}

}  // namespace
}  // namespace platoon
