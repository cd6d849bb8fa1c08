#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <variant>
#include <vector>

#include "stochastic_platoon/math/response/loop_margins.hpp"
#include "stochastic_platoon/math/string/critical_burst.hpp"
#include "stochastic_platoon/math/string/critical_delay.hpp"
#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/math/string/critical_leader_share.hpp"
#include "stochastic_platoon/math/string/critical_loss.hpp"
#include "stochastic_platoon/math/string/hearing_gain.hpp"
#include "stochastic_platoon/math/string/hearing_string.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "stochastic_platoon/math/string/stationary_signals.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/run/report/hearing_models.hpp"

namespace platoon {
namespace {

const std::vector<std::string> kSignals{"gap", "speed", "acceleration", "jerk", "relative_speed"};

PlatoonModel radio_car(const std::string& loss = "") {
  return hearing_model(kRadioCar + R"(
  - {signal: input, gain: 1.0, noise_variance: 0.04, channel: {delay: 1)" +
                       loss + "}}");
}

// A string of predecessors alone has both theories.
TEST(HearingFigures, OfStringsOfPredecessorsEqualThoseOfTheirTheory) {
  const PlatoonModel model = radio_car(), lossy = radio_car(", loss: {probability: 0.2, mean_burst: 3}");
  const std::vector<StationarySignal> expected = stationary_signals(model, kSignals, 5, true),
                                      found = stationary_signals(*StringTheory::of(model, true), kSignals, 5, true);
  for (std::size_t s = 0; s < kSignals.size(); ++s) {
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_NEAR(found[s].followers.variance[i] / expected[s].followers.variance[i], 1.0, 1e-9) << kSignals[s] << i;
      EXPECT_NEAR(found[s].followers.change[i] / expected[s].followers.change[i], 1.0, 1e-9) << kSignals[s] << i;
      EXPECT_NEAR(found[s].followers.mean[i], expected[s].followers.mean[i], 1e-9) << kSignals[s] << i;
    }
  }
  for (std::size_t s = 0; s < kSignals.size(); ++s) {
    EXPECT_NEAR(*found[s].limit_variance() / *expected[s].limit_variance(), 1.0, 1e-9) << kSignals[s];
    EXPECT_NEAR(found[s].limit->change[0] / expected[s].limit->change[0], 1.0, 1e-9) << kSignals[s];
    EXPECT_NEAR(found[s].limit->mean[0], expected[s].limit->mean[0], 1e-9) << kSignals[s];
  }
  const auto shares = stationary_variances_by_input(*StringTheory::of(lossy), 5),
             of_hearing = stationary_variances_by_input(*StringTheory::of(lossy, true), 5);
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t n = 0; n < 2; ++n) EXPECT_NEAR(of_hearing[i][n] / shares[i][n], 1.0, 1e-9) << i << n;
  }
  const LoopMargins one = loop_margins(model).value(), other = loop_margins(model.default_vehicle(), 3, 0.1).value();
  EXPECT_NEAR(other.phase, one.phase, 1e-9);
  EXPECT_NEAR(other.delay, one.delay, 1e-9);
  EXPECT_NEAR(other.sensitivity_peak, one.sensitivity_peak, 1e-9);
  EXPECT_NEAR(other.peak_frequency, one.peak_frequency, 1e-6);
  const double critical = stable_headways(model)->critical.value();
  EXPECT_GT(HearingTheory(with_headway(model, critical * (1.0 + 1e-6))).gain_margin(), 0.0);
  EXPECT_LT(HearingTheory(with_headway(model, critical * (1.0 - 1e-6))).gain_margin(), 0.0);
}

TEST(HearingFigures, MarginOfTheStringHasTheSignOfTheVerdict) {
  const PlatoonModel near = radio_car(", loss: {probability: 0.1}"), far = hearing_model(kTwoAhead);
  const double critical = stable_headways(near)->critical.value(), loss = stable_losses(near)->critical.value();
  for (const PlatoonModel& stable :
       {with_headway(near, critical * 1.001), with_loss(near, loss * 0.999), with_headway(far, 20.0),
        with_headway(hearing_model(packet("{probability: 0.1}")), 12.0)}) {
    EXPECT_TRUE(string_stability(stable).string_stable &&
                string_stability(*StringTheory::of(stable), false).string_stable);
    EXPECT_FALSE(string_stability(*StringTheory::of(stable), false).limit_variance);
    EXPECT_GT(string_margin(stable), 0.0);
  }
  for (const PlatoonModel& unstable : {with_headway(near, critical * 0.999), with_loss(near, loss * 1.001), far}) {
    EXPECT_FALSE(string_stability(unstable).string_stable ||
                 string_stability(*StringTheory::of(unstable), false).string_stable);
    EXPECT_LT(string_margin(unstable), 0.0);
  }
  const double at = string_margin(with_headway(near, critical * 1.001)),
               behind = string_margin(with_headway(near, critical * 1.002));
  EXPECT_NEAR(behind / at, 2.0, 0.1) << "from 0 at the border";
}

TEST(HearingFigures, GainAlongTheStringHasItsPeakAndIsThatOfPredecessorsWhereTheyAreHeardAlone) {
  const PlatoonModel two = hearing_model(kTwoAhead);
  const StringStability verdict = string_stability(two);
  EXPECT_NEAR(StringTheory::of(two)->gains({verdict.peak_frequency}).front(), verdict.peak_gain, 1e-12);
  const PlatoonModel radio = hearing_model(kRadioCar + R"(
  - {signal: input, gain: 0.8, noise_variance: 0.04, channel: {delay: 2, loss: {probability: 0.2, mean_burst: 3}}}
vehicle_types: {slow: {time_headway: 9, plant: {actuator_lag: 0.5}}}
string: [default, slow, slow])");
  ASSERT_TRUE(hears_predecessors_only(radio));
  const HearingGain other(radio);
  const std::vector<double> frequencies = {0.01, 0.1, 0.3, 1.0, 3.0};
  const std::vector<double> gains = StringTheory::of(radio)->gains(frequencies);
  for (std::size_t k = 0; k < gains.size(); ++k) EXPECT_NEAR(gains[k] / other(frequencies[k]), 1.0, 1e-10) << k;
}

TEST(HearingFigures, SharesSumToTheVariance) {
  for (const PlatoonModel& model :
       {hearing_model(kPath), hearing_model(packet("{probability: 0.15, mean_burst: 4, on_loss: hold}"))}) {
    const std::vector<std::vector<double>> shares = stationary_variances_by_input(*StringTheory::of(model), 4);
    const std::vector<double> variances = stationary_variances(model, 4);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(std::accumulate(shares[i].begin(), shares[i].end(), 0.0) / variances[i], 1.0, 1e-8) << i;
      EXPECT_GT(*std::min_element(shares[i].begin(), shares[i].end()), 0.0);
    }
  }
}

// The settled tables and the spectra are computed in different ways.
TEST(HearingFigures, SignalsSettleToTheirStationaryValues) {
  std::vector<std::string> names = kSignals;
  names.push_back("input");
  for (const char* text : {kPath, kTwoAhead, kLeaderShare}) {
    const PlatoonModel model = hearing_model(text);
    constexpr std::size_t kFollowers = 4, kSteps = 2500;
    const std::vector<SignalMoments> tables = signal_moments(model, names, kFollowers, kSteps);
    const std::vector<StationarySignal> settled = stationary_signals(model, names, kFollowers, true);
    for (std::size_t s = 0; s < names.size(); ++s) {
      for (std::size_t i = 0; i < kFollowers; ++i) {
        const std::size_t cell = i * kSteps + kSteps - 1;
        EXPECT_NEAR(tables[s].variance[cell] / settled[s].followers.variance[i], 1.0, 1e-8) << text << names[s] << i;
        EXPECT_NEAR(tables[s].mean[cell], settled[s].followers.mean[i], 1e-6) << text << names[s] << i;
      }
    }
  }
}

// Unlike cars, of which each hears the leader: the far ones differ from the endless string by a power of their number.
TEST(HearingFigures, SignalsOfFarVehiclesAreThoseOfAnEndlessString) {
  const PlatoonModel model = hearing_model(std::string(kLeaderShare) + R"(
vehicle_types: {slow: {plant: {actuator_lag: 0.3}}}
string: [default, slow, slow])");
  ASSERT_TRUE(string_stability(model).string_stable);
  constexpr std::size_t kFollowers = 60;
  const std::vector<StationarySignal> found = stationary_signals(model, kSignals, kFollowers, true);
  for (std::size_t s = 0; s < kSignals.size(); ++s) {
    ASSERT_TRUE(found[s].limit.has_value());
    for (std::size_t p = 0; p < 3; ++p) {
      const StationaryMoments &limit = *found[s].limit, &far = found[s].followers;
      EXPECT_NEAR(far.variance[kFollowers - 3 + p] / limit.variance[p], 1.0, 1e-6) << kSignals[s] << p;
      EXPECT_NEAR(far.change[kFollowers - 3 + p] / limit.change[p], 1.0, 1e-6) << kSignals[s] << p;
      EXPECT_NEAR(far.mean[kFollowers - 3 + p], limit.mean[p], 1e-6) << kSignals[s] << p;
    }
    EXPECT_GT(std::abs(found[s].followers.variance[0] / found[s].limit->variance[0] - 1.0), 1e-3) << kSignals[s];
  }
  EXPECT_FALSE(stationary_signals(hearing_model(kTwoAhead), kSignals, 2, false).front().limit.has_value());
  PlatoonModel apart = model;
  apart.types.back().vehicle.standstill_distance = 7.0;  // i times 7 m behind the leader, among others of 5 m
  const StationaryMoments limit = *stationary_signals(apart, {"gap"}, 2, true).front().limit;
  EXPECT_TRUE(std::isnan(limit.mean[0])) << "the mean gaps of such a string grow with the number of vehicles";
  EXPECT_TRUE(std::isfinite(limit.variance[0]));
}

TEST(HearingFigures, MarginsAreWhereTheLoopBecomesUnstable) {
  for (const char* text : {kTwoAhead, kLeaderShare, kPath}) {
    const PlatoonModel model = hearing_model(text);
    const LoopMargins margins = loop_margins(model).value();
    ASSERT_FALSE(std::isnan(margins.delay));
    for (const double share : {0.999, 1.001}) {
      PlatoonModel delayed = model;
      LoopDesign& design = *delayed.default_vehicle().design;
      ContinuousPlant plant = std::get<ContinuousPlant>(design.plant.given());
      plant.input_delay += share * margins.delay * model.sample_period;
      design.plant = Plant(plant, model.sample_period);
      EXPECT_EQ(string_stability(delayed).mean_square_stable, share < 1.0) << text << share;
    }
  }
}

TEST(HearingFigures, CriticalValuesAreWhereTheVerdictChanges) {
  const PlatoonModel two = hearing_model(kTwoAhead),
                     bursts = hearing_model(packet("{probability: 0.15, mean_burst: 4}"));
  const std::vector<HeadwayInterval> intervals = stable_headways(two)->intervals;
  ASSERT_FALSE(intervals.empty());
  const double headway = intervals.front().from;
  EXPECT_GT(headway, two.default_vehicle().headway);
  EXPECT_TRUE(string_stability(with_headway(two, headway * (1.0 + 1e-6))).string_stable);
  EXPECT_FALSE(string_stability(with_headway(two, headway * (1.0 - 1e-6))).string_stable);
  EXPECT_FALSE(stable_headways(hearing_model(kPath)).has_value());
  const double lossy = stable_headways(bursts)->critical.value();
  EXPECT_TRUE(string_stability(with_headway(bursts, lossy * (1.0 + 1e-6))).string_stable);
  EXPECT_FALSE(string_stability(with_headway(bursts, lossy * (1.0 - 1e-6))).string_stable);
}

// A lost value counts as 0, or is held: the gain alone is judged, or the loss gain, too.
TEST(HearingFigures, CriticalLossesAreWhereTheVerdictChanges) {
  const PlatoonModel zero = hearing_model(packet("{probability: 0.15, mean_burst: 4, on_loss: zero}"));
  const std::vector<StableInterval> intervals = stable_losses(zero)->intervals;
  ASSERT_FALSE(intervals.empty());
  const auto with = [](const char* loss) { return hearing_model(packet(loss)); };
  EXPECT_NEAR(intervals.front().from, 0.069645, 1e-6);
  EXPECT_TRUE(string_stability(with("{probability: 0.069646, mean_burst: 4, on_loss: zero}")).string_stable);
  EXPECT_FALSE(string_stability(with("{probability: 0.069644, mean_burst: 4, on_loss: zero}")).string_stable);
  const double burst = critical_mean_burst(zero)->critical.value();
  const StringStability shorter = string_stability(with_mean_burst(zero, burst * (1.0 - 1e-6))),
                        longer = string_stability(with_mean_burst(zero, burst * (1.0 + 1e-6)));
  EXPECT_TRUE(shorter.string_stable);
  EXPECT_FALSE(longer.string_stable);
  EXPECT_NEAR(longer.loss_gain.value(), 1.0, 1e-5) << "it is the loss gain that decides";
}

TEST(HearingFigures, CriticalDelayOfTheRadioIsWhereTheVerdictChanges) {
  const PlatoonModel path = hearing_model(kPath);
  const double delay = critical_delay(path).steps.value();
  EXPECT_NEAR(delay, 12.667, 1e-3);  // [steps]
  for (const std::int64_t steps : {12, 13}) {
    PlatoonModel delayed = path;
    for (Input& input : delayed.default_vehicle().inputs) {
      if (input.signal != InputSignal::position && input.ahead == 1) input.link.delay = steps;
    }
    EXPECT_EQ(string_stability(delayed).string_stable, static_cast<double>(steps) < delay) << steps;
  }
  EXPECT_EQ(critical_delay(hearing_model(kTwoAhead)).reason, "there is no radio");
}

TEST(HearingFigures, CriticalWeightOfTheLeaderIsWhereTheVerdictChanges) {
  const PlatoonModel model = hearing_model(kLeaderShare);
  const StableLeaderShares found = stable_leader_shares(model).value();
  const double share = found.critical.value();
  EXPECT_GT(share, 0.0);
  EXPECT_LT(share, 0.3);
  EXPECT_TRUE(string_stability(with_leader_share(model, share + 1e-7)).string_stable);
  EXPECT_FALSE(string_stability(with_leader_share(model, share - 1e-7)).string_stable);
  EXPECT_EQ(found.types, std::vector<std::string>{"default"});
  const std::vector<Input> inputs = with_leader_share(model, 0.6).default_vehicle().inputs;
  EXPECT_NEAR(inputs[0].gain, 0.4, 1e-15);
  EXPECT_NEAR(inputs[1].gain, 0.6, 1e-15);
  EXPECT_EQ(inputs[2].gain, 0.4) << "of the control input";
  EXPECT_FALSE(stable_leader_shares(hearing_model(kPath)).has_value());
}

}  // namespace
}  // namespace platoon
