#include "stochastic_platoon/math/string/stationary_signals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/math/example_loops.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

const std::vector<std::string> kAll = {"gap", "speed", "acceleration", "jerk", "relative_speed"};

// Delay, coloured noise, three types, a car with radio and losses, all with an effect of their own on the spectra.
std::vector<PlatoonModel> settling_platoons() {
  std::vector<PlatoonModel> models{paper_platoon(3.2), paper_platoon(2.4)};
  PlatoonModel mixed = paper_platoon(3.2);
  mixed.default_vehicle().position().link.delay = 3;
  VehicleType truck{"truck", mixed.default_vehicle(), {}};
  truck.vehicle.headway = 4.0;
  truck.vehicle.loop = paper_loop(4.0);
  truck.vehicle.length = 12.0;
  truck.vehicle.standstill_distance = 3.0;
  truck.vehicle.position().link = LinkModel{};
  truck.vehicle.position().link.noise_filter = TransferFunction(Eigen::Vector2d(1.0, 0.3), Eigen::Vector2d(1.0, -0.5));
  mixed.types.push_back(truck);
  mixed.string = {0, 1, 1};
  models.push_back(mixed);
  mixed.default_vehicle().position().link.delay = 400;
  models.push_back(mixed);
  models.push_back(radio_platoon(0.7, 0.01, 0.02));
  models.push_back(paper_platoon(3.6));
  models.back().default_vehicle().position().link.loss = LossModel{0.1, {}, {1.0}};
  models.push_back(radio_platoon(0.7, 0.01, 0.02));
  lose_inputs(models.back(), 0.2, {1.0});
  return models;
}

TEST(StationarySignals, EqualTheMomentsAfterManySteps) {
  constexpr std::size_t kFollowers = 7, kSteps = 9000;
  for (const PlatoonModel& model : settling_platoons()) {
    const bool stable = string_stability(model).string_stable;
    const std::vector<StationarySignal> found = stationary_signals(model, kAll, kFollowers, stable);
    const std::vector<SignalMoments> tables = signal_moments(model, kAll, kFollowers, kSteps);
    for (std::size_t s = 0; s < kAll.size(); ++s) {
      for (std::size_t i = 0; i < kFollowers; ++i) {
        const std::size_t last = (i + 1) * kSteps - 1;
        EXPECT_NEAR(found[s].followers.variance[i] / tables[s].variance[last], 1.0, 1e-10) << kAll[s] << i;
        EXPECT_NEAR(found[s].followers.mean[i], tables[s].mean[last], 2e-7) << kAll[s] << i;  // rounding of k v T_s
        if (tables[s].covariance_with_previous.empty()) continue;
        const double change = 2.0 * (tables[s].variance[last] - tables[s].covariance_with_previous[last]);
        EXPECT_NEAR(found[s].followers.change[i] / change, 1.0, 1e-9) << i;
      }
    }
  }
}

TEST(StationarySignals, HaveTheControlInput) {
  constexpr std::size_t kFollowers = 200, kSteps = 9000;
  const PlatoonModel model = radio_platoon(0.7, 0.01, 0.02);
  const std::vector<std::string> names{"speed", "input", "gap"};
  const std::vector<StationarySignal> found = stationary_signals(model, names, kFollowers, true);
  const std::vector<SignalMoments> tables = signal_moments(model, names, 3, kSteps);
  for (std::size_t s = 0; s < names.size(); ++s) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t last = (i + 1) * kSteps - 1;
      EXPECT_NEAR(found[s].followers.variance[i] / tables[s].variance[last], 1.0, 1e-9) << names[s] << i;
      EXPECT_NEAR(found[s].followers.mean[i], tables[s].mean[last], 1e-6) << names[s] << i;
    }
  }
  EXPECT_NEAR(found[1].followers.variance.back() / found[1].limit_variance().value(), 1.0, 1e-3);
}

TEST(StationarySignals, BehindLossesAreThoseOfSpectraAndOfCrossSpectra) {
  const std::vector<std::string> names{"gap", "speed", "acceleration"};
  PlatoonModel model = radio_platoon(0.7, 0.01, 0.02);
  lose_inputs(model, 0.2, {1.0});
  const std::vector<StationarySignal> expected = stationary_signals(model, names, 4, true),
                                      found = stationary_signals(*StringTheory::of(model, true), names, 4, true);
  for (std::size_t s = 0; s < names.size(); ++s) {
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(found[s].followers.variance[i] / expected[s].followers.variance[i], 1.0, 1e-8) << names[s] << i;
    EXPECT_NEAR(found[s].limit_variance().value() / expected[s].limit_variance().value(), 1.0, 1e-8) << names[s];
  }
}

// The distance to the limit after N vehicles decays like N^(-1/2), as 1 - |T|^2 and |1 - T|^2 begin with w^2.
TEST(StationarySignals, HaveAGapThatSettlesLate) {
  constexpr std::size_t kNear = 999, kFar = 3999;
  for (const PlatoonModel& model : settling_platoons()) {
    if (!string_stability(model).string_stable) continue;
    if (model.default_vehicle().position().link.delay > 100) continue;  // |1 - T|^2 oscillates before this decay begins
    const std::size_t places = pattern(model).size();
    const StationarySignal gap = stationary_signals(model, {"gap"}, kFar, true)[0];
    ASSERT_TRUE(gap.limit);
    ASSERT_EQ(gap.limit->variance.size(), places);
    for (std::size_t j = 0; j < places; ++j) {
      const auto rest = [&](std::size_t count) {
        return gap.limit->variance[j] - gap.followers.variance[count - places + j];
      };
      EXPECT_NEAR(rest(kNear) / rest(kFar), 2.0, 0.05);
      EXPECT_NEAR(gap.followers.change[kFar - places + j] / gap.limit->change[j], 1.0, 1e-3);
      EXPECT_EQ(gap.followers.mean[kFar - places + j], gap.limit->mean[j]);
    }
    EXPECT_GE(*gap.limit_variance(), gap.limit->variance.back());
  }
}

// z^m completes many periods on a panel. Reference: 80,000 nodes in extended precision.
TEST(StationarySignals, HaveALimitBehindALongDelay) {
  PlatoonModel model = paper_platoon(3.2);
  model.default_vehicle().position().link.delay = 400;
  const StationarySignal gap = stationary_signals(model, {"gap"}, 1, true)[0];
  EXPECT_NEAR(*gap.limit_variance() / 143.958325039119069, 1.0, 1e-11);
  EXPECT_NEAR(gap.limit->change[0] / 0.370994008700070659, 1.0, 1e-11);
}

TEST(StationarySignals, HaveTheLimitOfThePapersExample) {
  const StationarySignal gap = stationary_signals(paper_platoon(3.2), {"gap"}, 1, true)[0];
  EXPECT_NEAR(*gap.limit_variance(), 1.058477, 5e-7);
}

TEST(StationarySignals, HaveLimitsIfTheyVanishAtLowFrequencies) {
  const ExampleLoop flat = string_stable_loops().back();
  const PlatoonModel model = model_with(flat.loop, flat.headway);  // 1 - |T|^2 begins with w^4
  ASSERT_TRUE(string_stability(model).string_stable);
  const std::vector<StationarySignal> found = stationary_signals(model, kAll, 2, true);
  EXPECT_FALSE(found[0].limit_variance());
  EXPECT_FALSE(found[1].limit_variance());
  EXPECT_TRUE(found[2].limit_variance());
  EXPECT_TRUE(found[3].limit_variance());
  EXPECT_TRUE(found[4].limit_variance());
  // The same behind noise that vanishes like w^2.
  PlatoonModel differenced = model;
  differenced.default_vehicle().position().link.noise_filter =
      TransferFunction(Eigen::Vector2d(1.0, -1.0), Eigen::Vector2d(1.0, 0.0));
  EXPECT_TRUE(stationary_signals(differenced, {"gap"}, 2, true)[0].limit_variance());
}

TEST(StationarySignals, HaveNoLimitForAStringUnstablePlatoon) {
  for (const StationarySignal& signal : stationary_signals(paper_platoon(2.4), kAll, 3, false)) {
    EXPECT_FALSE(signal.limit);
    EXPECT_GT(signal.followers.variance[2], 0.0);
  }
}

TEST(StationarySignals, DoNotExistForAnUnstableVehicle) {
  const PlatoonModel model = paper_platoon(0.2);
  for (const StationarySignal& signal : stationary_signals(model, kAll, 3, false)) {
    for (const auto* values : {&signal.followers.mean, &signal.followers.variance, &signal.followers.change}) {
      ASSERT_EQ(values->size(), 3u);
      EXPECT_TRUE(std::isnan(values->front()));
    }
  }
}

TEST(StationarySignals, HaveTheMeansOfTheSpacingPolicy) {
  PlatoonModel model = paper_platoon(3.2);
  model.default_vehicle().standstill_distance = 5.0;
  model.default_vehicle().length = 4.5;
  model.default_vehicle().position().link.delay = 2;
  const std::vector<StationarySignal> found = stationary_signals(model, kAll, 2, true);
  // delta + (h + m) v T_s - length
  EXPECT_NEAR(found[0].followers.mean[1], 5.0 + (3.2 + 2.0) * 20.0 * 0.1 - 4.5, 1e-12);
  EXPECT_NEAR(found[1].followers.mean[1], 20.0, 1e-13);
  EXPECT_EQ(found[2].followers.mean[1], 0.0);
  EXPECT_EQ(found[3].followers.mean[1], 0.0);
  EXPECT_EQ(found[4].followers.mean[1], 0.0);
}

TEST(StationarySignals, RejectModelsWithoutTheory) {
  PlatoonModel model = paper_platoon();
  EXPECT_THROW(stationary_signals(model, kAll, 0, true), std::invalid_argument);
  EXPECT_THROW(stationary_signals(model, {"distance"}, 1, true), std::invalid_argument);
  model.default_vehicle().position().link.loss = LossModel{0.5, 1.0, {1.0}};
  EXPECT_THROW(stationary_signals(model, kAll, 1, true), std::invalid_argument) << "losses and arrivals alternate";
}

}  // namespace
}  // namespace platoon
