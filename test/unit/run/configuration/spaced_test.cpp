#include "stochastic_platoon/run/configuration/spaced.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

TEST(ParseSpaced, GivesEquallySpacedValuesWithBothEnds) {
  const std::optional<Spaced> spaced = parse_spaced("2:4:5");
  ASSERT_TRUE(spaced);
  EXPECT_EQ(spaced->count, 5u);
  EXPECT_EQ(spaced->at(0), 2.0);
  EXPECT_EQ(spaced->at(1), 2.5);
  EXPECT_EQ(spaced->at(4), 4.0);
  EXPECT_EQ(parse_spaced("-1.5e0:1e3:1")->at(0), -1.5);
  EXPECT_EQ(parse_spaced("1:2:1e2")->count, 100u);
}

TEST(ParseSpaced, RejectsEverythingElse) {
  for (const char* text : {"", "2", "2:4", "4:2:3", "2:4:0", "2:4:-1", "2:4:1.5", "2:4:", "2:4:1e-2", "2:4:3x", "a:4:3",
                           "2:inf:3", "nan:4:3", "2;4:3", "2:4:99999999999999999999"})
    EXPECT_FALSE(parse_spaced(text)) << text;
}

}  // namespace
}  // namespace platoon
