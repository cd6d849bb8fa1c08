#include <gtest/gtest.h>

#include "unit/run/configuration/configuration_fixture.hpp"

namespace platoon {
namespace {

using ConfigurationIdentityTest = ConfigurationTest;

TEST_F(ConfigurationIdentityTest, OfARunDependsOnEverySettingAndTheLaunch) {
  const Configuration configuration = configured({{"launch_id", "monday"}});
  const std::uint64_t run = run_identity(configuration);
  EXPECT_NE(run, 0u);
  EXPECT_EQ(run_identity(parse_configuration(to_json(configuration).dump())), run);
  for (const Settings& settings :
       {Settings{{"headway", "3.3"}}, Settings{{"seed", "2"}}, Settings{{"steps", "99"}}, Settings{{"batch", "7"}},
        Settings{{"launch_id", "tuesday"}}, Settings{{"realizations", "9999"}}, Settings{{"output", "x"}}}) {
    Settings changed = settings;
    changed.emplace("launch_id", "monday");
    EXPECT_NE(run_identity(configured(changed)), run) << settings.begin()->first;
  }
}

TEST_F(ConfigurationIdentityTest, OfStatisticsDependsOnModelSeedFollowersAndSteps) {
  const nlohmann::json identity = statistics_identity(configured({}));
  for (const Settings& settings :
       {Settings{{"headway", "2.4"}}, Settings{{"noise_variance", "0.61"}}, Settings{{"seed", "2"}},
        Settings{{"followers", "21"}}, Settings{{"steps", "101"}}}) {
    EXPECT_NE(statistics_identity(configured(settings)), identity) << settings.begin()->first;
  }
  const std::string longer = folder_.file("longer.yaml", model_text_with("value: 20.0", "value: 21.0"));
  EXPECT_NE(statistics_identity(configured({{"model", longer}})), identity);
  Configuration recorded = configured({});
  recorded.model.recorded_leader = {0.0, 0.0, 1.5};
  EXPECT_NE(statistics_identity(recorded), identity);
}

TEST_F(ConfigurationIdentityTest, OfStatisticsDependsOnNothingElse) {
  const nlohmann::json identity = statistics_identity(configured({}));
  for (const Settings& settings :
       {Settings{{"realizations", "7"}}, Settings{{"batch", "7"}}, Settings{{"rate", "7"}},
        Settings{{"hosting", "one_process"}}, Settings{{"output", "x"}}, Settings{{"resume", "true"}},
        Settings{{"launch_id", "x"}}, Settings{{"window", "7"}}, Settings{{"stall_timeout", "7"}}}) {
    EXPECT_EQ(statistics_identity(configured(settings)), identity) << settings.begin()->first;
  }
}

}  // namespace
}  // namespace platoon
