#include "stochastic_platoon/analysis/prediction.hpp"

#include <gtest/gtest.h>

#include "../paper_run.hpp"
#include "stochastic_platoon/theory/error_moments.hpp"

namespace platoon {
namespace {

TEST(Prediction, IsTheTheoryOfEveryCell) {
  const Configuration configuration = paper_run("");
  const Prediction prediction = predict(configuration);
  const ErrorMoments moments = error_moments(configuration.model, 2, 3);
  EXPECT_EQ(prediction.mean, moments.mean);
  EXPECT_EQ(prediction.variance, moments.variance);
  ASSERT_EQ(prediction.stationary_variance.size(), 2u);
  EXPECT_NEAR(prediction.stability.spectral_radius, 0.5274, 0.00005);
}

TEST(Prediction, OfAnEndlessRunIsStationary) {
  Configuration configuration = paper_run("");
  configuration.run.steps = 0;
  const Prediction prediction = predict(configuration);
  EXPECT_EQ(prediction.mean, (std::vector<double>{0.0, 0.0}));
  EXPECT_EQ(prediction.variance, prediction.stationary_variance);
}

TEST(Prediction, TakesTheRecordedLeaderOfTheModel) {
  Configuration configuration = paper_run("");
  const Prediction behind_profile = predict(configuration);
  configuration.model.recorded_leader = {0.0, 1.0, 2.0, 3.0};
  const Prediction behind_recording = predict(configuration);
  EXPECT_NE(behind_recording.mean, behind_profile.mean);
  EXPECT_EQ(behind_recording.variance, behind_profile.variance);
}

}  // namespace
}  // namespace platoon
