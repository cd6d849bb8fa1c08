#include "stochastic_platoon/run/io/xxhash64.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "unit/damage.hpp"

namespace platoon {
namespace {

// Values of the reference implementation (libxxhash 0.8.1).
TEST(Xxhash64, HasTheReferenceValues) {
  EXPECT_EQ(xxhash64(""), 0xef46db3751d8e999u);
  EXPECT_EQ(xxhash64("abc"), 0x44bc2cf5ad770999u);
  EXPECT_EQ(xxhash64("abc", 1), 0xbea9ca8199328908u);
  EXPECT_EQ(xxhash64("Nobody inspects the spammish repetition"), 0xfbcea83c8a378bf1u);
  EXPECT_EQ(xxhash64(std::string(1000, 'a'), 7), 0x4f58797741c3212cu);
}

TEST(Xxhash64, IsTheSameInPiecesOfAnySize) {
  std::string bytes;
  for (int i = 0; i < 300; ++i) bytes += static_cast<char>(i * 37);
  for (std::size_t piece = 1; piece < 100; ++piece) {
    Xxhash64 hash(5);
    for (std::size_t at = 0; at < bytes.size(); at += piece)
      hash.add(bytes.data() + at, std::min(piece, bytes.size() - at));
    EXPECT_EQ(hash.value(), xxhash64(bytes, 5)) << piece;
  }
}

TEST(Xxhash64, ChangesWithEveryBit) {
  const std::string bytes(200, 'x');
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit)
    EXPECT_NE(xxhash64(with_flipped_bit(bytes, bit)), xxhash64(bytes)) << bit;
}

}  // namespace
}  // namespace platoon
