#include "stochastic_platoon/math/string/rounding_bound.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/simulation/trajectory.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "unit/math/example_loops.hpp"
#include "unit/math/radio_cars.hpp"

namespace platoon {
namespace {

/// The tracking errors of a platoon without noise, computed as a run computes them.
std::vector<double> run(const PlatoonModel& model, std::size_t followers, std::size_t steps) {
  const Signal zeta = tracking_error(model, 1);
  LeaderVehicle leader(model);
  std::vector<double> ahead{leader.start()};
  for (std::size_t k = 0; k < steps; ++k) ahead.push_back(leader.step());
  std::vector<double> errors;
  for (std::uint32_t i = 1; i <= followers; ++i) {
    FollowerVehicle follower(model, 1, i);
    std::vector<double> own(1), positions;
    follower.start(0, 1, own);
    positions.push_back(own.front());
    for (std::size_t k = 0; k < steps; ++k) {
      follower.step({ahead[k]}, own);
      errors.push_back(zeta({ahead[k + 1]}, {own.front(), positions.back()}));
      positions.push_back(own.front());
    }
    ahead.swap(positions);
  }
  return errors;
}

/// The largest rounding error over its bound.
double share_of_bound(const PlatoonModel& model, std::size_t followers, std::size_t steps) {
  const SignalMoments moments = error_moments(model, followers, static_cast<std::int64_t>(steps));
  const std::vector<double> bounds = rounding_bounds(model, moments);
  const std::vector<double> errors = run(model, followers, steps);
  double largest = 0.0;
  for (std::size_t c = 0; c < errors.size(); ++c)
    largest = std::max(largest, std::abs(errors[c] - moments.mean[c]) / bounds[c]);
  return largest;
}

PlatoonModel without_noise(PlatoonModel model) {
  model.default_vehicle().position().noise_variance = 0.0;
  model.default_vehicle().initial_position.variance = 0.0;
  return model;
}

TEST(RoundingBounds, HoldForEveryLoop) {
  std::vector<ExampleLoop> loops = example_loops();
  for (const ExampleLoop& loop : string_stable_loops()) loops.push_back(loop);
  for (const ExampleLoop& example : loops) {
    const double share = share_of_bound(without_noise(model_with(example.loop, example.headway)), 5, 400);
    EXPECT_LE(share, 1.0) << example.name;
    EXPECT_GT(share, 1e-6) << example.name << ": no bound to speak of";
  }
}

TEST(RoundingBounds, HoldFarFromTheOrigin) {
  PlatoonModel model = without_noise(model_with(paper_loop(3.2), 3.2));
  model.sample_period = 1.0;
  model.leader = LeaderProfile({{0, 30.0}}, 1.0);
  const double share = share_of_bound(model, 3, 300000);
  EXPECT_LE(share, 1.0);
  EXPECT_GT(share, 1e-6);
}

TEST(RoundingBounds, HoldAtFastSampling) {
  const double a = 1.0 - std::ldexp(1.0, -7), gain = std::ldexp(1.0, -28), h = 1426.0;
  const TransferFunction plant(Eigen::Vector2d(gain, gain), polynomial_with_zeros({1.0, 1.0, a}));
  const TransferFunction controller(Eigen::Vector2d(1024.0, -1023.75), Eigen::Vector2d(1.0, 0.0));
  PlatoonModel model = without_noise(model_with(close_loop({plant, controller}, h), h));
  model.sample_period = 0.001;
  model.leader = LeaderProfile({{0, 13.75}}, 0.001);
  for (const std::size_t steps : {60u, 5000u}) {
    const double share = share_of_bound(model, 5, steps);
    EXPECT_LE(share, 1.0) << steps;
    EXPECT_GT(share, 1e-7) << steps;
  }
}

TEST(RoundingBounds, OfThePapersPlatoonAreFarBelowAMillimetre) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const std::vector<double> bounds = rounding_bounds(model, error_moments(model, 20, 100));
  EXPECT_LT(*std::max_element(bounds.begin(), bounds.end()), 1e-9);
}

// The means of all signals of a drive without noise, as a run and as the theory compute them.
TEST(RoundingBounds, OfSignalsHoldAtEveryPeriod) {
  constexpr std::int64_t kSteps = 3000;
  const std::vector<std::string> names = signal_names("gap,speed,acceleration,jerk,input,relative_speed");
  for (const double period : {0.1, 0.02, 0.005}) {
    const PlatoonModel model = without_noise(
        radio_platoon_of({{car_with_actuator_lag(0.1, 0.1), period}, {ControllerGains{0.2, 0.7, 0.0}, period}},
                         1.0 / period, 0.0, 0.0, 1, period));
    const std::vector<SignalMoments> theory = signal_moments(model, names, 3, kSteps);
    std::size_t follower = 0;
    for_each_trajectory(model, 1, 3, kSteps, 0, names, [&](const Trajectory& of) {
      if (follower++ == 0) return;
      for (std::size_t s = 0; s < names.size(); ++s) {
        const double bound = signal_rounding(model, signals_of(model, names, 1).requested[s], 3, kSteps);
        double largest = 0.0;
        for (std::size_t k = 0; k < kSteps; ++k)
          largest = std::max(largest, std::abs(of.signals[s + 1][k] - theory[s].mean[(follower - 2) * kSteps + k]));
        EXPECT_LE(largest, bound) << names[s] << " " << period;
        EXPECT_GT(largest, 1e-9 * bound) << names[s] << " " << period << ": no bound to speak of";
      }
    });
    EXPECT_EQ(follower, 4u);
  }
}

}  // namespace
}  // namespace platoon
