#include "stochastic_platoon/math/numerics/text.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

TEST(Formatted, EqualsTheOutputOfPrintf) {
  EXPECT_EQ(formatted("%d of %s: %.3f", 7, "nine", 0.5), "7 of nine: 0.500");
  EXPECT_EQ(formatted("%s", ""), "");
}

TEST(Formatted, MayHaveAnyLength) {
  const std::string text(5000, 'x');
  EXPECT_EQ(formatted("<%s>", text.c_str()), "<" + text + ">");
}

}  // namespace
}  // namespace platoon
