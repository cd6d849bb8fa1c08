#include "stochastic_platoon/math/string/hearing_string.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/settled_hearing.hpp"
#include "stochastic_platoon/math/string/settling_time.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "unit/messages.hpp"
#include "unit/run/report/hearing_models.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

// The expected values come from a Lyapunov equation of the whole string, solved by another program.
void expect_variances(const std::string& text, std::size_t followers, const std::vector<std::size_t>& at,
                      const std::vector<double>& expected) {
  const std::vector<double> found = stationary_variances(hearing_model(text), followers);
  for (std::size_t j = 0; j < at.size(); ++j) EXPECT_NEAR(found[at[j] - 1], expected[j], 6e-9) << at[j];
}

TEST(HearingString, HasTheVariancesOfTheWholeStringsLyapunovEquation) {
  expect_variances(kPath, 6, {1, 2, 6}, {0.03540309, 0.03782432, 0.04211542});
  expect_variances(kTwoAhead, 6, {1, 2, 6}, {0.00148782, 0.00153969, 0.00151800});
  expect_variances(kLeaderShare, 6, {1, 2, 6}, {0.00069842, 0.00085414, 0.00094506});
}

// Slow cars sampled at two kilohertz, of rho(A) = 0.99989. The expected values come from 2^21 equally spaced nodes.
TEST(HearingString, OfSlowCarsSampledFastHasVariances) {
  const PlatoonModel model = hearing_model(R"(
sample_period: 0.0005
time_headway_seconds: 3.5
standstill_distance: 5.0
plant: {actuator_lag: 0.1, input_delay: 0.05}
controller: {kp: 0.2, kd: 0.7}
inputs:
  - {signal: position, noise_variance: 0.01}
  - {signal: speed, from: leader, gain: 0.05, noise_variance: 0.01})");
  const std::vector<double> variances = stationary_variances(model, 2);
  EXPECT_NEAR(variances[0] / 0.000151793613886, 1.0, 1e-9);
  EXPECT_NEAR(variances[1] / 0.000151868975221, 1.0, 1e-9);
}

TEST(HearingString, HasTheSameVariancesOnPanelsAsOnEqualNodes) {
  Settling few = to_all_digits();
  few.most = 1;
  for (const char* const text : {kPath, kTwoAhead, kLeaderShare}) {
    const PlatoonModel model = hearing_model(text);
    const std::vector<double> on_panels = settled_hearing(
        model,
        [](const HearingSpectra& spectra) {
          HearingWalk walk(spectra);
          std::vector<double> variances;
          for (int i = 0; i < 6; ++i) {
            walk.pass(sum_of(walk.added()));
            variances.push_back(walk.error_variance());
          }
          return variances;
        },
        few);
    const std::vector<double> expected = stationary_variances(model, 6);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(on_panels[i] / expected[i], 1.0, 1e-12) << i;
  }
}

// Their correlation has no theory, with or without losses.
TEST(HearingString, HasNoVerdictOverTimeAsItsStandardErrorsAreMeasured) {
  Configuration configuration = paper_run("");
  configuration.model = hearing_model(kPath);
  configuration.run.followers = 2;
  configuration.run.steps = 0;
  configuration.run.burn_in = *settling_steps(configuration.model, 2);
  RunResult result = result_over_time();
  result.shares = {{0.1, 0.1, kNaN}, {0.1, 0.1, kNaN}};
  const auto says = [&](const std::string& reason) {
    return contains(report(configuration, predict(configuration), result), "No verdict: " + reason);
  };
  EXPECT_TRUE(says("the standard errors are measured, by batch means of the run; monte_carlo compares"));
  configuration.model.default_vehicle().inputs[1].link.loss = LossModel{0.1};
  EXPECT_TRUE(says("packets are lost, and averages over time may lack the rarest losses; monte_carlo compares"));
}

TEST(HearingString, LosesTheInputsOfAPacketTogether) {
  expect_variances(packet("{probability: 0.15, mean_burst: 4, on_loss: hold}"), 3, {1, 2, 3},
                   {0.00835016, 0.01240000, 0.01321199});
  expect_variances(packet("{markov: {transition: [[0.9, 0.1], [0.3, 0.7]], probability: [0.02, 0.7]}, on_loss: hold}"),
                   2, {1, 2}, {0.00694763, 0.00936369});
}

TEST(HearingString, IsJudgedByItsCompanionMatrix) {
  EXPECT_TRUE(string_stability(hearing_model(kPath)).string_stable);
  EXPECT_TRUE(string_stability(hearing_model(kLeaderShare)).string_stable);
  const StringStability two = string_stability(hearing_model(kTwoAhead));
  EXPECT_FALSE(two.string_stable);
  EXPECT_NEAR(two.peak_gain, 1.047857, 6e-7);
  EXPECT_NEAR(two.peak_frequency, 0.0262, 6e-5);
}

// Strings that hear the second vehicle ahead alone, and one in which every other vehicle does.
TEST(HearingString, IsNotStableIfItFallsApart) {
  const std::string second = R"(
sample_period: 0.1
time_headway: 20
standstill_distance: 5.0
plant: {actuator_lag: 0.1, input_delay: 0.2}
controller: {kp: 0.2, kd: 0.7, headway_filter: true}
inputs: [{signal: position, from: 2, noise_variance: 0.01}])";
  const PlatoonModel apart = hearing_model(second);
  const StringStability verdict = string_stability(apart);
  EXPECT_FALSE(verdict.string_stable || verdict.undecided || verdict.limit_variance);
  EXPECT_TRUE(contains(verdict.reason, "form strings that do not hear each other")) << verdict.reason;
  const std::vector<double> variances = stationary_variances(apart, 400);
  EXPECT_NEAR(variances[399] / variances[99], 2.0, 0.1) << "like the square root of the number of vehicles";
  EXPECT_TRUE(stable_headways(apart)->intervals.empty());
  for (const bool all : {true, false}) {
    const PlatoonModel types = hearing_model(
        second + "\nvehicle_types: {near: {inputs: [{signal: position, noise_variance: 0.02}]}}\nstring: [" +
        (all ? "default, default" : "default, near") + "]");
    EXPECT_EQ(string_stability(types).string_stable, !all) << string_stability(types).reason;
    EXPECT_EQ(string_stability(types).limit_variance.has_value(), !all);
  }
}

// The settled table and the spectra are computed in different ways.
TEST(HearingString, HasTablesThatSettleToTheStationaryValues) {
  for (const char* text : {kPath, kTwoAhead, kLeaderShare}) {
    const PlatoonModel model = hearing_model(text);
    constexpr std::int64_t kSteps = 3000;
    const SignalMoments table = error_moments(model, 6, kSteps);
    const std::vector<double> settled = stationary_variances(model, 6), means = stationary_means(model, 6);
    for (std::size_t i = 1; i <= 6; ++i) {
      EXPECT_NEAR(table.variance_at(i, kSteps - 1) / settled[i - 1], 1.0, 1e-9) << text << i;
      EXPECT_NEAR(table.mean_at(i, kSteps - 1), means[i - 1], 1e-8) << text << i;
    }
  }
}

TEST(HearingString, IsThatOfPredecessorsWhereTheyAreHeardAlone) {
  const PlatoonModel model = hearing_model(kRadioCar + R"(
  - {signal: input, gain: 1.0, noise_variance: 0.04, channel: {delay: 1, loss: {probability: 0.2, mean_burst: 3}}})");
  ASSERT_TRUE(hears_predecessors_only(model));
  const std::vector<double> expected = stationary_variances(model, 8),
                            found = stationary_variances(*StringTheory::of(model, true), 8);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(found[i] / expected[i], 1.0, 1e-10) << i;
  const StringStability one = string_stability(model), other = string_stability(*StringTheory::of(model, true));
  EXPECT_EQ(one.string_stable, other.string_stable);
  EXPECT_NEAR(*one.limit_variance / *other.limit_variance, 1.0, 1e-9);
  EXPECT_NEAR(*one.loss_gain, *other.loss_gain, 1e-6);
}

TEST(HearingString, NamesInputsThatAreNotAllowed) {
  const auto error_of = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return message_of<ConfigurationError>([&text] { hearing_model(text); });
  };
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(error_of(kTwoAhead, "weight: 0.4", "weight: 0.5"), "weights that sum to 1.1");
  expect(error_of(kTwoAhead, "from: 2", "from: 0"), "inputs[1]/from: 0: must be predecessor, leader");
  expect(error_of(kTwoAhead, "from: 2", "from: leader"), "a position from the leader");
  expect(error_of(kTwoAhead, "time_headway: 8", "spacing: constant\ntime_headway: 8"),
         "absent beside spacing: constant");
  expect(error_of(kPath, "gain: 0.3, ", ""), "inputs[3]/gain: missing");
  expect(error_of(kLeaderShare, "channel: {delay: 1}", "channel: {delay: 0}"), "delay: 0: must be 1 or more");
  expect(error_of(packet("{probability: 0.15}"), "channel: {packet: radio}}",
                  "channel: {packet: radio, loss: {probability: 0.2}}}"),
         "different losses in packet radio");
  expect(error_of(kPath, "gain: 0.3, ", "gain: -0.3, "), "unstable: rho(A) = 1.0");
}

TEST(HearingString, IsWrittenAsItIsRead) {
  for (const std::string& text : {std::string(kPath), std::string(kTwoAhead), packet("{probability: 0.1}")}) {
    const nlohmann::json once = to_json(hearing_model(text));
    EXPECT_EQ(to_json(parse_model(YAML::Load(once.dump()))), once) << text;
  }
}

// Beside the border the spectra are so narrow that the limit has no finite value on the most frequencies.
TEST(HearingString, IsNotCalledUnstableWhereItsLimitIsNotFinite) {
  for (const char* burst : {"194.5", "194.7"}) {
    const StringStability verdict = string_stability(hearing_model(std::string(R"(
sample_period: 0.1
time_headway: 7.641320407317512
standstill_distance: 2.0
plant: {actuator_lag: 0.3762882313038186}
controller: {kp: 0.594979982165296, kd: 0.985308069558926}
inputs:
  - {signal: position, weight: 0.5132621448798549, noise_variance: 0.0}
  - {signal: position, from: 3, weight: 0.4867378551201451, noise_variance: 0.17}
  - {signal: speed, from: 3, gain: 0.1917153882505096, noise_variance: 0.08, channel: {loss: {probability: 0.08973063118304044, mean_burst: )") +
                                                                   burst + "}}}"));
    EXPECT_TRUE(verdict.string_stable) << verdict.reason;
  }
}

TEST(HearingString, IsReachedByTheLeaderOnTheShortestWay) {
  EXPECT_EQ(steps_from_leader(hearing_model(kPath), 4), (std::vector<std::int64_t>{0, 1, 1, 1}));
  EXPECT_EQ(steps_from_leader(hearing_model(kTwoAhead), 5), (std::vector<std::int64_t>{0, 1, 1, 2, 2}));
  EXPECT_EQ(steps_from_leader(hearing_model(kRadioCar), 3), (std::vector<std::int64_t>{0, 1, 2}));
}

}  // namespace
}  // namespace platoon
