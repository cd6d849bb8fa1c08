#include "stochastic_platoon/math/numerics/text.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <clocale>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "unit/temporary_folder.hpp"

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

TEST(ShellWord, IsQuotedOnlyWhereItMustBe) {
  for (const char* plain : {"/tmp/run_1.2-b", "a@b%c+d=e:f,g"}) EXPECT_EQ(shell_word(plain), plain);
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("K\u00e4se und Brot"), "'K\u00e4se und Brot'");
  EXPECT_EQ(shell_word("it's $HOME"), "'it'\\''s $HOME'");
  for (const char* special : {"~", "a*", "#", "a;b", "a\nb", "(a)", "a\\b", "\"", "!"})
    EXPECT_EQ(shell_word(special), std::string("'") + special + "'");
}

// Python programs may set the user's locale, in which numbers have a comma.
TEST(NumberIn, AndFormattedHaveAPointInEveryLocale) {
  // Debian has the sources of all locales in its package `locales`, and none is ready for use.
  if (!std::filesystem::exists("/usr/share/i18n/locales/de_DE"))
    GTEST_SKIP() << "no source of a locale (package locales)";
  const TemporaryFolder folder;
  ASSERT_EQ(::system(("localedef -i de_DE -f UTF-8 " + folder / "de_DE.UTF-8").c_str()), 0);
  ASSERT_EQ(::setenv("LOCPATH", folder.path().c_str(), 1), 0);
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  const bool is_set = std::setlocale(LC_NUMERIC, "de_DE.UTF-8") != nullptr;
  const std::string point = std::localeconv()->decimal_point, text = formatted("%.1f", 0.5);
  const auto number = number_in("0.5"), with_comma = number_in("0,5");
  std::setlocale(LC_NUMERIC, before.c_str());
  ::unsetenv("LOCPATH");
  EXPECT_TRUE(is_set);
  EXPECT_EQ(point, ",");
  EXPECT_EQ(text, "0.5");
  EXPECT_EQ(number, 0.5);
  EXPECT_FALSE(with_comma);
}

}  // namespace
}  // namespace platoon
