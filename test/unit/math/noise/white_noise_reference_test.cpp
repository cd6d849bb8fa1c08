// Comparison with Random123's Philox and with Box and Muller's transform in extended precision.

#include <Random123/philox.h>
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

struct Block {
  std::uint64_t w1;
  std::uint64_t w2;
};

// The words as the header defines them, one block at a time: key = seed, counter = (block number, step, vehicle + 2^24
// purpose).
Block reference_block(std::uint64_t seed, DrawName name, std::uint64_t block) {
  const auto step = static_cast<std::uint64_t>(name.step) & 0xffffffffffffULL;
  philox4x32_ctr_t counter;
  counter.v[0] = static_cast<std::uint32_t>(block);
  counter.v[1] = static_cast<std::uint32_t>((block >> 32) | ((step >> 32) << 16));
  counter.v[2] = static_cast<std::uint32_t>(step);
  counter.v[3] = name.vehicle | static_cast<std::uint32_t>(name.purpose) << 24;
  philox4x32_key_t key;
  key.v[0] = static_cast<std::uint32_t>(seed);
  key.v[1] = static_cast<std::uint32_t>(seed >> 32);
  const philox4x32_ctr_t words = philox4x32_R(10, counter, key);
  return {(std::uint64_t{words.v[0]} << 32) | words.v[1], (std::uint64_t{words.v[2]} << 32) | words.v[3]};
}

struct Pair {
  long double even;
  long double odd;
};

constexpr std::uint64_t kUniform = (std::uint64_t{1} << 52) - 1;  // the bits of u1 and u2

// Box and Muller in extended precision: u1 in (0, 1], u2 in [0, 1), signs in the leading bits.
Pair reference_normals(const Block& block) {
  constexpr long double kPi = 3.141592653589793238462643383279502884L;
  const long double u1 = 1.0L - std::ldexp(static_cast<long double>(block.w1 & kUniform), -52);
  const long double u2 = std::ldexp(static_cast<long double>(block.w2 & kUniform), -52);
  const long double radius = std::sqrt(-2.0L * std::log(u1));
  return {std::copysign(radius, block.w1 >> 63 ? -1.0L : 1.0L) * std::cos(kPi / 2.0L * u2),
          std::copysign(radius, block.w2 >> 63 ? -1.0L : 1.0L) * std::sin(kPi / 2.0L * u2)};
}

struct KnownAnswer {
  std::uint32_t counter[4];
  std::uint32_t key[2];
  std::uint32_t output[4];
};

// philox4x32 10 of Random123's tests/kat_vectors.
constexpr KnownAnswer kKnownAnswers[] = {
    {{0x00000000, 0x00000000, 0x00000000, 0x00000000},
     {0x00000000, 0x00000000},
     {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
    {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
     {0xffffffff, 0xffffffff},
     {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
    {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
     {0xa4093822, 0x299f31d0},
     {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
};

TEST(WhiteNoiseReference, HasThePublishedAnswersInRandom123) {
  for (const KnownAnswer& known : kKnownAnswers) {
    philox4x32_ctr_t counter;
    philox4x32_key_t key;
    std::memcpy(counter.v, known.counter, sizeof known.counter);
    std::memcpy(key.v, known.key, sizeof known.key);
    const philox4x32_ctr_t words = philox4x32_R(10, counter, key);
    for (std::size_t w = 0; w < 4; ++w) EXPECT_EQ(words.v[w], known.output[w]);
  }
}

TEST(WhiteNoiseReference, HasThePublishedAnswers) {
  for (const KnownAnswer& known : kKnownAnswers) {
    const std::uint64_t seed = (std::uint64_t{known.key[1]} << 32) | known.key[0];
    const std::uint64_t step = (std::uint64_t{known.counter[1] >> 16} << 32) | known.counter[2];
    const std::uint64_t block = (std::uint64_t{known.counter[1] & 0xffff} << 32) | known.counter[0];
    const DrawName name{known.counter[3], static_cast<std::int64_t>(step)};
    for (const detail::NoiseVersion& version : detail::noise_versions()) {
      Words w1, w2;
      version.draw_words(seed, name, block, 1, &w1, &w2);
      EXPECT_EQ(w1[0], (std::uint64_t{known.output[0]} << 32) | known.output[1]) << version.name;
      EXPECT_EQ(w2[0], (std::uint64_t{known.output[2]} << 32) | known.output[3]) << version.name;
    }
  }
}

TEST(WhiteNoiseReference, HasTheWordsOfTheLibraryForEveryNameAndVectorWidth) {
  std::mt19937_64 choice(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const std::uint64_t seed = choice();
    const DrawName name{static_cast<std::uint32_t>(choice()), static_cast<std::int64_t>(choice() >> 17) - 1};
    const std::uint64_t first = choice() >> 17;  // realizations below 2^48
    const std::size_t blocks = std::min<std::uint64_t>(choice() % kBlocks + 1, (1ULL << 32) - (first & 0xffffffff));
    for (const detail::NoiseVersion& version : detail::noise_versions()) {
      Words w1{}, w2{};
      version.draw_words(seed, name, first, blocks, &w1, &w2);
      for (std::size_t lane = 0; lane < blocks; ++lane) {
        const Block expected = reference_block(seed, name, first + lane);
        ASSERT_EQ(w1[lane], expected.w1) << version.name;
        ASSERT_EQ(w2[lane], expected.w2) << version.name;
      }
    }
  }
}

TEST(WhiteNoiseReference, TransformsTheWordsByBoxAndMuller) {
  std::mt19937_64 choice(2);
  for (int trial = 0; trial < 300; ++trial) {
    const std::uint64_t seed = choice();
    const DrawName name{static_cast<std::uint32_t>(choice() % 1000 + 1),
                        static_cast<std::int64_t>(choice() % 100000) - 1};
    const std::uint64_t first = choice() >> 17;
    const std::vector<double> normals = draw(seed, name, first, 200);
    for (std::size_t r = 0; r < normals.size(); ++r) {
      const Pair expected = reference_normals(reference_block(seed, name, (first + r) / 2));
      const long double exact = (first + r) % 2 == 0 ? expected.even : expected.odd;
      ASSERT_NEAR(static_cast<double>(normals[r] - exact), 0.0, 2e-15);
    }
  }
}

TEST(WhiteNoiseReference, IsAccurateAtTheEdgesOfTheWordsForEveryVectorWidth) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  std::vector<std::uint64_t> words;
  // u1 = 1, 0, 1/2, sqrt(1/2); u2 = 0, 1, 1/2 among them
  for (const std::uint64_t edge : {std::uint64_t{0}, kUniform, kUniform / 2, std::uint64_t{0x4afb0ccc06219}}) {
    for (std::uint64_t j = 0; j < 5; ++j) {
      words.push_back((edge + j - 2) & kUniform);
      words.push_back(words.back() | kSign);
    }
  }
  std::vector<double> normals(2 * words.size());
  for (const detail::NoiseVersion& version : detail::noise_versions()) {
    for (const std::uint64_t w : words) {
      const std::vector<std::uint64_t> w1(words.size(), w);
      version.box_muller(w1.data(), words.data(), words.size(), normals.data());
      for (std::size_t a = 0; a < words.size(); ++a) {
        const Pair expected = reference_normals({w, words[a]});
        EXPECT_NEAR(static_cast<double>(normals[2 * a] - expected.even), 0.0, 2e-15) << w << " " << words[a];
        EXPECT_NEAR(static_cast<double>(normals[2 * a + 1] - expected.odd), 0.0, 2e-15) << w << " " << words[a];
      }
    }
  }
}

TEST(WhiteNoiseReference, DrawsUniformsFromTheWordsOfItsBlocks) {
  const std::uint64_t seed = 0x123456789abcdefULL, first = 1001;
  const std::size_t count = 2 * kBlocks + 5;
  for (const Purpose purpose : {Purpose::dither, Purpose::loss}) {
    const DrawName name{5, 70000000000, purpose};
    std::vector<double> uniforms(count);
    WhiteNoise(seed).fill_uniform(name, first, count, uniforms.data());
    for (std::size_t r = 0; r < count; ++r) {
      const Block block = reference_block(seed, name, (first + r) / 2);
      const std::uint64_t word = (first + r) % 2 == 0 ? block.w1 : block.w2;
      EXPECT_EQ(uniforms[r], std::ldexp(static_cast<double>(word & kUniform), -52)) << r;
    }
  }
}

}  // namespace
}  // namespace platoon
