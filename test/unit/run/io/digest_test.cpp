#include "stochastic_platoon/run/io/digest.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

TEST(Digest, IsTheFnv1aOfItsAuthors) {
  EXPECT_EQ(digest(""), 0xcbf29ce484222325u);
  EXPECT_EQ(digest("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(digest("foobar"), 0x85944171f73967e8u);
}

TEST(Digest, DiffersForEveryByteAndEveryPlace) {
  const std::string text = "a platoon of vehicles";
  for (std::size_t place = 0; place < text.size(); ++place) {
    for (int flip = 1; flip < 256; ++flip) {
      std::string bent = text;
      bent[place] = static_cast<char>(bent[place] ^ flip);
      ASSERT_NE(digest(bent), digest(text));
    }
  }
}

}  // namespace
}  // namespace platoon
