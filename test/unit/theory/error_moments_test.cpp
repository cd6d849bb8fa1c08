#include "stochastic_platoon/theory/error_moments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "example_loops.hpp"
#include "stochastic_platoon/model/tracking_error.hpp"
#include "stochastic_platoon/model/vehicle.hpp"

namespace platoon {
namespace {

/// zeta_1 .. zeta_N over all steps, one after the other, for given initial positions [m] (per follower) and
/// noise (per follower and step), run vehicle by vehicle as the platoon itself does.
std::vector<double> run_string(const PlatoonModel& model, std::size_t followers, std::size_t steps,
                               const std::vector<double>& initial, const std::vector<double>& noise,
                               bool led = true) {
  std::vector<double> errors;
  LeaderVehicle leader(model);
  std::vector<double> ahead{leader.start()};
  for (std::size_t k = 0; k < steps; ++k) ahead.push_back(leader.step());
  if (!led) ahead.assign(steps + 1, 0.0);
  for (std::size_t i = 0; i < followers; ++i) {
    ClosedLoopBatch loop(model.loop.realization);
    loop.start_at_equilibrium({initial[i]});
    std::vector<double> own;
    for (std::size_t k = 0; k <= steps; ++k) {
      std::vector<double> y;
      loop.output(y);
      own.push_back(y.front());
      const double d = k == 0 ? 0.0 : noise[i * steps + k - 1];
      loop.step({ahead[k] + d}, model.standstill_distance, y);
    }
    const TrackingError zeta{model.headway, model.standstill_distance};
    for (std::size_t k = 1; k <= steps; ++k) errors.push_back(zeta(ahead[k], own[k], own[k - 1]));
    ahead = own;
  }
  return errors;
}

double largest(const std::vector<double>& values) {
  double result = 0.0;
  for (const double value : values) result = std::max(result, std::abs(value));
  return result;
}

constexpr std::size_t kFollowers = 5;
constexpr std::size_t kSteps = 60;

TEST(ErrorMoments, MeanIsWhatTheVehiclesDoWithoutNoise) {
  for (const ExampleLoop& example : example_loops()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    std::vector<double> places;
    for (std::size_t i = 1; i <= kFollowers; ++i) {
      places.push_back(model.initial_position.mean - static_cast<double>(i) * model.standstill_distance);
    }
    const std::vector<double> errors =
        run_string(model, kFollowers, kSteps, places, std::vector<double>(kFollowers * kSteps, 0.0));
    const ErrorMoments moments = error_moments(model, kFollowers, kSteps);
    const double scale = largest(errors);
    for (std::size_t at = 0; at < errors.size(); ++at) {
      EXPECT_NEAR(moments.mean[at], errors[at], 1e-10 * scale) << example.name << " at " << at;
    }
  }
}

TEST(ErrorMoments, VarianceIsTheSumOfSquaredUnitResponsesOfTheVehicles) {
  for (const ExampleLoop& example : example_loops()) {
    PlatoonModel model = model_with(example.loop, example.headway);
    model.standstill_distance = 0.0;
    const std::vector<double> silence(kFollowers * kSteps, 0.0);
    std::vector<double> variance(kFollowers * kSteps, 0.0);
    const auto add_squares = [&variance](const std::vector<double>& response, double weight) {
      for (std::size_t at = 0; at < variance.size(); ++at)
        variance[at] += weight * response[at] * response[at];
    };
    for (std::size_t j = 0; j < kFollowers; ++j) {
      std::vector<double> place(kFollowers, 0.0);
      place[j] = 1.0;
      add_squares(run_string(model, kFollowers, kSteps, place, silence, false),
                  model.initial_position.variance);
      for (std::size_t l = 0; l < kSteps; ++l) {
        std::vector<double> noise = silence;
        noise[j * kSteps + l] = 1.0;
        const std::vector<double> rest(kFollowers, 0.0);
        add_squares(run_string(model, kFollowers, kSteps, rest, noise, false), model.noise_variance);
      }
    }
    const ErrorMoments moments = error_moments(model, kFollowers, kSteps);
    for (std::size_t at = 0; at < variance.size(); ++at) {
      EXPECT_NEAR(moments.variance[at], variance[at], 1e-12 * variance[at]) << example.name << " at " << at;
    }
  }
}

TEST(ErrorMoments, FirstErrorsAreKnownInClosedForm) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const ErrorMoments moments = error_moments(model, 2, 1);
  const double b = model.loop.realization.c() * model.loop.realization.a() *
                   unit_equilibrium(model.loop.realization);  // y(0) of a vehicle at 1 that hears 0
  EXPECT_NEAR(moments.mean_at(1, 0), -0.8 * (4.2 * b - 3.2), 1e-14);
  EXPECT_NEAR(moments.variance_at(1, 0), 0.3 * (4.2 * b - 3.2) * (4.2 * b - 3.2), 1e-14);
}

TEST(ErrorMoments, LeaderErrorVanishesToRoundingAfterTheLastChangeOfSpeed) {
  const std::vector<double> error = leader_error(model_with(paper_loop(3.2), 3.2), 400);
  EXPECT_GT(std::abs(error[3]), 1e-3);
  EXPECT_LT(std::abs(error[399]), 1e-14);
}

TEST(ErrorMoments, StandstillDistanceCancels) {
  PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const ErrorMoments far = error_moments(model, 3, 20);
  model.standstill_distance = 0.0;
  EXPECT_EQ(far.mean, error_moments(model, 3, 20).mean);
}

TEST(ErrorMoments, RefusesAnEmptyStringAndAnEmptyRun) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  EXPECT_THROW(error_moments(model, 0, 10), std::invalid_argument);
  EXPECT_THROW(error_moments(model, 1, 0), std::invalid_argument);
  EXPECT_THROW(leader_error(model, 0), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
