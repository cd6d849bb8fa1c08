#include "stochastic_platoon/math/links/chain_moments.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "stochastic_platoon/math/links/linked_moments.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

PlatoonModel with_bursts(double probability, double mean_burst, const std::vector<double>& predictor) {
  PlatoonModel model = eventful_platoon(3.2);
  model.default_vehicle().position().link.loss = LossModel{probability, mean_burst, predictor};
  return model;
}

TEST(ChainMoments, OfIndependentLossesEqualThoseOfTheirTheory) {
  PlatoonModel model = with_bursts(0.2, 1.25, {1.5, -0.8, 0.3});
  VehicleModel truck = paper_platoon(4.0).default_vehicle();
  truck.position().link.loss = LossModel{0.3, {}, {1.0}};
  truck.position().link.delay = 2;
  truck.position().link.quantisation_step = 0.3;
  truck.position().link.noise_filter = TransferFunction(Eigen::Vector2d(0.8, 0.3), Eigen::Vector2d(1.0, -0.5));
  truck.initial_position = {-1.0, 2.0};
  model.types.push_back({"truck", truck});
  model.types.push_back({"plain", paper_platoon(3.6).default_vehicle()});
  model.string = {0, 1, 2, 0};
  const SignalMoments expected = linked_error_moments(model, 6, 60), found = chain_error_moments(model, 6, 60);
  for (std::size_t c = 0; c < expected.mean.size(); ++c) {
    EXPECT_NEAR(found.mean[c], expected.mean[c], 1e-12) << c;
    EXPECT_NEAR(found.variance[c], expected.variance[c], 1e-11 * expected.variance[c]) << c;
  }
}

TEST(ChainMoments, OfIndependentLossesOfInputsEqualThoseOfTheirTheory) {
  for (const std::vector<double>& predictor : {std::vector<double>{1.0}, {}, {1.5, -0.8, 0.3}}) {
    PlatoonModel model = radio_platoon(0.5, 0.01, 0.04, 3);
    add_trucks(model, 0.25, 0.213, 0.9);
    lose_inputs(model, 0.3, predictor);
    model.default_vehicle().position().link.loss = LossModel{0.1, {}, {2.0, -1.0}};
    model.default_vehicle().radio()->link.quantisation_step = 0.3;
    model.default_vehicle().initial_position = {-1.0, 2.0};
    const SignalMoments expected = linked_error_moments(model, 6, 60), found = chain_error_moments(model, 6, 60);
    for (std::size_t c = 0; c < expected.mean.size(); ++c) {
      EXPECT_NEAR(found.mean[c], expected.mean[c], 1e-12) << c;
      EXPECT_NEAR(found.variance[c], expected.variance[c], 1e-11 * expected.variance[c]) << c;
    }
  }
}

TEST(ChainMoments, SettleAtTheStationaryValues) {
  for (const PlatoonModel& model : {with_bursts(0.1, 2.0, {1.0}), with_bursts(0.1, 1.5, {2.0, -1.0})}) {
    const SignalMoments moments = chain_error_moments(model, 4, 400);
    const std::vector<double> variance = stationary_variances(model, 4), mean = stationary_means(model, 4);
    for (std::size_t i = 1; i <= 4; ++i) {
      EXPECT_NEAR(moments.variance_at(i, 399) / variance[i - 1], 1.0, 1e-10);
      EXPECT_NEAR(moments.mean_at(i, 399), mean[i - 1], 1e-10);
    }
  }
}

// One lost position of a vehicle at rest: the first step of the chain has its stationary probability.
TEST(ChainMoments, BeginWithTheStationaryChain) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().position().link.loss = LossModel{0.3, 4.0, {1.0}};
  const SignalMoments moments = chain_error_moments(model, 1, 2);
  EXPECT_EQ(moments.variance_at(1, 0), 0.0);
  PlatoonModel without = paper_platoon();
  EXPECT_NEAR(moments.variance_at(1, 1), 0.7 * error_moments(without, 1, 2).variance_at(1, 1), 1e-14);
}

// Before the first noise arrives, the variance is that of the initial position times a response that crosses 0.
TEST(ChainMoments, KeepTheirDigitsWhereTheInitialPositionsResponseCrossesZero) {
  PlatoonModel model = paper_platoon(1000.0);
  model.default_vehicle().initial_position.variance = 0.5;
  model.default_vehicle().position().link.delay = 60;
  const SignalMoments expected = linked_error_moments(model, 1, 60);
  model.default_vehicle().position().link.loss = LossModel{1e-14, 1e4, {1.0}};
  const SignalMoments found = chain_error_moments(model, 1, 60);
  for (std::int64_t k = 0; k < 60; ++k)
    EXPECT_NEAR(found.variance_at(1, k) / expected.variance_at(1, k), 1.0, 1e-12) << k;
}

TEST(ChainMoments, RejectRunsWithoutSteps) {
  const PlatoonModel model = with_bursts(0.1, 2.0, {1.0});
  EXPECT_THROW(chain_error_moments(model, 0, 5), std::invalid_argument);
  EXPECT_THROW(chain_error_moments(model, 1, 0), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
