#include "stochastic_platoon/run/report/prediction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/run/report/plausibility.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/messages.hpp"
#include "unit/paper_run.hpp"

namespace platoon {
namespace {

class PredictionTest : public testing::Test {
protected:
  Configuration configuration_ = paper_run("");
};

TEST_F(PredictionTest, HasTheTheoryOfEveryCell) {
  const Prediction prediction = predict(configuration_);
  const SignalMoments moments = error_moments(configuration_.model, 2, 3);
  EXPECT_EQ(prediction.mean, moments.mean);
  EXPECT_EQ(prediction.variance, moments.variance);
  ASSERT_EQ(prediction.stationary_variance.size(), 2u);
  EXPECT_NEAR(prediction.stability.spectral_radius, 0.5274, 0.00005);
}

TEST_F(PredictionTest, OfAnEndlessRunIsStationary) {
  configuration_.run.steps = 0;
  const Prediction prediction = predict(configuration_);
  EXPECT_EQ(prediction.mean, (std::vector<double>{0.0, 0.0}));
  EXPECT_EQ(prediction.variance, prediction.stationary_variance);
  EXPECT_EQ(prediction.rounding, (std::vector<double>{0.0, 0.0})) << "noise has standard errors";
  configuration_.model.default_vehicle().position().noise_variance = 0.0;
  for (const double rest : predict(configuration_).rounding) EXPECT_TRUE(rest > 0.0 && rest < 1e-3) << rest;
}

TEST_F(PredictionTest, FollowsTheRecordedLeaderOfTheModel) {
  const Prediction behind_profile = predict(configuration_);
  configuration_.model.recorded_leader = {0.0, 1.0, 2.0, 3.0};
  const Prediction behind_recording = predict(configuration_);
  EXPECT_NE(behind_recording.mean, behind_profile.mean);
  for (std::size_t c = 0; c < behind_profile.variance.size(); ++c)
    EXPECT_NEAR(behind_recording.variance[c], behind_profile.variance[c], 1e-12) << c;
}

TEST_F(PredictionTest, EndsBeforeTheFirstExternalVehicle) {
  const Prediction whole = predict(configuration_);
  configuration_.run.external = {2};
  for (const std::int64_t steps : {std::int64_t{3}, std::int64_t{0}}) {
    configuration_.run.steps = steps;
    const Prediction prediction = predict(configuration_);
    EXPECT_TRUE(prediction.has_theory());
    EXPECT_EQ(prediction.followers_with_theory, 1u);
    const std::size_t per_follower = steps == 0 ? 1 : 3;
    for (std::size_t c = 0; c < per_follower; ++c) {
      EXPECT_TRUE(std::isfinite(prediction.variance[c]));
      if (steps > 0) {
        EXPECT_EQ(prediction.variance[c], whole.variance[c]);
      }
      EXPECT_TRUE(std::isnan(prediction.mean[per_follower + c]));
      EXPECT_TRUE(std::isnan(prediction.variance[per_follower + c]));
    }
    EXPECT_EQ(prediction.stationary_variance[0], whole.stationary_variance[0]);
    EXPECT_TRUE(std::isnan(prediction.stationary_variance[1]));
    EXPECT_FALSE(prediction.stability.limit_variance) << "the string continues with another vehicle";
    EXPECT_TRUE(
        contains(prediction.stability.reason, "; this speaks of follower 1, before vehicle_2, which is external"));
  }
}

TEST_F(PredictionTest, OfASteadyStartBehindALossyRadioIsRelativeToItsMotion) {
  configuration_.model = radio_platoon(0.7, 0.01, 0.02);
  configuration_.model.start = Start::steady;
  configuration_.model.default_vehicle().position().link.delay = 2;
  lose_inputs(configuration_.model, 0.2, {1.0});
  const Prediction prediction = predict(configuration_);
  const double lag = 2.0 * configuration_.model.sample_period * configuration_.model.leader.speed(0);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(prediction.mean[3 * i], lag, 1e-12) << "as before step -1";
  EXPECT_EQ(prediction.mean, error_moments(configuration_.model, 2, 3).mean);
  EXPECT_EQ(prediction.fourth_cumulant.size(), prediction.mean.size());
}

TEST_F(PredictionTest, OfLossesInBurstsIsExactWithAVerdictOfTheMeans) {
  configuration_.model.default_vehicle().position().link.loss = LossModel{0.1, 2.0, {1.0}};
  const Prediction prediction = predict(configuration_);
  EXPECT_TRUE(prediction.has_theory());
  EXPECT_EQ(prediction.variance, error_moments(configuration_.model, 2, 3).variance);
  EXPECT_TRUE(prediction.fourth_cumulant.empty());
  EXPECT_TRUE(contains(prediction.warning, "losses in bursts: the theory has means and variances"));
  EXPECT_TRUE(contains(prediction.warning, "the means alone are judged"));
  EXPECT_TRUE(prediction.means_only);
  configuration_.run.steps = 0;
  configuration_.run.burn_in = 1000000;
  const Prediction over_time = predict(configuration_);
  EXPECT_EQ(over_time.variance, over_time.stationary_variance);
  EXPECT_NEAR(over_time.mean[0], 0.4, 1e-12);
  EXPECT_TRUE(over_time.error_correlation.empty());
  EXPECT_EQ(over_time.warning, "");
}

TEST_F(PredictionTest, OfLostPositionsAfterASteadyStartNamesThem) {
  configuration_.model.default_vehicle().position().link.loss = LossModel{0.1, {}, {1.0}};
  configuration_.model.start = Start::steady;
  EXPECT_TRUE(contains(predict(configuration_).warning, "lost positions after a steady start: the theory has"));
}

TEST_F(PredictionTest, OfMoreStepsThanTheMomentsOfBurstsTakeNamesTheLimit) {
  configuration_.model.default_vehicle().position().link.loss = LossModel{0.1, 2.0, {1.0}};
  configuration_.run.steps = 2001;
  EXPECT_EQ(
      predict(configuration_).stability.reason,
      "none, as the exact moments of losses in bursts take the square of the 2001 steps, and at most 2000 for these vehicles");
}

TEST_F(PredictionTest, DoesNotExistBehindAnExternalVehicle) {
  configuration_.run.external = {1};
  const Prediction prediction = predict(configuration_);
  EXPECT_FALSE(prediction.has_theory());
  EXPECT_EQ(prediction.followers_with_theory, 0u);
  EXPECT_TRUE(std::isnan(prediction.variance[0]));
  EXPECT_EQ(prediction.stability.reason, "none, as vehicle_1, which the others follow, is external");
}

// Lost positions lack what the leader drove; a change of speed behind the run is none of it.
TEST_F(PredictionTest, IsStationaryAtTheSpeedOfTheLastStepOfTheRun) {
  configuration_.model = with_loss(with_loss_stage(configuration_.model), 0.1);
  configuration_.run.steps = 50;
  const auto at = [this](std::vector<SpeedChange> changes) {
    configuration_.model.leader = LeaderProfile(std::move(changes), configuration_.model.sample_period);
    return predict(configuration_);
  };
  const Prediction steady = at({{0, 20.0}}), later = at({{0, 20.0}, {49, 0.0}}), within = at({{0, 20.0}, {48, 0.0}});
  EXPECT_EQ(later.stationary_variance, steady.stationary_variance);
  EXPECT_EQ(later.stability.limit_variance, steady.stability.limit_variance);
  EXPECT_LT(within.stationary_variance[0], 0.9 * steady.stationary_variance[0]);
  const double period = configuration_.model.sample_period;
  for (int k = -1; k < 200; ++k)
    configuration_.model.recorded_leader.push_back(20.0 * period * std::min(static_cast<double>(k), 49.0));
  EXPECT_NEAR(predict(configuration_).stationary_variance[0] / steady.stationary_variance[0], 1.0, 1e-9);
}

TEST_F(PredictionTest, WarnsByTheWholeTheoryOfTheRunUpToTheFirstExternalVehicle) {
  configuration_.model = radio_platoon(0.5, 1e-6, 1e-6);
  lose_inputs(configuration_.model, 0.3, {1.0});
  for (VehicleType& type : configuration_.model.types) type.vehicle.inputs.back().link.loss->mean_burst = 3.0;
  RunOptions& run = configuration_.run;
  run.followers = 3;
  run.steps = 300;
  configuration_.model.leader = LeaderProfile({{0, 20.0}, {100, 60.0}}, configuration_.model.sample_period);
  const auto speaks_of_a_late_step = [](const std::vector<std::string>& warnings) {
    return std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
      return warning.rfind("acceleration:", 0) == 0 && contains(warning, "(step 26");
    });
  };
  EXPECT_FALSE(speaks_of_a_late_step(plausibility_warnings(configuration_))) << "of the first steps alone";
  EXPECT_TRUE(speaks_of_a_late_step(predict(configuration_).warnings));
  run.signals = {"speed", "acceleration"};
  EXPECT_TRUE(speaks_of_a_late_step(predict(configuration_).warnings));
  run.signals.clear();
  run.external = {1};
  EXPECT_TRUE(predict(configuration_).warnings.empty());
}

}  // namespace
}  // namespace platoon
