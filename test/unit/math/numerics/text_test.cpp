#include "stochastic_platoon/math/numerics/text.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <utility>

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

TEST(NumberIn, ReadsDecimalNumbersOnly) {
  for (const auto& [text, value] :
       {std::pair("0.1", 0.1), {"-3", -3.0}, {"+.5e-3", 0.0005}, {"1.", 1.0}, {"2E+10", 2e10}})
    EXPECT_EQ(number_in(text), value) << text;
  EXPECT_EQ(number_in("0.1000000000000000055511151231257827021181583404541"), 0.1) << "longer than a buffer";
  EXPECT_TRUE(std::isnan(number_in("-nan").value()));
  EXPECT_EQ(number_in("inf"), HUGE_VAL);
  for (const char* text : {"", " 1", "1 ", "0x10", "1e", "e5", ".", "-", "1.2.3", "1,5", "1_0", "1d5", "infinity"})
    EXPECT_FALSE(number_in(text)) << text;
  EXPECT_FALSE(number_in(std::string_view("1\0", 2))) << "a zero byte";
  EXPECT_FALSE(number_in(std::string_view("1\0.5", 4)));
}

// Python programs may set the user's locale, in which numbers have a comma.
TEST(NumberIn, AndFormattedHaveAPointInEveryLocale) {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  if (std::setlocale(LC_NUMERIC, "de_DE.UTF-8") == nullptr) GTEST_SKIP() << "no locale with a decimal comma";
  EXPECT_EQ(formatted("%.1f", 0.5), "0.5");
  EXPECT_EQ(number_in("0.5"), 0.5);
  std::setlocale(LC_NUMERIC, before.c_str());
}

}  // namespace
}  // namespace platoon
