#include "stochastic_platoon/math/string/collision_risk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/statistics/normal_crossing.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

PlatoonModel at_rest(double standstill_distance) {
  PlatoonModel model = paper_platoon(3.2);
  model.leader = LeaderProfile({{0, 0.0}}, 0.1);
  model.default_vehicle().standstill_distance = standstill_distance;
  return model;
}

CollisionRisk risk_of(const PlatoonModel& model, std::size_t followers, double probability = 1e-6,
                      std::int64_t steps = 50) {
  const StationarySignal gap = stationary_signals(model, {"gap"}, followers, string_stability(model).string_stable)[0];
  const SignalMoments table = signal_moments(model, {"gap"}, followers, steps)[0];
  return collision_risk(model, gap, table, static_cast<std::size_t>(steps), probability);
}

TEST(CollisionRisk, HasTheFiguresOfThePapersExampleAtRest) {
  struct Row {
    std::size_t follower;
    double variance, probability, rate, distance;
  };
  const PlatoonModel model = at_rest(2.0);
  const StationarySignal gap = stationary_signals(model, {"gap"}, 100, true)[0];
  const CollisionRisk risk = risk_of(model, 100);
  for (const Row& row :
       {Row{1, 0.169296, 5.846e-7, 5.55e-7, 1.95583}, Row{20, 0.873506, 0.0161807, 0.00985964, 4.44262},
        Row{100, 0.978277, 0.0215838, 0.0121322, 4.70151}}) {
    const std::size_t i = row.follower - 1;
    EXPECT_NEAR(gap.followers.variance[i], row.variance, 5e-7);
    EXPECT_NEAR(risk.probability[i] / row.probability, 1.0, 3e-5);
    EXPECT_NEAR(risk.rate[i] / row.rate, 1.0, 3e-4);
    EXPECT_NEAR(risk.required_distance[i], row.distance, 5e-6);
  }
  EXPECT_NEAR(*gap.limit_variance(), 1.058477, 5e-7);
  EXPECT_NEAR(*risk.limit_probability, 0.0259496, 5e-8);
  EXPECT_NEAR(*risk.limit_rate, 0.0137417, 5e-8);
  EXPECT_NEAR(*risk.limit_required_distance, 4.89043, 5e-6);
}

TEST(CollisionRisk, HasTheGivenProbabilityAtTheRequiredDistance) {
  const double distance = *risk_of(at_rest(2.0), 1).limit_required_distance;
  EXPECT_NEAR(*risk_of(at_rest(distance), 1).limit_probability / 1e-6, 1.0, 1e-9);
  EXPECT_NEAR(*risk_of(at_rest(distance), 1).limit_required_distance, distance, 1e-12);
}

TEST(CollisionRisk, OfAnyFollowerIsBoundedAtThePlatoonsDistance) {
  const CollisionRisk risk = risk_of(at_rest(2.0), 20, 1e-3);
  EXPECT_GT(risk.platoon_required_distance, risk.required_distance.back());
  double sum = 0.0, largest = 0.0;
  for (const double probability : risk_of(at_rest(risk.platoon_required_distance), 20).probability) {
    sum += probability;
    largest = std::max(largest, probability);
  }
  EXPECT_LE(sum, 1e-3);
  EXPECT_NEAR(largest, 1e-3 / 20.0, 1e-12);
  EXPECT_EQ(risk_of(at_rest(2.0), 1).platoon_required_distance, risk_of(at_rest(2.0), 1).required_distance[0]);
}

TEST(CollisionRisk, RequiresNoDistanceOfADrivingPlatoon) {
  PlatoonModel model = paper_platoon(3.2);  // h v T_s = 6.4 m
  EXPECT_EQ(*risk_of(model, 1).limit_required_distance, 0.0);
  model.default_vehicle().length = 6.0;
  EXPECT_NEAR(*risk_of(model, 1).limit_required_distance, 4.89043 - 0.4, 5e-6);
}

TEST(CollisionRisk, OfAMixedStringIsTheLargestOfItsTypes) {
  PlatoonModel model = at_rest(3.0);
  VehicleType close{"close", model.default_vehicle(), {}};
  close.vehicle.standstill_distance = 1.0;
  model.types.push_back(close);
  model.string = {1, 0};
  const CollisionRisk risk = risk_of(model, 2), of_close = risk_of(at_rest(1.0), 2);
  EXPECT_NEAR(*risk.limit_probability / *of_close.limit_probability, 1.0, 1e-9);
  EXPECT_NEAR(*risk.limit_rate / *of_close.limit_rate, 1.0, 1e-9);
  EXPECT_NEAR(*risk.limit_required_distance, 4.89043, 5e-6) << "it does not depend on the present distances";
}

// Without changes of the mean the bound grows by the stationary rate per step.
TEST(CollisionRisk, HasABoundThatSumsNewCollisions) {
  const CollisionRisk one = risk_of(at_rest(2.0), 1, 1e-6, 200), more = risk_of(at_rest(2.0), 1, 1e-6, 300);
  EXPECT_NEAR((more.bound[0] - one.bound[0]) / (100.0 * one.rate[0]), 1.0, 1e-9);
  EXPECT_EQ(risk_of(at_rest(0.1), 1, 1e-6, 300).bound[0], 1.0);
  // One step: the probability of a gap below 0 at this step, here from initial positions alone.
  PlatoonModel scattered = at_rest(2.0);
  scattered.default_vehicle().initial_position = {0.0, 4.0};
  const SignalMoments table = signal_moments(scattered, {"gap"}, 2, 1)[0];
  EXPECT_EQ(risk_of(scattered, 2, 1e-6, 1).bound[1], probability_below_zero({table.mean[1], table.variance[1]}));
}

TEST(CollisionRisk, HasNoLimitForAStringUnstablePlatoon) {
  const CollisionRisk risk = risk_of(paper_platoon(2.4), 5);
  EXPECT_FALSE(risk.limit_probability);
  EXPECT_FALSE(risk.limit_rate);
  EXPECT_FALSE(risk.limit_required_distance);
  EXPECT_EQ(risk.required_distance.size(), 5u);
}

TEST(CollisionRisk, WithoutNoiseIsZero) {
  PlatoonModel model = at_rest(2.0);
  model.default_vehicle().position().noise_variance = 0.0;
  const CollisionRisk risk = risk_of(model, 2);
  EXPECT_EQ(risk.probability[1], 0.0);
  EXPECT_EQ(risk.rate[1], 0.0);
  EXPECT_EQ(risk.bound[1], 0.0);
  EXPECT_EQ(risk.required_distance[1], 0.0);
}

}  // namespace
}  // namespace platoon
