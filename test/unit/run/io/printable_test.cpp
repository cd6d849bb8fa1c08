#include "stochastic_platoon/run/io/printable.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

TEST(Shortened, KeepsAShortTextAndTheBeginningOfALongOne) {
  EXPECT_EQ(shortened(std::string(80, 'x')), std::string(80, 'x'));
  EXPECT_EQ(shortened(std::string(81, 'x')), std::string(80, 'x') + "...");
}

TEST(Printable, ShowsEveryByteOutsideOfAscii) {
  EXPECT_EQ(printable("a b~"), "a b~");
  EXPECT_EQ(printable("\x1b[2J\xff\n"), "\\x1b[2J\\xff\\x0a");
}

}  // namespace
}  // namespace platoon
