#include "stochastic_platoon/run/configuration/settings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>
#include <string>

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
