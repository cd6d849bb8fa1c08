#include "stochastic_platoon/configuration/configuration_error.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

TEST(ConfigurationError, OfOneProblemSaysIt) {
  EXPECT_STREQ(ConfigurationError({"steps: -1: must be at least 0"}).what(), "steps: -1: must be at least 0");
}

TEST(ConfigurationError, OfSeveralProblemsListsThemAll) {
  const ConfigurationError error({"a: 1: must be 2", "b: 3: must be 4"});
  EXPECT_STREQ(error.what(), "2 errors:\n  a: 1: must be 2\n  b: 3: must be 4");
  EXPECT_EQ(error.problems(), (std::vector<std::string>{"a: 1: must be 2", "b: 3: must be 4"}));
}

}  // namespace
}  // namespace platoon
