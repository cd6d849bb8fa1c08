#include "stochastic_platoon/math/string/error_moments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/numerics/exact.hpp"
#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

/// zeta_1 .. zeta_N over all steps, one after the other, for given initial positions [m] (per follower) and noise (per
/// follower and step), computed vehicle by vehicle as in the platoon itself.
std::vector<double> run_string(const PlatoonModel& model, std::size_t followers, std::size_t steps,
                               const std::vector<double>& initial, const std::vector<double>& noise, bool led = true) {
  std::vector<double> errors;
  LeaderVehicle leader(model);
  std::vector<double> ahead{leader.start()};
  for (std::size_t k = 0; k < steps; ++k) ahead.push_back(leader.step());
  if (!led) ahead.assign(steps + 1, 0.0);
  for (std::size_t i = 0; i < followers; ++i) {
    const std::unique_ptr<LoopBatch> loop = loop_batch(model.default_vehicle().loop);
    loop->start({initial[i]}, 0.0);
    std::vector<double> own;
    for (std::size_t k = 0; k <= steps; ++k) {
      std::vector<double> y;
      loop->output(y);
      own.push_back(y.front());
      const double d = k == 0 ? 0.0 : noise[i * steps + k - 1];
      const double input = ahead[k] + d;
      loop->step(&input, model.default_vehicle().standstill_distance, y.data(), {});
    }
    const Signal zeta = tracking_error(model, 1);
    for (std::size_t k = 1; k <= steps; ++k) errors.push_back(zeta({ahead[k]}, {own[k], own[k - 1]}));
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

TEST(ErrorMoments, HaveTheMeanOfVehiclesWithoutNoise) {
  for (const ExampleLoop& example : example_loops()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    std::vector<double> places;
    for (std::size_t i = 1; i <= kFollowers; ++i) {
      places.push_back(model.default_vehicle().initial_position.mean -
                       static_cast<double>(i) * model.default_vehicle().standstill_distance);
    }
    const std::vector<double> errors =
        run_string(model, kFollowers, kSteps, places, std::vector<double>(kFollowers * kSteps, 0.0));
    const SignalMoments moments = error_moments(model, kFollowers, kSteps);
    const double scale = largest(errors);
    for (std::size_t at = 0; at < errors.size(); ++at) {
      EXPECT_NEAR(moments.mean[at], errors[at], 1e-10 * scale) << example.name << " at " << at;
    }
  }
}

TEST(ErrorMoments, HaveTheVarianceOfTheSquaredUnitResponses) {
  for (const ExampleLoop& example : example_loops()) {
    PlatoonModel model = model_with(example.loop, example.headway);
    model.default_vehicle().standstill_distance = 0.0;
    const std::vector<double> silence(kFollowers * kSteps, 0.0);
    std::vector<double> variance(kFollowers * kSteps, 0.0);
    const auto add_squares = [&variance](const std::vector<double>& response, double weight) {
      for (std::size_t at = 0; at < variance.size(); ++at) variance[at] += weight * response[at] * response[at];
    };
    for (std::size_t j = 0; j < kFollowers; ++j) {
      std::vector<double> place(kFollowers, 0.0);
      place[j] = 1.0;
      add_squares(run_string(model, kFollowers, kSteps, place, silence, false),
                  model.default_vehicle().initial_position.variance);
      for (std::size_t l = 0; l < kSteps; ++l) {
        std::vector<double> noise = silence;
        noise[j * kSteps + l] = 1.0;
        const std::vector<double> rest(kFollowers, 0.0);
        add_squares(run_string(model, kFollowers, kSteps, rest, noise, false),
                    model.default_vehicle().position().noise_variance);
      }
    }
    const SignalMoments moments = error_moments(model, kFollowers, kSteps);
    for (std::size_t at = 0; at < variance.size(); ++at) {
      EXPECT_NEAR(moments.variance[at], variance[at], 1e-12 * variance[at]) << example.name << " at " << at;
    }
  }
}

TEST(ErrorMoments, HaveAClosedFormAtTheFirstStep) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const SignalMoments moments = error_moments(model, 2, 1);
  const double b = model.default_vehicle().loop.realization.c() * model.default_vehicle().loop.realization.a() *
                   unit_equilibrium(model.default_vehicle().loop.realization);  // y(0) of a vehicle at 1 with input 0
  EXPECT_NEAR(moments.mean_at(1, 0), -0.8 * (4.2 * b - 3.2), 1e-14);
  EXPECT_NEAR(moments.variance_at(1, 0), 0.3 * (4.2 * b - 3.2) * (4.2 * b - 3.2), 1e-14);
}

TEST(ErrorMoments, OfTheLeaderVanishAfterTheLastChangeOfSpeed) {
  const std::vector<double> error = leader_error(model_with(paper_loop(3.2), 3.2), 400);
  EXPECT_GT(std::abs(error[3]), 1e-3);
  EXPECT_LT(std::abs(error[399]), 1e-14);
}

TEST(ErrorMoments, DoNotDependOnTheStandstillDistance) {
  PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const SignalMoments far = error_moments(model, 3, 20);
  model.default_vehicle().standstill_distance = 0.0;
  EXPECT_EQ(far.mean, error_moments(model, 3, 20).mean);
}

TEST(ErrorMoments, RejectsAnEmptyStringAndAnEmptyRun) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  EXPECT_THROW(error_moments(model, 0, 10), std::invalid_argument);
  EXPECT_THROW(error_moments(model, 1, 0), std::invalid_argument);
  EXPECT_THROW(leader_error(model, 0), std::invalid_argument);
}

/// zeta_1 behind a leader of this displacement per step, by the difference equation of T in a hundred digits.
std::vector<double> exact_first_error(const ExactPolynomial& n, const ExactPolynomial& d, double h, double displacement,
                                      std::size_t steps) {
  const auto filtered = [&](const ExactPolynomial& u) {
    const std::size_t delay = d.size() - n.size();
    ExactPolynomial y;
    for (std::size_t k = 0; k < u.size(); ++k) {
      Exact sum = 0;
      for (std::size_t i = 0; i < n.size() && i + delay <= k; ++i) sum += n[i] * u[k - delay - i];
      for (std::size_t i = 1; i < d.size() && i <= k; ++i) sum -= d[i] * y[k - i];
      y.push_back(sum);
    }
    return y;
  };
  ExactPolynomial reference;
  for (std::size_t k = 0; k < steps; ++k) reference.push_back(Exact(displacement) * k);
  const ExactPolynomial first = filtered(reference);
  const ExactPolynomial second = filtered(first);
  std::vector<double> errors;
  for (std::size_t k = 0; k < steps; ++k) {
    const Exact moved = k > 0 ? second[k] - second[k - 1] : second[k];
    errors.push_back((first[k] - second[k] - Exact(h) * moved).convert_to<double>());
  }
  return errors;
}

// Sampled at a kilohertz, with a headway of 1426 samples: T's coefficients by powers of z have lost half
// their digits.
TEST(ErrorMoments, KeepTheirDigitsAtFastSampling) {
  const double a = 1.0 - std::ldexp(1.0, -7), gain = std::ldexp(1.0, -28), h = 1426.0;
  const TransferFunction plant(Eigen::Vector2d(gain, gain), polynomial_with_zeros({1.0, 1.0, a}));
  const TransferFunction controller(Eigen::Vector2d(1024.0, -1023.75), Eigen::Vector2d(1.0, 0.0));
  PlatoonModel model = model_with(close_loop({plant, controller}, h), h);
  model.sample_period = 0.001;
  model.leader = LeaderProfile({{0, 13.75}}, 0.001);
  model.default_vehicle().initial_position = {0.0, 0.0};
  const ExactPolynomial g = multiply(exact(plant.numerator()), exact(controller.numerator()));
  const ExactPolynomial n = multiply(g, {Exact(1), Exact(0)});
  ExactPolynomial d =
      multiply(multiply(exact(plant.denominator()), exact(controller.denominator())), {Exact(1), Exact(0)});
  const ExactPolynomial fed_back = multiply(g, {Exact(1) + Exact(h), -Exact(h)});
  for (std::size_t i = 0; i < fed_back.size(); ++i) d[d.size() - fed_back.size() + i] += fed_back[i];
  const std::vector<double> expected = exact_first_error(n, d, h, 13.75 * 0.001, 200);
  const SignalMoments found = error_moments(model, 1, 200);
  for (std::size_t k = 0; k < 200; ++k) EXPECT_NEAR(found.mean[k], expected[k], 1e-13) << k;
}

TEST(ErrorMoments, DoNotDependOnASpeedThatIsNearlyZero) {
  PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  model.leader = LeaderProfile({{0, 20.0}}, 0.1);
  const std::vector<double> expected = leader_error(model, 50);
  model.leader = LeaderProfile({{0, 7e-323}, {1, 20.0}}, 0.1);
  const std::vector<double> found = leader_error(model, 51);
  for (std::size_t k = 0; k < 50; ++k) EXPECT_NEAR(found[k + 1], expected[k], 1e-13) << k;
}

}  // namespace
}  // namespace platoon
