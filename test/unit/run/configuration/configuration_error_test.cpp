#include "stochastic_platoon/run/configuration/configuration_error.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

TEST(ConfigurationError, HasTheTextOfItsProblem) {
  EXPECT_STREQ(ConfigurationError({"steps: -1: must be at least 0"}).what(), "steps: -1: must be at least 0");
}

TEST(ConfigurationError, ListsSeveralProblems) {
  const ConfigurationError error({"a: 1: must be 2", "b: 3: must be 4"});
  EXPECT_STREQ(error.what(), "2 errors:\n  a: 1: must be 2\n  b: 3: must be 4");
  EXPECT_EQ(error.problems(), (std::vector<std::string>{"a: 1: must be 2", "b: 3: must be 4"}));
}

TEST(ProblemCollector, AreThoseOfAllSteps) {
  ProblemCollector problems;
  EXPECT_EQ(problems.result_of([] { return 3; }), 3);
  problems.require_none();
  const auto failing = []() -> int { throw ConfigurationError({"a: 1: must be 2", "b: 3: must be 4"}); };
  EXPECT_EQ(problems.result_of(failing), std::nullopt);
  problems.add("c: 5: must be 6");
  problems.check([] {});
  problems.check([] { throw ConfigurationError({"d: 7: must be 8"}); });
  EXPECT_THROW(problems.check([] { throw std::runtime_error("the disk is full"); }), std::runtime_error);
  const std::vector<std::string> all{"a: 1: must be 2", "b: 3: must be 4", "c: 5: must be 6", "d: 7: must be 8"};
  EXPECT_EQ(problems.all(), all);
  try {
    problems.require_none();
    FAIL() << "must throw";
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(error.problems(), all);
  }
}

TEST(ConfigurationError, NamesTwentyProblemsAndCountsTheOthers) {
  std::vector<std::string> problems(20, "a: 1: must be 2");
  EXPECT_EQ(abbreviated(problems), problems);
  problems.insert(problems.begin(), 3, "b: 3: must be 4");
  const std::vector<std::string> named = abbreviated(problems);
  ASSERT_EQ(named.size(), 21u);
  EXPECT_EQ(named[2], "b: 3: must be 4");
  EXPECT_EQ(named[19], "a: 1: must be 2");
  EXPECT_EQ(named[20], "and 3 more");
}

}  // namespace
}  // namespace platoon
