#include "stochastic_platoon/run/io/digest.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

TEST(Digest, HasTheReferenceValuesOfFnv1a) {
  EXPECT_EQ(digest(""), 0xcbf29ce484222325u);
  EXPECT_EQ(digest("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(digest("foobar"), 0x85944171f73967e8u);
}

TEST(Digest, ChangesWithEveryByte) {
  const std::string text = "a platoon of vehicles";
  for (std::size_t place = 0; place < text.size(); ++place) {
    for (int flip = 1; flip < 256; ++flip) {
      std::string changed = text;
      changed[place] = static_cast<char>(changed[place] ^ flip);
      ASSERT_NE(digest(changed), digest(text));
    }
  }
}

}  // namespace
}  // namespace platoon
