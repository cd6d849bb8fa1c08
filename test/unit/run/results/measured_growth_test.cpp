#include <gtest/gtest.h>

#include "unit/monte_carlo.hpp"
#include "unit/run/configuration/model_text.hpp"
#include "unit/run/report/hearing_models.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

class MeasuredGrowth : public ResultTest {};

// Few values, a rare loss that carries the variance, and quantised errors of few realizations: six standard errors are
// chance for all three.
TEST_F(MeasuredGrowth, IsNotFoundByChance) {
  configuration_.run.followers = 20;
  configuration_.run.steps = 200;
  const auto expect_no_growth = [this](std::uint64_t realizations, std::uint64_t seeds) {
    predict_again();
    ASSERT_TRUE(prediction_.stability.limit_variance);
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      RunResult result;
      result.realizations = realizations;
      result.moments = monte_carlo(configuration_.model, {seed, 20, 200, 1024}, realizations).moments.totals();
      EXPECT_FALSE(measured_growth(configuration_, prediction_, result)) << realizations << " " << seed;
      for (Moments& of : result.moments) {
        of.squared_deviations *= 1e6;
        of.cubed_deviations *= 1e9;
        of.fourth_deviations *= 1e12;
      }
      EXPECT_TRUE(measured_growth(configuration_, prediction_, result)) << realizations << " " << seed;
    }
  };
  expect_no_growth(2, 200);
  Input& position = configuration_.model.default_vehicle().position();
  position.noise_variance = 1e-4;
  position.link.loss = LossModel{1e-5, {}, {1.0}};
  expect_no_growth(1000, 30);
  position.noise_variance = 0.0;
  position.link.loss.reset();
  position.link.quantisation_step = 0.5;
  expect_no_growth(3, 60);
}

TEST_F(MeasuredGrowth, IsNoRounding) {
  configuration_.run.steps = 200;
  make_quiet();
  ASSERT_EQ(prediction_.stability.limit_variance, 0.0);
  RunResult result = this->result();
  for (const double variance : {1e-22, 1e-12}) {
    for (Moments& of : result.moments) of.squared_deviations = variance * static_cast<double>(of.count);
    EXPECT_EQ(measured_growth(configuration_, prediction_, result).has_value(), variance > 1e-20) << variance;
  }
}

// Followers near the leader hear it in another way than those far behind, and may have a larger variance.
TEST_F(MeasuredGrowth, ExpectsFirstFollowersAboveTheLimitInAStringThatHearsOthers) {
  configuration_.model = hearing_model(replaced(kTwoAhead, "time_headway: 8", "time_headway: 20"));
  configuration_.run.steps = 3000;
  configuration_.run.realizations = 20000;
  predict_again();
  RunResult result = this->result();
  EXPECT_FALSE(measured_growth(configuration_, prediction_, result));
  ASSERT_TRUE(prediction_.stability.limit_variance);
  prediction_.stability.limit_variance = 0.5 * prediction_.stationary_variance[0];
  EXPECT_FALSE(measured_growth(configuration_, prediction_, result));
  for (Moments& of : result.moments) of.squared_deviations *= 40.0;
  EXPECT_TRUE(measured_growth(configuration_, prediction_, result));
}

}  // namespace
}  // namespace platoon
