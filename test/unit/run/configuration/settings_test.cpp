#include "stochastic_platoon/run/configuration/settings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"
#include "unit/messages.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

TEST(Settings, HaveDifferentNames) {
  std::set<std::string> names;
  for (const Setting& setting : settings()) EXPECT_TRUE(names.insert(setting.name).second) << setting.name;
}

TEST(Settings, NameAllSignals) {
  const auto of_signals = std::find_if(settings().begin(), settings().end(),
                                       [](const Setting& setting) { return setting.name == std::string("signals"); });
  ASSERT_NE(of_signals, settings().end());
  EXPECT_TRUE(contains(of_signals->help, ": " + all_signal_names() + ";"));
}

TEST(Settings, ConflictWithTheKeysThatTheyStandForInEitherOrder) {
  std::size_t pairs = 0;
  for (const Setting& setting : settings()) {
    if (setting.model_key == nullptr) continue;
    std::vector<std::string> keys{setting.model_key};
    keys.insert(keys.end(), setting.replaces.begin(), setting.replaces.end());
    for (const std::string& key : keys) {
      if (key == setting.name) continue;
      const std::vector<std::pair<std::string, std::string>> both{{setting.name, key}, {key, setting.name}};
      for (const auto& [one, other] : both) {
        EXPECT_EQ(conflicts({one, "steps", other}),
                  (std::vector<std::string>{other + ": given: must be absent beside " + one + ", which sets it too"}));
        ++pairs;
      }
    }
  }
  EXPECT_GE(pairs, 20u);
  EXPECT_EQ(conflicts({"headway", "headway_seconds", "time_headway"}).size(), 2u);
}

TEST(Settings, ConflictWithAKeyWithinALaterOneOnly) {
  EXPECT_EQ(conflicts({"delay", "channel"}),
            std::vector<std::string>{"channel: given: must be absent beside delay, which it replaces"});
  EXPECT_EQ(conflicts({"leader/unit", "leader/file"}),
            std::vector<std::string>{"leader/file: given: must be absent beside leader/unit, which it replaces"});
  for (const auto& names : std::vector<std::vector<std::string>>{
           {"channel", "delay"}, {"leader", "leader/unit"}, {"loss", "mean_burst"}, {"channel/loss", "channel/lossy"}})
    EXPECT_TRUE(conflicts(names).empty()) << names.back();
}

// The launch file repeats default and help of each argument, because roslaunch cannot read them from here.
TEST(Settings, HaveTheDefaultsAndHelpOfTheLaunchFile) {
  const std::string file = content_of(PLATOON_SOURCE_DIR "/launch/platoon.launch");
  const std::regex argument("<arg name=\"(\\w+)\" default=\"([^\"]*)\" doc=\"([^\"]*)\"/>");
  std::set<std::string> found;
  for (auto match = std::sregex_iterator(file.begin(), file.end(), argument); match != std::sregex_iterator();
       ++match) {
    for (const Setting& setting : settings()) {
      if ((*match)[1] != setting.name) continue;
      EXPECT_EQ((*match)[2], setting.default_value) << setting.name;
      EXPECT_EQ((*match)[3], setting.help) << setting.name;
      found.insert(setting.name);
    }
  }
  for (const Setting& setting : settings()) {
    const std::set<std::string> of_configure{"launch_id", "first_realization"};
    EXPECT_EQ(found.count(setting.name) + of_configure.count(setting.name), 1u) << setting.name;
  }
}

}  // namespace
}  // namespace platoon
