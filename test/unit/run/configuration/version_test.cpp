#include "stochastic_platoon/run/configuration/version.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>
#include <string>

namespace platoon {

namespace {

// The first version number that follows `before` in a file of the package.
std::string version_in(const std::string& name, const std::string& before) {
  std::ifstream file(std::string(PLATOON_SOURCE_DIR "/") + name);
  std::stringstream content;
  content << file.rdbuf();
  const std::string text = content.str();
  std::smatch match;
  return std::regex_search(text, match, std::regex(before + R"((\d+\.\d+\.\d+))")) ? match[1].str() : "none";
}

TEST(Version, IsThatOfThePackageManifest) {
  EXPECT_EQ(version_in("package.xml", "<version>"), kVersion);
}

TEST(Version, HeadsTheChangelog) {
  EXPECT_EQ(version_in("CHANGELOG.rst", "\n"), kVersion);
}

TEST(Version, IsThatOfTheCitation) {
  EXPECT_EQ(version_in("README.md", "theory\\*, version "), kVersion);
}

}  // namespace

}  // namespace platoon
