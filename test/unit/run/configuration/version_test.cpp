#include "stochastic_platoon/run/configuration/version.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

// The first version number that follows `before` in a file of the package.
std::string version_in(const std::string& name, const std::string& before) {
  const std::string text = content_of(PLATOON_SOURCE_DIR "/" + name);
  std::smatch match;
  return std::regex_search(text, match, std::regex(before + R"((\d+\.\d+\.\d+))")) ? match[1].str() : "none";
}

TEST(Version, IsThatOfThePackageTheChangelogAndTheCitation) {
  EXPECT_EQ(version_in("package.xml", "<version>"), kVersion);
  EXPECT_EQ(version_in("CHANGELOG.rst", "\n"), kVersion);
  EXPECT_EQ(version_in("README.md", "theory\\*, version "), kVersion);
}

}  // namespace
}  // namespace platoon
