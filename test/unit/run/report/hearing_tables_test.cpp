#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/rare/conditioned_gaps.hpp"
#include "stochastic_platoon/math/simulation/platoon_string.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "unit/agreement_of.hpp"
#include "unit/monte_carlo.hpp"
#include "unit/run/report/hearing_models.hpp"

namespace platoon {
namespace {

// Positions of two vehicles, all signals, packets, losses of three kinds, a speed that is 0 if lost, coloured noise,
// quantisation, unlike cars.
const std::string kAllKinds = R"(
sample_period: 0.1
time_headway: 7
standstill_distance: 3.0
plant: {actuator_lag: 0.3, input_delay: 0.1}
controller: {kp: 0.4, kd: 1.1, headway_filter: true}
own_acceleration: -0.1
inputs:
  - {signal: input, from: 2, gain: 0.2, noise_variance: 0.01, channel: {delay: 2, loss: {probability: 0.3, on_loss: zero}}}
  - {signal: position, weight: 0.7, noise_variance: 0.02, channel: {delay: 1, quantisation_step: 0.1, loss: {probability: 0.1, on_loss: extrapolate}}}
  - {signal: position, from: 3, weight: 0.3, noise_variance: 0.05, channel: {noise_filter: {numerator: [1.0], denominator: [1.0, -0.5]}}}
  - {signal: speed, from: leader, gain: 0.1, noise_variance: 0.03, channel: {packet: a, loss: {probability: 0.2, mean_burst: 3}}}
  - {signal: acceleration, from: leader, gain: 0.1, noise_variance: 0.03, channel: {packet: a, delay: 1}}
  - {signal: speed, gain: 0.2, noise_variance: 0.02, channel: {packet: b, loss: {markov: {transition: [[0.9, 0.1], [0.3, 0.7]], probability: [0.02, 0.7]}, on_loss: zero}}}
  - {signal: acceleration, gain: 0.1, noise_variance: 0.03, channel: {packet: b}}
vehicle_types:
  truck: {time_headway: 9, standstill_distance: 5.0, plant: {actuator_lag: 0.5}}
  human: {time_headway: 15, inputs: [{signal: position, noise_variance: 0.02, channel: {loss: {probability: 0.2, on_loss: hold}}}]}
string: [default, truck, human, default])";

PlatoonModel all_kinds(const std::string& start, const std::string& change = ", {from_step: 15, value: 22.0}") {
  return parse_model(YAML::Load(kAllKinds + "\ninitial_position: {mean: 0.5, variance: 0.3}\nstart: " + start +
                                "\nleader: {speed: [{from_step: 0, value: 20.0}" + change + "]}\n"));
}

PlatoonModel without_losses(PlatoonModel model) {
  for (VehicleType& type : model.types) {
    for (Input& input : type.vehicle.inputs) input.link.loss.reset();
  }
  return model;
}

TEST(HearingTables, OfTheCovarianceEqualThoseOfTheResponsesWithoutLosses) {
  for (const PlatoonModel& model : {without_losses(all_kinds("rest")), without_losses(all_kinds("steady")),
                                    hearing_model(kPath), hearing_model(kLeaderShare)}) {
    const SignalMoments expected = error_moments(model, 6, 50), found = chain_error_moments(model, 6, 50);
    for (std::size_t c = 0; c < expected.mean.size(); ++c) {
      EXPECT_NEAR(found.mean[c], expected.mean[c], 1e-9) << c;
      EXPECT_NEAR(found.variance[c], expected.variance[c], 1e-11 * expected.variance[c] + 1e-30) << c;
    }
  }
}

TEST(HearingTables, SettleToTheStationaryValuesBehindLosses) {
  for (const PlatoonModel& model :
       {all_kinds("steady", ""),
        hearing_model(packet("{probability: 0.15, mean_burst: 4, on_loss: hold}") + "\nstart: steady")}) {
    constexpr std::int64_t kSteps = 500;
    const std::size_t followers = 2;
    const SignalMoments table = chain_error_moments(model, followers, kSteps);
    const std::vector<double> settled = stationary_variances(model, followers),
                              means = stationary_means(model, followers);
    for (std::size_t i = 1; i <= followers; ++i) {
      EXPECT_NEAR(table.variance_at(i, kSteps - 1) / settled[i - 1], 1.0, 1e-7) << i;
      EXPECT_NEAR(table.mean_at(i, kSteps - 1), means[i - 1], 1e-6) << i;
    }
  }
}

// The scores of variances assume normal values, which those behind losses are not: their limit is wide.
TEST(HearingTables, AreThoseOfTheSimulation) {
  for (const char* start : {"rest", "steady"}) {
    const PlatoonModel model = all_kinds(start);
    constexpr std::size_t kFollowers = 6;
    constexpr std::int64_t kSteps = 40;
    const SignalMoments expected = chain_error_moments(model, kFollowers, kSteps);
    constexpr std::uint64_t kRealizations = 20000;
    const EnsembleTotals totals = monte_carlo(model, {5, kFollowers, kSteps, 500}, kRealizations, 2);
    const std::vector<Moments> measured = totals.moments.totals();
    double largest_mean = 0.0, largest_variance = 0.0;
    for (std::size_t c = 0; c < measured.size(); ++c) {
      if (expected.variance[c] == 0.0) continue;
      const double error = std::sqrt(expected.variance[c] / kRealizations);
      largest_mean = std::max(largest_mean, std::abs(measured[c].mean - expected.mean[c]) / error);
      largest_variance = std::max(largest_variance, std::abs(measured[c].variance() / expected.variance[c] - 1.0));
    }
    EXPECT_LT(largest_mean, 4.5) << start;
    EXPECT_GT(largest_mean, 1.0) << start;
    EXPECT_LT(largest_variance, 0.06) << start;
  }
}

// Of any noise and any initial position: a simulation with the shifted noise has the gap that is conditioned on, and
// all its gaps are those of the simulation without the shift plus C(., tau) / C(tau, tau) (x - gap(tau)).
TEST(HearingTables, HaveTheLawOfTheGapsOfConditionedRealizations) {
  PlatoonModel model = without_losses(all_kinds("steady"));
  for (VehicleType& type : model.types) {
    for (Input& input : type.vehicle.inputs) input.link.quantisation_step = 0.0;
  }
  constexpr std::size_t kFollowers = 10;  // more than the three with too few ahead and two patterns of four
  constexpr std::int64_t kSteps = 30;
  const GapLaw law(model, kFollowers, kSteps);
  const std::vector<Eigen::MatrixXd> covariances = law.covariances();
  const ConditionedGaps conditioned(model, {7, kFollowers, kSteps, -3.0});
  for (std::size_t i = 1; i <= kFollowers; ++i) {
    const Eigen::MatrixXd& covariance = covariances[i - 1];
    for (Eigen::Index k = 0; k < kSteps; ++k) {
      const double expected = law.variance(i, static_cast<std::size_t>(k));
      EXPECT_NEAR(covariance(k, k), expected, 1e-11 * expected) << i << " " << k;
    }
    const Signal gap = signals_of(model, {kGap}, i).requested[0];
    const auto gaps = [&](const WhiteNoise& noise) {
      Eigen::VectorXd values(kSteps);
      PlatoonString(model, noise, i).run(3, 1, kSteps, [&](std::size_t at, std::int64_t k, const SignalPositions& p) {
        if (at == i) values(k) = p.of(gap).front();
      });
      return values;
    };
    const Eigen::VectorXd shifted = gaps(WhiteNoise(7, conditioned.replay(i - 1, 3))), moved = shifted - gaps(7);
    Eigen::Index lowest;
    ASSERT_LT(shifted.minCoeff(&lowest), -3.0) << i;
    double best = 1e9;
    for (Eigen::Index tau = 0; tau < kSteps; ++tau) {
      if (shifted(tau) >= -3.0) continue;
      best = std::min(best, (moved - covariance.col(tau) * (moved(tau) / covariance(tau, tau))).norm());
    }
    EXPECT_LT(best, 1e-9 * moved.norm()) << i;
  }
}

}  // namespace
}  // namespace platoon
