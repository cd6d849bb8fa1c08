#include "stochastic_platoon/run/configuration/configuration.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/math/string/settling_time.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/run/configuration/configuration_fixture.hpp"

namespace platoon {
namespace {

TEST_F(ConfigurationTest, IsTheModelFileWithDefaultSettings) {
  for (const Settings& settings : {Settings{}, Settings{{"headway", ""}, {"noise_variance", ""}}}) {
    EXPECT_EQ(vehicle_with(settings).headway, 3.2);
    EXPECT_EQ(vehicle_with(settings).position().noise_variance, 0.6);
    EXPECT_EQ(configured(settings).run.followers, 20u);
  }
}

TEST_F(ConfigurationTest, IsOverriddenByTheGivenSettings) {
  const Configuration configuration =
      configured({{"headway", "2.4"}, {"noise_variance", "0.1"}, {"followers", "3"}, {"steps", "7"}});
  EXPECT_EQ(configuration.model.default_vehicle().headway, 2.4);
  EXPECT_EQ(configuration.model.default_vehicle().loop.realization.a(),
            paper_platoon(2.4).default_vehicle().loop.realization.a());
  EXPECT_EQ(configuration.model.default_vehicle().position().noise_variance, 0.1);
  EXPECT_EQ(configuration.run.followers, 3u);
  EXPECT_EQ(configuration.run.steps, 7);
}

TEST_F(ConfigurationTest, NamesAnInvalidSetting) {
  EXPECT_EQ(problems_with({{"headway", "-1"}}), Problems{"model/time_headway: -1: must be a finite number > 0"});
  EXPECT_EQ(problems_with({{"noise_variance", "x"}}),
            Problems{"model/noise_variance: x: must be a finite number >= 0"});
}

TEST_F(ConfigurationTest, ReportsTheErrorsOfModelAndRunAtOnce) {
  const Problems problems = problems_with({{"headway", "0"}, {"followers", "0"}, {"steps", "-1"}});
  EXPECT_EQ(problems.size(), 3u);
  EXPECT_TRUE(is_among(problems, "model/time_headway: 0: must be a finite number > 0"));
  EXPECT_TRUE(is_among(problems, "run/followers: 0: must be a whole number from 1 to 1000000"));
}

TEST_F(ConfigurationTest, TheDefaultStepsAreTenSecondsOfDriving) {
  const auto steps = [this](const std::string& sample_period, Settings given) {
    given["model"] = folder_.file("car.yaml", model_text_with("sample_period: 0.1", "sample_period: " + sample_period));
    return configured(given).run.steps;
  };
  EXPECT_EQ(configured({}).run.steps, 100) << "the paper's example";
  EXPECT_EQ(steps("0.01", {}), 1000);
  EXPECT_EQ(steps("0.01", {{"steps", "100"}}), 100);
  EXPECT_EQ(steps("0.5", {}), 100) << "the fewest";
  EXPECT_EQ(steps("1e-6", {}), 10000) << "the most";
  EXPECT_EQ(steps("0.001", {{"followers", "10000"}}), 2000) << "of 20,000,000 cells";
  EXPECT_EQ(steps("0.001", {{"followers", "2000"}, {"loss", "0.1"}}), 2500) << "of 1e10 responses to losses";
  EXPECT_EQ(steps("1e-6", {{"realizations", "70368744177664"}}), 3120) << "of 2^63 positions";
  EXPECT_EQ(steps("0.001", {{"loss", "0.1"}, {"mean_burst", "2"}}), 1000) << "a fifth of 1e8 cells of bursts";
  EXPECT_EQ(steps("0.001", {{"loss", "0.1"}, {"mean_burst", "2"}, {"followers", "2"}}), 2000) << "the most of bursts";
}

TEST_F(ConfigurationTest, TheBurnInOfAnEndlessRunIsItsSettlingTime) {
  const Configuration chosen = configured({{"steps", "0"}});
  EXPECT_EQ(chosen.run.burn_in, *settling_steps(chosen.model, 20));
  EXPECT_EQ(configured({{"steps", "0"}, {"burn_in", "7"}}).run.burn_in, 7);
  // Every change of the run, which is passed on as text, chooses the default anew.
  const Configuration slower = parse_configuration(
      configuration_document(parse_configuration(to_json(chosen).dump()), {{"headway", "30"}, {"followers", "40"}}));
  EXPECT_EQ(slower.run.burn_in, *settling_steps(slower.model, 40));
  EXPECT_GT(slower.run.burn_in, 2 * chosen.run.burn_in);
}

TEST_F(ConfigurationTest, TheBurnInOfAmplificationsLeavesTwoSteps) {
  const Configuration configuration = configured({{"steps", "50"}, {"burn_in", "48"}, {"signals", "speed"}});
  EXPECT_TRUE(configuration.run.has_amplification());
  EXPECT_EQ(statistics_identity(configuration).at("burn_in"), 48);
  EXPECT_EQ(problems_with({{"steps", "50"}, {"burn_in", "49"}, {"signals", "gap,speed"}}),
            Problems{"run/burn_in: 49: must be at most 48, as amplification.csv needs two of the 50 steps"});
  const Configuration whole = configured({{"steps", "50"}, {"signals", "speed"}});
  EXPECT_EQ(whole.run.burn_in, 0) << "the default";
  EXPECT_TRUE(whole.run.has_amplification());
  EXPECT_FALSE(statistics_identity(whole).contains("burn_in"));
  EXPECT_FALSE(configured({{"steps", "50"}, {"burn_in", "49"}, {"signals", "gap"}}).run.has_amplification());
  EXPECT_FALSE(configured({{"steps", "1"}, {"signals", "speed"}}).run.has_amplification());
}

TEST_F(ConfigurationTest, AnUnstableVehicleNeedsABurnIn) {
  const std::string unstable = folder_.file("unstable.yaml", std::string(kModelText) + "\nallow_unstable: true\n");
  const Settings settings{{"model", unstable}, {"headway", "0.1"}, {"steps", "0"}};
  ASSERT_GE(spectral_radius(vehicle_with({{"model", unstable}, {"headway", "0.1"}}).loop), 1.0);
  EXPECT_EQ(problems_with(settings),
            Problems{"run/burn_in: (empty): must be given, as the closed loop of a vehicle is unstable"});
  Settings given = settings;
  given["burn_in"] = "50";
  EXPECT_EQ(configured(given).run.burn_in, 50);
}

TEST_F(ConfigurationTest, NamesEveryUnknownSetting) {
  const Problems problems = problems_with({{"folowers", "3"}, {"color", "red"}});
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_TRUE(begins_with(problems[0], "color: unknown setting: allowed are batch, "));
  EXPECT_TRUE(begins_with(problems[1], "folowers: unknown setting: allowed are batch, "));
}

TEST_F(ConfigurationTest, NamesAMissingModelFile) {
  const std::string shipped = ": no such file: must be a model file, or one of the shipped acc.yaml, acc_limits.yaml, ";
  EXPECT_TRUE(is_problem(problems_with({{"model", "cac.yaml"}}), "model: cac.yaml" + shipped));
  EXPECT_EQ(problems_of([] { configuration_document({{"model", ""}}); }).size(), 1u);
}

TEST_F(ConfigurationTest, RejectsAModelFileThatIsNotAMapping) {
  for (const char* text : {"hello", "[1, 2]", "3"}) {
    const std::string file = folder_.file("other.yaml", text);
    for (const char* headway : {"", "3.2"}) {
      EXPECT_THROW(configured({{"model", file}, {"headway", headway}}), ConfigurationError)
          << text << " with headway \"" << headway << "\"";
    }
  }
}

TEST_F(ConfigurationTest, ConsistsOfModelAndRun) {
  const auto problems_in = [](const std::string& text) {
    return problems_of([&text] { parse_configuration(YAML::Load(text)); });
  };
  EXPECT_EQ(problems_in("hello"), Problems{"the document: hello: must be a mapping of keys"});
  const std::string version = std::string("version: ") + kVersion;
  const Problems none = problems_in("{" + version + "}");
  EXPECT_TRUE(is_among(none, "model: missing: must be a mapping of keys"));
  EXPECT_TRUE(is_among(none, "run: missing: must be a mapping of keys"));
  YAML::Node document = configuration_document({{"model", model_}});
  document["extra"] = 1;
  EXPECT_EQ(problems_of([&document] { parse_configuration(document); }),
            Problems{"extra: unknown key: allowed are model, run, version"});
}

TEST_F(ConfigurationTest, NamesAnotherVersion) {
  YAML::Node document = configuration_document({{"model", model_}});
  document["version"] = "9.9.9";
  const std::string own = std::string(kVersion) + ", this program's";
  EXPECT_EQ(problems_of([&document] { parse_configuration(document); }), Problems{"version: 9.9.9: must be " + own});
  document.remove("version");
  EXPECT_EQ(problems_of([&document] { parse_configuration(document); }),
            Problems{"version: missing: must be " + own + " (version 0.1.0 wrote none)"});
  EXPECT_THROW(parse_configuration(std::string("{a: ")), ConfigurationError);
}

TEST_F(ConfigurationTest, NeedsAPositionOfTheRecordedLeaderForEveryStep) {
  const auto with_positions = [this](const std::string& positions, const std::string& steps) {
    const std::string file = folder_.file(
        "recorded.yaml", model_text_with("{speed: [{from_step: 0, value: 20.0}]}", "{positions: " + positions + "}"));
    return configured({{"model", file}, {"steps", steps}});
  };
  EXPECT_EQ(with_positions("[0.0, 0.0, 1.5]", "2").model.recorded_leader, (std::vector<double>{0.0, 0.0, 1.5}));
  EXPECT_EQ(problems_of([&] { with_positions("[0.0, 0.0, 1.5]", "3"); }),
            Problems{"model/leader/positions: 3 given: must be at least steps + 1 = 4, and steps above 0"});
  EXPECT_EQ(problems_of([&] { with_positions("[0.0, 0.0, 1.5]", "0"); }).size(), 1u);
  EXPECT_EQ(problems_of([&] { with_positions("[0.0, x]", "1"); }).size(), 1u);
}

TEST_F(ConfigurationTest, KeepsTheSettingsThatAChangeDoesNotGive) {
  const Configuration base = configured({{"seed", "5"}, {"followers", "3"}, {"noise_variance", "0.1"}});
  const Configuration changed =
      parse_configuration(configuration_document(base, {{"headway", "2.4"}, {"followers", "4"}, {"model", ""}}));
  EXPECT_EQ(changed.model.default_vehicle().headway, 2.4);
  EXPECT_EQ(changed.model.default_vehicle().loop.realization.a(),
            paper_platoon(2.4).default_vehicle().loop.realization.a());
  EXPECT_EQ(changed.model.default_vehicle().position().noise_variance, 0.1);
  EXPECT_EQ(changed.run.followers, 4u);
  EXPECT_EQ(changed.run.seed, 5u);
  EXPECT_EQ(problems_of([&base] { configuration_document(base, {{"color", "red"}}); }).size(), 1u);
}

TEST_F(ConfigurationTest, IsOverriddenByLossAndDelay) {
  const Configuration changed = configured({{"loss", "0.25"}, {"delay", "2"}});
  EXPECT_EQ(changed.model.default_vehicle().position().link.delay, 2);
  ASSERT_TRUE(changed.model.default_vehicle().position().link.loss);
  EXPECT_EQ(changed.model.default_vehicle().position().link.loss->probability, 0.25);
  EXPECT_EQ(changed.model.default_vehicle().position().link.loss->predictor, std::vector<double>{1.0});
  const Configuration again = parse_configuration(configuration_document(changed, {{"loss", "0.5"}}));
  EXPECT_EQ(again.model.default_vehicle().position().link.loss->probability, 0.5);
  EXPECT_EQ(again.model.default_vehicle().position().link.delay, 2);
  EXPECT_NE(run_identity(changed), run_identity(again));
  EXPECT_FALSE(vehicle_with({}).position().link.loss);
}

// The contributions of all links to all vehicles behind them cost followers^2 x steps.
TEST_F(ConfigurationTest, RejectsALossyStringWhoseTheoryWouldTakeHours) {
  const auto followers_with = [&](const char* followers, const char* loss) {
    return configured({{"loss", loss}, {"followers", followers}, {"steps", "100"}}).run.followers;
  };
  EXPECT_EQ(problems_of([&] { followers_with("10001", "0.1"); }),
            Problems{"run/followers: 10001: must be at most 10000 with losses and 100 steps, as every link's losses "
                     "act on every vehicle behind it (steps: 0 averages over time instead)"});
  EXPECT_EQ(followers_with("10000", "0.1"), 10000u);
  EXPECT_EQ(followers_with("10001", "0"), 10001u);
  EXPECT_EQ(followers_with("10001", ""), 10001u);
}

}  // namespace
}  // namespace platoon
