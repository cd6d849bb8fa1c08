#include "stochastic_platoon/run/configuration/run_options.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "unit/run/configuration/model_text.hpp"

namespace platoon {
namespace {

// The run's part of the default settings, with some of them changed.
YAML::Node settings(const std::map<std::string, std::string>& changed = {}) {
  YAML::Node run;
  for (const Setting& setting : platoon::settings()) {
    if (setting.model_key == nullptr) run[setting.name] = setting.default_value;
  }
  for (const auto& entry : changed) run[entry.first] = entry.second;
  return run;
}

RunOptions read(const YAML::Node& node, Problems* problems) {
  return read_run_options(Section(node, "run", *problems));
}

RunOptions read(const std::map<std::string, std::string>& changed) {
  Problems problems;
  const RunOptions options = read(settings(changed), &problems);
  EXPECT_EQ(problems, Problems{});
  return options;
}

Problems problems_with(const std::map<std::string, std::string>& changed) {
  Problems problems;
  read(settings(changed), &problems);
  return problems;
}

Problems problems_with(const std::string& key, const std::string& value) {
  return problems_with({{key, value}});
}

TEST(RunOptions, ThatNeedTooMuchMemoryAreRejected) {
  EXPECT_EQ(problems_with("steps", "99999999999"),
            Problems{"run/steps x followers: 99999999999 x 20: must be at most 20000000, as statistics are kept "
                     "for each (steps: 0 averages over time instead)"});
  EXPECT_EQ(problems_with("steps", "1000000"), Problems{});
  EXPECT_EQ(problems_with({{"steps", "1000000"}, {"realizations", "70368744177664"}}),
            Problems{"run/realizations x steps x followers: 70368744177664 x 1000000 x 20: must be below "
                     "2^63, the limit of the counter"});
}

TEST(RunOptions, HaveTheDefaultsOfTheLaunchFile) {
  const RunOptions options = read({});
  EXPECT_EQ(options.followers, 20u);
  EXPECT_EQ(options.steps, 100);
  EXPECT_EQ(options.realizations, 10000u);
  EXPECT_EQ(options.rate, 0.0);
  EXPECT_EQ(options.seed, 1u);
  EXPECT_EQ(options.hosting, Hosting::processes);
  EXPECT_FALSE(options.resume);
  EXPECT_EQ(options.output, "");
}

TEST(RunOptions, ReadEverySetting) {
  const std::map<std::string, std::string> given{{"followers", "7"},
                                                 {"steps", "30"},
                                                 {"realizations", "500"},
                                                 {"batch", "64"},
                                                 {"rate", "12.5"},
                                                 {"seed", "9223372036854775807"},
                                                 {"hosting", "one_process"},
                                                 {"output", "/some/where"},
                                                 {"resume", "true"},
                                                 {"launch_id", "today"},
                                                 {"window", "9"},
                                                 {"stall_timeout", "0.5"},
                                                 {"burn_in", "11"}};
  const nlohmann::json document = to_json(read(given));
  for (const auto& [key, value] : given) {
    const nlohmann::json& found = document.at(key);
    EXPECT_EQ(found.is_string() ? found.get<std::string>() : found.dump(), value) << key;
  }
  EXPECT_EQ(read({{"stall_timeout", "0"}}).stall_timeout, 0.0);
}

TEST(RunOptions, NameAnInvalidSetting) {
  struct Case {
    std::string key, value, allowed;
  };
  for (const auto& [key, value, allowed] : {
           Case{"followers", "0", "a whole number from 1 to 1000000"},
           Case{"followers", "many", "a whole number from 1 to 1000000"},
           Case{"followers", "", "a whole number from 1 to 1000000"},
           Case{"steps", "-1", "a whole number from 0 to 70368744177664"},
           Case{"realizations", "0", "a whole number from 1 to 70368744177664"},
           Case{"realizations", "1e-4", "a whole number from 1 to 70368744177664"},
           Case{"batch", "-1", "a whole number from 0 to 16777216"},
           Case{"rate", "-1", "a finite number >= 0"},
           Case{"rate", "nan", "a finite number >= 0"},
           Case{"seed", "-1", "a whole number from 0 to 9223372036854775807"},
           Case{"hosting", "cloud", "processes or one_process"},
           Case{"resume", "maybe", "true or false"},
           Case{"window", "-1", "a whole number from 0 to 1048576"},
           Case{"stall_timeout", "-1", "a finite number >= 0"},
           Case{"stall_timeout", "0.0001", "0 or at least 0.001"},
           Case{"burn_in", "-1", "a whole number from 0 to 70368744177664"},
       }) {
    EXPECT_EQ(problems_with(key, value),
              Problems{"run/" + key + ": " + (value.empty() ? "(empty)" : value) + ": must be " + allowed});
  }
  EXPECT_TRUE(is_problem(problems_with("folowers", "20"), "run/folowers: unknown key: allowed are batch, "));
}

TEST(RunOptions, ListTheExternalVehicles) {
  const RunOptions options = read({{"external", "7,3"}, {"followers", "8"}});
  EXPECT_EQ(options.external, (std::vector<std::size_t>{3, 7}));
  EXPECT_TRUE(options.is_external(3) && options.is_external(7));
  EXPECT_FALSE(options.is_external(4) || options.is_external(0));
  EXPECT_EQ(options.followers_before_external(), 2u);
  EXPECT_EQ(to_json(options).at("external"), "3,7");
  EXPECT_EQ(read({}).followers_before_external(), 20u);
  EXPECT_FALSE(to_json(read({})).contains("external")) << "the identity of other runs stays what it was";
}

TEST(RunOptions, NameAnInvalidListOfExternalVehicles) {
  for (const char* given :
       {"0", "21", "3,3", "three", "3,", ",3", "3, 4", "03", "-1", "3.0", "3;4", "99999999999999999999999"}) {
    EXPECT_EQ(
        problems_with("external", given),
        Problems{std::string("run/external: ") + given +
                 ": must be numbers of followers from 1 to 20, each once, separated by commas, as in 3,7, or none"});
  }
}

TEST(RunOptions, LeaveOutTheExternalVehiclesOfARecording) {
  const Configuration recorded = parse_configuration(configuration_document({{"external", "2"}, {"followers", "3"}}));
  const auto repeated = [&recorded](const char* external) {
    return parse_configuration(configuration_document(recorded, {{"followers", "1"}, {"external", external}})).run;
  };
  EXPECT_TRUE(repeated("none").external.empty());
  EXPECT_FALSE(to_json(repeated("none")).contains("external"));
  EXPECT_THROW(repeated("2"), ConfigurationError) << "one that is no longer there";
}

TEST(RunOptions, HaveTheirSignalsInOneOrder) {
  const RunOptions options = read({{"signals", "jerk,gap"}});
  EXPECT_EQ(options.signals, (std::vector<std::string>{"gap", "jerk"}));
  EXPECT_EQ(to_json(options).at("signals"), "gap,jerk");
  EXPECT_FALSE(to_json(read({})).contains("signals")) << "the identity of other runs stays what it was";
}

TEST(RunOptions, NameAnInvalidSignal) {
  for (const char* given : {"distance", "gap,", "gap,gap", ",gap", "gap speed", "Gap"}) {
    EXPECT_EQ(
        problems_with("signals", given),
        Problems{
            std::string("run/signals: ") + given +
            ": must be some of gap, speed, acceleration, jerk, input, relative_speed, each once, separated by commas"});
  }
}

TEST(RunOptions, BoundThePipelineDepthWithAnExternalVehicle) {
  EXPECT_EQ(read({{"hosting", "one_process"}, {"followers", "500"}}).pipeline_depth(), 500u);
  EXPECT_EQ(read({{"hosting", "one_process"}, {"followers", "500"}, {"external", "3"}}).pipeline_depth(), 128u);
}

TEST(RunOptions, NameEveryMissingSetting) {
  Problems problems;
  read(YAML::Load("{}"), &problems);
  EXPECT_EQ(problems.size(), settings().size() - 2);  // without external and signals, which are optional
  for (const std::string& problem : problems) EXPECT_TRUE(contains(problem, ": missing: must be "));
}

TEST(RunOptions, OfAnEndlessRunHaveOneRealization) {
  const RunOptions options = read({{"steps", "0"}, {"realizations", "500"}});
  EXPECT_EQ(options.realizations, 1u);
  EXPECT_EQ(options.batch, 1u);
  EXPECT_TRUE(options.schedule().endless());
}

TEST(RunOptions, HaveNoBatchBeyondTheRealizations) {
  EXPECT_EQ(read({{"realizations", "50"}, {"batch", "64"}}).batch, 50u);
  EXPECT_EQ(read({{"realizations", "50"}, {"batch", "7"}}).batch, 7u);
  EXPECT_EQ(read({{"realizations", "50"}}).batch, 50u);
}

TEST(RunOptions, AreReadBackUnchanged) {
  for (const auto& changed : std::vector<std::map<std::string, std::string>>{
           {},
           {{"seed", "9223372036854775807"}, {"realizations", "70368744177664"}, {"rate", "0.1"}},
           {{"steps", "0"}}}) {
    const RunOptions options = read(changed);
    Problems problems;
    const RunOptions again = read(YAML::Load(to_json(options).dump()), &problems);
    EXPECT_EQ(problems, Problems{});
    EXPECT_EQ(to_json(again), to_json(options));
    EXPECT_EQ(again.seed, options.seed);
    EXPECT_EQ(again.realizations, options.realizations);
  }
}

RunOptions run_of(std::uint64_t realizations, std::size_t followers) {
  RunOptions options{};
  options.realizations = realizations;
  options.followers = followers;
  return options;
}

TEST(ChosenSteps, KeepTheStatisticsOfAllSignalsWithinTheirLimit) {
  RunOptions options;
  options.followers = 2000;
  options.realizations = 1;
  EXPECT_EQ(chosen_steps(options, 0.1, 220.0), 2200);
  options.signals = {"gap", "speed", "acceleration", "jerk"};
  EXPECT_EQ(chosen_steps(options, 0.1, 220.0), 2000) << "20000000 / 2000 / 5";
}

TEST(ChosenBatch, IsSmallerForLongerStringsAndNeverBeyondTheRealizations) {
  EXPECT_EQ(chosen_batch(run_of(1000000, 1)), 8192u);
  EXPECT_EQ(chosen_batch(run_of(1000000, 20)), 8192u);
  EXPECT_EQ(chosen_batch(run_of(1000000, 500)), 8192u);
  EXPECT_EQ(chosen_batch(run_of(100, 20)), 100u);
  std::uint64_t before = 8192;
  for (std::size_t followers = 1; followers <= 100000; followers *= 10) {
    const std::uint64_t batch = chosen_batch(run_of(1000000, followers));
    EXPECT_LE(batch, before);
    EXPECT_GE(batch, 64u);
    EXPECT_TRUE(batch == 64 || batch * followers <= std::uint64_t{1} << 22);
    before = batch;
  }
}

TEST(ChosenBatch, OfARecordedRunIsLargerAndKeepsAStepWithin17Megabytes) {
  RunOptions options = run_of(1000000, 20);
  options.record = "run.bag";
  EXPECT_EQ(chosen_batch(options), 32768u);
  options.realizations = 100;
  EXPECT_EQ(chosen_batch(options), 100u);
  options.realizations = 1000000;
  for (options.followers = 1; options.followers <= 100000; options.followers *= 10) {
    const std::uint64_t batch = chosen_batch(options);
    EXPECT_GE(batch, 64u);
    EXPECT_TRUE(batch == 64 || batch * (2 * options.followers + 1) * sizeof(double) <= std::uint64_t{1} << 24);
  }
}

TEST(ChosenWindow, KeepsEveryProcessBusyWithinTheMemory) {
  for (const std::uint64_t batch : {1, 64, 8192}) {
    for (const std::size_t followers : {1, 20, 500}) {
      const std::int64_t window = chosen_window(batch, followers);
      EXPECT_GE(window, 4);
      EXPECT_LE(window, 256);
      const auto positions = static_cast<double>(window) * static_cast<double>(batch * followers);
      EXPECT_TRUE(window == 4 || positions <= static_cast<double>(5 << 19));
    }
  }
  EXPECT_GT(read({}).window, 0);
}

}  // namespace
}  // namespace platoon
