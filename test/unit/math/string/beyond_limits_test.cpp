#include "stochastic_platoon/math/string/beyond_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/model/linear_model.hpp"
#include "stochastic_platoon/math/simulation/trajectory.hpp"
#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/monte_carlo.hpp"

namespace platoon {
namespace {

constexpr std::size_t kFollowers = 3;
constexpr std::int64_t kSteps = 400;
const std::vector<std::string> kNames{"gap", "speed", "acceleration", kInput};

// Trucks and cars, some with a radio, that start steadily behind a leader that changes its speed.
PlatoonModel steady_platoon(double radar, double radio) {
  PlatoonModel model = radio_platoon(1.2, radar, radio);
  add_trucks(model, 0.3, 0.1);
  model.default_vehicle().position().link.delay = 2;
  model.start = Start::steady;
  model.leader = LeaderProfile({{0, 20.0}, {100, 18.0}, {220, 21.0}}, model.sample_period);
  return model;
}

// The theory's means are the motion without noise.
void expect_means(PlatoonModel model) {
  const std::vector<SignalMoments> theory = signal_moments(model, kNames, kFollowers, kSteps);
  const SignalMoments errors = error_moments(model, kFollowers, kSteps);
  for (VehicleType& type : model.types) {
    type.vehicle.position().noise_variance = 0.0;
    if (type.vehicle.radio()) type.vehicle.radio()->noise_variance = 0.0;
  }
  std::size_t follower = 0;
  for_each_trajectory(model, 1, kFollowers, kSteps, 0, kNames, [&](const Trajectory& of) {
    if (follower++ == 0) return;
    for (std::int64_t k = 0; k < kSteps; ++k) {
      const std::size_t c = cell(follower - 1, k, kSteps);
      EXPECT_NEAR(errors.mean[c], of.signals[0][static_cast<std::size_t>(k)], 1e-8);
      for (std::size_t s = 0; s < kNames.size(); ++s)
        EXPECT_NEAR(theory[s].mean[c], of.signals[1 + s][static_cast<std::size_t>(k)], 1e-6) << kNames[s] << " " << c;
    }
  });
}

TEST(SteadyTheory, HasTheMeansOfTheMotion) {
  expect_means(steady_platoon(0.01, 0.02));
}

TEST(SteadyTheory, HasTheMeansBehindARecordedLeaderOfARadio) {
  PlatoonModel model = steady_platoon(0.01, 0.02);
  for (std::int64_t k = -1; k < kSteps; ++k) {
    const double t = static_cast<double>(k) * model.sample_period;
    model.recorded_leader.push_back(5.0 + 20.0 * t - 3.0 * t * t * t / (1.0 + t));
  }
  expect_means(model);
  model.start = Start::rest;
  expect_means(model);
}

TEST(SteadyTheory, HasTheVariancesOfTheInputs) {
  const PlatoonModel model = steady_platoon(0.01, 0.02);
  constexpr std::uint64_t kRealizations = 3000;
  const SignalMoments theory = signal_moments(model, {kInput}, kFollowers, kSteps).front();
  const std::vector<Moments> measured =
      monte_carlo(model, {1, kFollowers, kSteps, 512, {kInput}}, kRealizations).moments.totals();
  for (std::size_t c = 1; c < theory.mean.size(); c += 7) {
    const Moments& of = measured[theory.mean.size() + c];
    if (theory.variance[c] == 0.0) continue;
    EXPECT_NEAR(of.mean, theory.mean[c], 5.0 * std::sqrt(theory.variance[c] / kRealizations)) << c;
    EXPECT_NEAR(of.variance(), theory.variance[c], 5.0 * theory.variance[c] * std::sqrt(2.0 / kRealizations)) << c;
  }
}

TEST(BeyondLimits, IsTheShareOfLinearInputsBeyondThem) {
  PlatoonModel model = radio_platoon(1.2, 0.01, 0.02);
  model.leader = LeaderProfile({{0, 20.0}, {50, 19.9}}, model.sample_period);
  model.default_vehicle().limits.input = Interval{-0.15, 0.05};
  constexpr std::int64_t kFew = 80;
  const std::vector<double> theory = probability_beyond_limits(model, 2, kFew);
  const PlatoonModel linear = without_limits(model, kFew);
  EXPECT_FALSE(has_limits(linear));
  constexpr int kRealizations = 2000;
  std::vector<double> counted(theory.size(), 0.0);
  for (std::uint64_t r = 0; r < kRealizations; ++r) {
    std::size_t follower = 0;
    for_each_trajectory(linear, 1, 2, kFew, r, {kInput}, [&](const Trajectory& of) {
      if (follower++ == 0) return;
      for (std::int64_t k = 0; k < kFew; ++k) {
        const double u = of.signals[1][static_cast<std::size_t>(k)];
        counted[cell(follower - 1, k, kFew)] += u < -0.15 || u > 0.05 ? 1.0 / kRealizations : 0.0;
      }
    });
  }
  double largest = 0.0;
  for (std::size_t c = 0; c < theory.size(); ++c) {
    largest = std::max(largest, theory[c]);
    EXPECT_NEAR(counted[c], theory[c], 5.0 * std::sqrt(theory[c] * (1.0 - theory[c]) / kRealizations) + 1e-12) << c;
  }
  EXPECT_GT(largest, 0.2);
  EXPECT_THROW(signal_moments(model, {kInput}, 2, kFew), std::invalid_argument) << "limits have no theory";
  EXPECT_THROW(error_moments(model, 2, kFew), std::invalid_argument);
  EXPECT_THROW(string_stability(model), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
