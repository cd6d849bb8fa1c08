#include "stochastic_platoon/math/string/settling_time.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

// The transient in the last follower's variance and mean.
void expect_settled(const PlatoonModel& model, std::size_t followers, const std::string& name) {
  const std::optional<std::int64_t> steps = settling_steps(model, followers);
  ASSERT_TRUE(steps) << name;
  const SignalMoments moments = error_moments(model, followers, *steps + 1);
  const double stationary = stationary_variances(model, followers).back();
  EXPECT_NEAR(moments.variance.back(), stationary, 1e-5 * stationary) << name << ", " << *steps << " steps";
  double largest = 0.0;
  for (const double mean : moments.mean) largest = std::max(largest, std::abs(mean));
  EXPECT_NEAR(moments.mean.back(), stationary_means(model, followers).back(), 1e-5 * largest)
      << name << ", " << *steps << " steps";
}

TEST(SettlingTime, EndsTheEffectOfTheStart) {
  for (const double headway : {2.4, 3.2, 10.0}) {
    for (const std::size_t followers : {1u, 5u, 20u, 60u})
      expect_settled(paper_platoon(headway), followers, "paper " + std::to_string(headway));
  }
}

TEST(SettlingTime, GrowsWithDelaysAndSlowPoles) {
  PlatoonModel model = paper_platoon(3.2);
  const std::int64_t before = *settling_steps(model, 20);
  EXPECT_LT(before, 300);
  model.default_vehicle().position().link.delay = 10;
  EXPECT_EQ(*settling_steps(model, 20), before + 200);
  model.default_vehicle().position().link.loss = LossModel();
  model.default_vehicle().position().link.loss->probability = 0.9;
  EXPECT_GT(*settling_steps(model, 20), before + 300) << "a lost position is kept for ten steps on average";
}

// The second moments of these predictions decay more slowly than their means.
TEST(SettlingTime, LastsUntilTheSecondMomentsOfPredictionsHaveDecayed) {
  PlatoonModel model = paper_platoon(8.0);
  model.default_vehicle().position().link.loss = LossModel{0.3, std::nullopt, {0.0, 1.6, -0.6}};
  expect_settled(model, 3, "predictions");
}

// Losses of a moving platoon add a variance, which settles with the motion of the leader.
TEST(SettlingTime, LastsUntilASlowLeaderHasSettled) {
  PlatoonModel model = paper_platoon(40.0);
  VehicleModel quick = paper_platoon(8.0).default_vehicle();
  quick.position().link.loss = LossModel{0.2, std::nullopt, {0.5, 0.5}};
  model.types.push_back({"quick", quick, {}});
  model.string = {1};
  expect_settled(model, 2, "slow leader");
}

TEST(SettlingTime, DoesNotExistForAnUnstableVehicle) {
  PlatoonModel model = paper_platoon(3.2);
  Eigen::MatrixXd a = model.default_vehicle().loop.realization.a();
  model.default_vehicle().loop =
      closed_loop_from({a / spectral_radius(model.default_vehicle().loop) * 1.01,
                        model.default_vehicle().loop.realization.b(), model.default_vehicle().loop.realization.c()});
  EXPECT_FALSE(settling_steps(model, 20));
}

}  // namespace
}  // namespace platoon
