#include "stochastic_platoon/math/string/signal_moments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

const std::vector<std::string> kAll = {"gap", "speed", "acceleration", "jerk", "relative_speed"};
constexpr double kPeriod = 0.5;

/// Every vehicle repeats the position received one step ago: T = 1 / z.
PlatoonModel relay(double noise_variance, const InitialPosition& initial = {}) {
  const TransferFunction delay(Eigen::VectorXd::Ones(1), Eigen::Vector2d(1.0, 0.0));
  VehicleModel vehicle(closed_loop_from(observable_canonical(delay)), 1.0);
  vehicle.standstill_distance = 2.0;
  vehicle.position().noise_variance = noise_variance;
  vehicle.initial_position = initial;
  return {vehicle, LeaderProfile({{0, 0.0}}, kPeriod), kPeriod};
}

void expect_row(const std::vector<double>& cells, std::size_t row, const std::vector<double>& expected) {
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_NEAR(cells[row * expected.size() + k], expected[k], 1e-13 * (1.0 + std::abs(expected[k])))
        << row << " " << k;
}

// y_1(k) = n_1(k-1) and y_2(k) = n_1(k-2) + n_2(k-1), with noises from step 0 on.
TEST(SignalMoments, OfRelaysSumTheirNoises) {
  constexpr double kNoise = 3.0;
  const std::vector<SignalMoments> found = signal_moments(relay(kNoise), kAll, 2, 5);
  expect_row(found[0].mean, 0, {2.0, 2.0, 2.0, 2.0, 2.0});
  expect_row(found[0].variance, 0, {0.0, kNoise, kNoise, kNoise, kNoise});
  expect_row(found[0].variance, 1, {0.0, 2.0 * kNoise, 3.0 * kNoise, 3.0 * kNoise, 3.0 * kNoise});
  expect_row(found[0].covariance_with_previous, 0, {0.0, 0.0, 0.0, 0.0, 0.0});
  expect_row(found[0].covariance_with_previous, 1, {0.0, 0.0, -kNoise, -kNoise, -kNoise});
  const double of_speed = kNoise / (kPeriod * kPeriod), of_acceleration = of_speed / (kPeriod * kPeriod),
               of_jerk = of_acceleration / (kPeriod * kPeriod);
  expect_row(found[1].variance, 0, {0.0, of_speed, 2.0 * of_speed, 2.0 * of_speed, 2.0 * of_speed});
  expect_row(found[2].variance, 0,
             {0.0, of_acceleration, 5.0 * of_acceleration, 6.0 * of_acceleration, 6.0 * of_acceleration});
  expect_row(found[3].variance, 0, {0.0, of_jerk, 10.0 * of_jerk, 19.0 * of_jerk, 20.0 * of_jerk});
  // T_s times the relative speed of follower 2: n_1(k-1) - 2 n_1(k-2) + n_1(k-3) - n_2(k-1) + n_2(k-2).
  expect_row(found[4].variance, 0, {0.0, of_speed, 2.0 * of_speed, 2.0 * of_speed, 2.0 * of_speed});
  expect_row(found[4].variance, 1, {0.0, 2.0 * of_speed, 7.0 * of_speed, 8.0 * of_speed, 8.0 * of_speed});
  for (std::size_t s = 1; s < kAll.size(); ++s) EXPECT_TRUE(found[s].covariance_with_previous.empty());
}

// With p_i at step -1, y_1 is 0 and y_2 is p_1 at step 0, and both are 0 from step 1 on. Before step -1 no vehicle
// moves.
TEST(SignalMoments, OfInitialPositionsDecay) {
  const std::vector<SignalMoments> found = signal_moments(relay(0.0, {7.0, 5.0}), kAll, 2, 3);
  expect_row(found[0].mean, 1, {2.0 - 7.0, 2.0, 2.0});
  expect_row(found[0].variance, 0, {0.0, 0.0, 0.0});
  expect_row(found[0].variance, 1, {5.0, 0.0, 0.0});
  expect_row(found[0].covariance_with_previous, 1, {-5.0, 0.0, 0.0});
  expect_row(found[1].mean, 0, {-14.0, 0.0, 0.0});
  expect_row(found[1].variance, 0, {20.0, 0.0, 0.0});
  expect_row(found[1].variance, 1, {40.0, 20.0, 0.0});
  expect_row(found[4].mean, 1, {-14.0, 14.0, 0.0});
  expect_row(found[4].variance, 1, {100.0, 20.0, 0.0});
  expect_row(found[2].variance, 0, {80.0, 80.0, 0.0});
  expect_row(found[3].variance, 0, {320.0, 4.0 * 320.0, 320.0});
}

// zeta = gap - delta - h T_s speed, the gap less the length of the predecessor.
TEST(SignalMoments, AgreeWithTheErrorsInTheirMeans) {
  PlatoonModel model = eventful_platoon(3.2);
  model.default_vehicle().length = 4.0;
  PlatoonModel patterned = radio_platoon(0.7, 0.01, 0.02);
  add_human_drivers(patterned);
  patterned.types[1].vehicle.length = 12.0;
  for (const PlatoonModel& one : {model, patterned}) {
    const std::vector<SignalMoments> found = signal_moments(one, {"gap", "speed"}, 7, 90);
    const SignalMoments errors = error_moments(one, 7, 90);
    for (std::size_t cell = 0; cell < errors.mean.size(); ++cell) {
      const std::size_t i = cell / 90 + 1;
      const VehicleModel& own = vehicle(one, i);
      const double apart = found[0].mean[cell] + vehicle(one, i - 1).length - own.standstill_distance;
      EXPECT_NEAR(apart - own.headway * one.sample_period * found[1].mean[cell], errors.mean[cell], 1e-10) << cell;
    }
  }
}

TEST(SignalMoments, OfEqualTypesEqualThoseOfAHomogeneousString) {
  const PlatoonModel model = eventful_platoon(2.9);
  PlatoonModel patterned = model;
  patterned.types.push_back({"twin", vehicle(model, 1), {}});
  patterned.string = {0, 1, 1};
  const std::vector<SignalMoments> expected = signal_moments(model, kAll, 8, 40),
                                   found = signal_moments(patterned, kAll, 8, 40);
  for (std::size_t s = 0; s < 4; ++s) {
    for (std::size_t cell = 0; cell < expected[s].variance.size(); ++cell)
      EXPECT_NEAR(found[s].variance[cell], expected[s].variance[cell], 1e-12 * expected[s].variance[cell]);
  }
}

TEST(SignalMoments, RejectModelsWithoutTheory) {
  PlatoonModel model = paper_platoon();
  EXPECT_THROW(signal_moments(model, {"distance"}, 1, 1), std::invalid_argument);
  EXPECT_THROW(signal_moments(model, kAll, 0, 1), std::invalid_argument);
  EXPECT_THROW(signal_moments(model, kAll, 1, 0), std::invalid_argument);
  model.default_vehicle().position().link.loss = LossModel{0.5, 1.0, {1.0}};
  EXPECT_THROW(signal_moments(model, kAll, 1, 1), std::invalid_argument) << "losses and arrivals alternate";
  model = paper_platoon();
  model.default_vehicle().limits.input = Interval{-8.0, 3.0};
  EXPECT_THROW(signal_moments(model, kAll, 1, 1), std::invalid_argument) << "limits";
}

// Dither is a white noise of variance D^2 / 12.
TEST(SignalMoments, OfQuantisedPositionsAreThoseOfMoreNoise) {
  PlatoonModel model = eventful_platoon(3.2), noisy = model;
  model.default_vehicle().position().link.quantisation_step = 0.6;
  noisy.default_vehicle().position().noise_variance += 0.6 * 0.6 / 12.0;
  const std::vector<SignalMoments> expected = signal_moments(noisy, kAll, 4, 30),
                                   found = signal_moments(model, kAll, 4, 30);
  for (std::size_t s = 0; s < kAll.size(); ++s) {
    for (std::size_t cell = 0; cell < expected[s].mean.size(); ++cell) {
      EXPECT_EQ(found[s].mean[cell], expected[s].mean[cell]);
      EXPECT_NEAR(found[s].variance[cell], expected[s].variance[cell], 1e-14 * expected[s].variance[cell]);
    }
  }
}

// Both theories of losses, and behind losses that never come that of none.
TEST(SignalMoments, OfLossesAreThoseOfEitherTheory) {
  constexpr std::size_t kFollowers = 4;
  constexpr std::int64_t kSteps = 60;
  for (const double q : {0.2, 1e-300}) {
    PlatoonModel model = eventful_platoon(3.2);
    model.default_vehicle().length = 4.0;
    model.default_vehicle().position().link.loss = LossModel{q, {}, {1.5, -0.8, 0.3}};
    const SignalLists signals = signal_lists(model, kAll, kFollowers);
    const std::vector<SignalMoments> found = signal_moments(model, kAll, kFollowers, kSteps),
                                     of_chain = chain_moments(model, signals, kSteps);
    PlatoonModel without = model;
    without.default_vehicle().position().link.loss.reset();
    const std::vector<SignalMoments> of_none = signal_moments(without, kAll, kFollowers, kSteps);
    for (std::size_t s = 0; s < kAll.size(); ++s) {
      const double largest = *std::max_element(found[s].variance.begin(), found[s].variance.end());
      ASSERT_GT(largest, 0.0);
      for (std::size_t cell = 0; cell < found[s].mean.size(); ++cell) {
        EXPECT_NEAR(of_chain[s].mean[cell], found[s].mean[cell], 1e-9) << kAll[s] << cell;
        EXPECT_NEAR(of_chain[s].variance[cell], found[s].variance[cell], 1e-11 * largest) << kAll[s] << cell;
        if (q > 0.1) continue;
        EXPECT_NEAR(of_none[s].mean[cell], found[s].mean[cell], 1e-9) << kAll[s] << cell;
        EXPECT_NEAR(of_none[s].variance[cell], found[s].variance[cell], 1e-12 * largest) << kAll[s] << cell;
      }
    }
  }
}

// Packets of a string that hears others, from a steady start: the values that a moving start adds.
TEST(SignalMoments, OfASteadyStartContainItsMotion) {
  PlatoonModel model = radio_platoon(0.7, 0.01, 0.02);
  model.start = Start::steady;
  model.default_vehicle().standstill_distance = 6.0;
  model.default_vehicle().length = 4.0;
  model.default_vehicle().position().link.delay = 1;
  model.default_vehicle().position().link.loss = LossModel{0.1, 3.0, {1.0}};
  const std::vector<std::string> names{"gap", "speed", "input"};
  const std::vector<SignalMoments> found = signal_moments(model, names, 2, 3);
  const double speed = model.leader.speed(0), headway = model.default_vehicle().headway * model.sample_period;
  for (std::size_t follower : {1, 2}) {
    const std::size_t first = (follower - 1) * 3;
    EXPECT_NEAR(found[0].mean[first], 2.0 + speed * (headway + model.sample_period), 1e-12);
    EXPECT_NEAR(found[1].mean[first], speed, 1e-12);
    EXPECT_NEAR(found[2].mean[first], 0.0, 1e-12);
  }
}

TEST(SignalMoments, ComeWithTheErrorsAtOnce) {
  PlatoonModel bursts = eventful_platoon(3.2);
  bursts.default_vehicle().position().link.loss = LossModel{0.2, 3.0, {1.0}};
  for (const PlatoonModel& model : {bursts, eventful_platoon(3.2)}) {
    const StringMoments found = string_moments(model, kAll, 3, 40);
    EXPECT_EQ(found.errors.mean, error_moments(model, 3, 40).mean);
    EXPECT_EQ(found.errors.variance, error_moments(model, 3, 40).variance);
    const std::vector<SignalMoments> expected = signal_moments(model, kAll, 3, 40);
    ASSERT_EQ(found.signals.size(), expected.size());
    for (std::size_t s = 0; s < kAll.size(); ++s) {
      EXPECT_EQ(found.signals[s].mean, expected[s].mean);
      EXPECT_EQ(found.signals[s].variance, expected[s].variance);
    }
    EXPECT_EQ(string_moments(model, {}, 3, 40).errors.variance, found.errors.variance);
    EXPECT_TRUE(string_moments(model, {}, 3, 40).signals.empty());
  }
}

}  // namespace
}  // namespace platoon
