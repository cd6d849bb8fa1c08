#include "stochastic_platoon/run/report/age_analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "stochastic_platoon/run/report/analysis_report.hpp"
#include "unit/messages.hpp"
#include "unit/paper_run.hpp"
#include "unit/run/report/hearing_models.hpp"

namespace platoon {
namespace {

TEST(AgeAnalysis, HasTheProbabilitiesOfEveryInput) {
  const nlohmann::json ages = ages_to_json(hearing_model(packet("{probability: 0.2}")), 2);
  ASSERT_EQ(ages.at("inputs").size(), 2u);
  const nlohmann::json &second = ages["inputs"][1], radio = second.at(1);
  EXPECT_EQ(second.size(), 3u);
  EXPECT_EQ(second[0], nlohmann::json({1.0})) << "the radar loses nothing";
  for (std::size_t n = 0; n < 10; ++n)
    EXPECT_NEAR(radio.at(n).get<double>(), 0.8 * std::pow(0.2, static_cast<double>(n)), 1e-15);
  EXPECT_EQ(second[2], radio) << "the packet";
  EXPECT_EQ(ages.at("position").at(1), second[0]);
  const nlohmann::json of_radio = ages_to_json(
      hearing_model(
          kRadioCar +
          "\n  - {signal: input, gain: 1.0, noise_variance: 0.04, channel: {delay: 1, loss: {probability: 0.2}}}"),
      2);
  EXPECT_EQ(of_radio.at("input").at(1), radio);
  EXPECT_EQ(of_radio.at("inputs").at(1).at(1), radio);
  const nlohmann::json of_three = ages_to_json(
      hearing_model(
          kRadioCar +
          "\n  - {signal: input, gain: 1.0, noise_variance: 0.04, channel: {delay: 1, loss: {probability: 0.2}}}"
          "\n  - {signal: speed, from: leader, gain: 0.1, noise_variance: 0.04, channel: {loss: {probability: 0.05}}}"),
      2);
  EXPECT_EQ(of_three.at("input").at(1), radio);
  EXPECT_TRUE(ages_to_json(hearing_model(kPath), 2).is_null());
}

TEST(AgeAnalysis, HasNoneOfATrace) {
  PlatoonModel model = hearing_model(packet("{probability: 0.2}"));
  for (Input& input : model.default_vehicle().inputs) {
    if (input.link.loses()) input.link.loss->trace = std::make_shared<LossTrace>(LossTrace::of_runs("3 2"));
  }
  EXPECT_EQ(ages_to_json(model, 1).at("inputs").at(0), nlohmann::json({{1.0}, nullptr, nullptr}));
  EXPECT_EQ(age_report(model), "");
}

TEST(AgeAnalysis, IsPartOfTheAnalysisAsAreTheWeightsAndTypesOfCriticalValues) {
  Configuration configuration = paper_run("");
  configuration.run.followers = 2;
  configuration.run.steps = 5;
  configuration.model = hearing_model(std::string(kLeaderShare) + "\n");
  configuration.model.default_vehicle().inputs[2].link.loss = LossModel{0.1};
  const Analysis analysis = analyze(configuration, {});
  const nlohmann::json document = to_json(configuration, analysis), types = {"default"};
  EXPECT_EQ(document.at("age_of_information"), ages_to_json(configuration.model, 2));
  EXPECT_EQ(document.at("critical_leader_share"), analysis.leader_shares.value().critical.value());
  EXPECT_EQ(document.at("stable_leader_shares").size(), analysis.leader_shares->intervals.size());
  EXPECT_EQ(document.at("critical_loss_types"), types);
  EXPECT_TRUE(document.at("critical_headway_types").is_null()) << "of a constant spacing";
}

// The text of an analysis without the variances, and without that of an endless string.
TEST(AnalysisOfHearing, SaysWhyVariancesAreMissing) {
  Configuration configuration = paper_run("");
  configuration.run.followers = 2;
  configuration.run.steps = 5;
  configuration.model = hearing_model(kLeaderShare);
  Analysis analysis = analyze(configuration);
  ASSERT_EQ(analysis.not_computed, "");
  ASSERT_TRUE(contains(report(configuration, analysis), "of which "));
  analysis.not_computed = "not computed: too narrow";
  EXPECT_TRUE(contains(report(configuration, analysis), "; of an endless string: not computed: too narrow\nof which "));
  analysis.stationary_variance.assign(2, std::nan(""));
  const std::string text = report(configuration, analysis);
  EXPECT_TRUE(contains(text, "Stationary variance: not computed: too narrow\n"));
  EXPECT_FALSE(contains(text, "of which "));
}

}  // namespace
}  // namespace platoon
