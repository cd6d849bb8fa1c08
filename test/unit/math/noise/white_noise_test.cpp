#include "stochastic_platoon/math/noise/white_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "unit/math/noise/draw.hpp"

namespace platoon {
namespace {

using detail::kBlocks;
using detail::Words;

// Equality of bits: == treats -0 and 0 as equal.
bool same_bits(const double* left, const double* right, std::size_t count) {
  return count == 0 || std::memcmp(left, right, count * sizeof(double)) == 0;
}

TEST(WhiteNoise, HasTheDocumentedLargestValue) {
  const std::uint64_t w1 = (std::uint64_t{1} << 52) - 1, w2 = 0;  // the smallest u1
  double normals[2];
  detail::noise_versions().front().box_muller(&w1, &w2, 1, normals);
  EXPECT_NEAR(normals[0], std::sqrt(104.0 * std::log(2.0)), 2e-15);
}

TEST(WhiteNoise, HasItsPinnedBits) {
  const auto bits = [](std::uint64_t seed, DrawName name, std::uint64_t realization) {
    return draw(seed, name, realization, 1).front();
  };
  EXPECT_EQ(bits(1, {1, 0}, 0), 0x1.84a343642a263p+0);
  EXPECT_EQ(bits(1, {1, 0}, 1), 0x1.511fa8bad5013p-1);
  EXPECT_EQ(bits(1, {1, -1}, 0), 0x1.e7f4cb8bcc35p-3);
  EXPECT_EQ(bits(1, {20, 99}, 99999), 0x1.10b7ed478e619p+1);
  EXPECT_EQ(bits(2, {7, 12}, 123456789), 0x1.41a1a612c933fp+1);
  EXPECT_EQ(bits(0xdeadbeefcafef00dULL, {500, 1LL << 40}, (1ULL << 47) + 5), -0x1.b480a09282339p+0);
}

// The last version emulates fused multiply-adds on x86-64: a machine without FMA gets the same bits.
TEST(WhiteNoise, HasTheSameBitsForEveryVectorWidth) {
  std::mt19937_64 choice(3);
  const std::vector<detail::NoiseVersion> versions = detail::noise_versions();
  for (int trial = 0; trial < 200; ++trial) {
    Words w1, w2;
    const DrawName name{static_cast<std::uint32_t>(choice()), static_cast<std::int64_t>(choice() >> 18)};
    versions.back().draw_words(choice(), name, choice() >> 17, kBlocks, &w1, &w2);
    const std::size_t pairs = choice() % kBlocks;
    double expected[2 * kBlocks], values[2 * kBlocks];
    for (const detail::NoiseVersion& version : versions) {
      versions.back().box_muller(w1.data(), w2.data(), pairs, expected);
      version.box_muller(w1.data(), w2.data(), pairs, values);
      ASSERT_TRUE(same_bits(expected, values, 2 * pairs)) << version.name;
      versions.back().uniform_pairs(w1.data(), w2.data(), pairs, expected);
      version.uniform_pairs(w1.data(), w2.data(), pairs, values);
      ASSERT_TRUE(same_bits(expected, values, 2 * pairs)) << version.name;
    }
  }
}

TEST(WhiteNoise, IsReportedAsSlowWithoutFusedMultiplyAdd) {
  EXPECT_EQ(slow_noise().empty(), detail::noise_versions().front().is_fused);
}

TEST(WhiteNoise, IsTheSameForEveryBatchSize) {
  constexpr std::size_t kCount = 3000;
  for (const std::uint64_t origin : {std::uint64_t{0}, std::uint64_t{1}, (std::uint64_t{1} << 33) - 1501}) {
    const std::vector<double> whole = draw(7, {3, 11}, origin, kCount);
    for (const std::size_t batch : {1, 2, 3, 7, 63, 64, 65, 126, 127, 128, 129, 255, 1000}) {
      std::vector<double> joined;
      for (std::size_t first = 0; first < kCount; first += batch) {
        const std::vector<double> part = draw(7, {3, 11}, origin + first, std::min(batch, kCount - first));
        joined.insert(joined.end(), part.begin(), part.end());
      }
      EXPECT_TRUE(same_bits(whole.data(), joined.data(), kCount)) << "batches of " << batch << " from " << origin;
    }
  }
}

TEST(WhiteNoise, IsTheSameForEverySlice) {
  constexpr std::size_t kCount = 400;
  const std::uint64_t origin = 12345;
  const std::vector<double> whole = draw(7, {3, 11}, origin, kCount);
  for (std::size_t first = 0; first < kCount; first += 3) {
    for (std::size_t count = 0; first + count <= kCount; ++count) {
      const std::vector<double> slice = draw(7, {3, 11}, origin + first, count);
      ASSERT_TRUE(same_bits(whole.data() + first, slice.data(), count)) << count << " from " << first;
    }
  }
}

TEST(WhiteNoise, WritesNothingOutsideItsRange) {
  for (std::size_t count = 0; count < 300; ++count) {
    for (const std::uint64_t first : {10, 11}) {
      std::vector<double> guarded(count + 2, 77.0);
      WhiteNoise(1).fill({1, 0}, first, count, guarded.data() + 1);
      ASSERT_EQ(guarded.front(), 77.0);
      ASSERT_EQ(guarded.back(), 77.0);
    }
  }
}

TEST(WhiteNoise, DiffersForEveryName) {
  const std::int64_t last_step = (std::int64_t{1} << 47) - 1;
  const std::vector<double> reference = draw(1, {1, 0}, 0, 64);
  const std::vector<std::vector<double>> others = {
      draw(1, {1, -1}, 0, 64),         draw(1, {1, 1}, 0, 64),         draw(1, {1, last_step}, 0, 64),
      draw(1, {2, 0}, 0, 64),          draw(1, {0, 0}, 0, 64),         draw(2, {1, 0}, 0, 64),
      draw(1ULL << 32, {1, 0}, 0, 64), draw(1, {1, 1LL << 32}, 0, 64), draw(1, {1, 0}, 64, 64),
      draw(1, {1, 0}, 1ULL << 33, 64), draw(1, {1, 0}, 1ULL << 47, 64)};
  for (std::size_t j = 0; j < others.size(); ++j) {
    for (std::size_t other = 0; other < j; ++other) {
      EXPECT_FALSE(same_bits(others[j].data(), others[other].data(), 64)) << j << " and " << other;
    }
    for (std::size_t r = 0; r < 64; ++r) EXPECT_NE(others[j][r], reference[r]) << j << " at " << r;
  }
}

// Pinned, as the normals above: recordings and checkpoints depend on them.
TEST(WhiteNoise, HasItsPinnedBitsForDitherAndLosses) {
  double value;
  WhiteNoise(1).fill_uniform({1, 0, Purpose::dither}, 0, 1, &value);
  EXPECT_EQ(value, 0x1.35199f671b1c8p-3);
  WhiteNoise(1).fill_uniform({1, 0, Purpose::loss}, 0, 1, &value);
  EXPECT_EQ(value, 0x1.3ff90e8cd156cp-1);
}

}  // namespace
}  // namespace platoon
