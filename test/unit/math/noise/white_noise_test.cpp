#include "stochastic_platoon/math/noise/white_noise.hpp"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

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

std::vector<double> draw(std::uint64_t seed, DrawName name, std::uint64_t first, std::size_t count) {
  std::vector<double> normals(count);
  WhiteNoise(seed).fill(name, first, count, normals.data());
  return normals;
}

// Equality of bits: == treats -0 and 0 as equal.
bool same_bits(const double* left, const double* right, std::size_t count) {
  return count == 0 || std::memcmp(left, right, count * sizeof(double)) == 0;
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

TEST(WhiteNoise, LibrarysPhiloxGivesItsPublishedAnswers) {
  for (const KnownAnswer& known : kKnownAnswers) {
    philox4x32_ctr_t counter;
    philox4x32_key_t key;
    std::memcpy(counter.v, known.counter, sizeof known.counter);
    std::memcpy(key.v, known.key, sizeof known.key);
    const philox4x32_ctr_t words = philox4x32_R(10, counter, key);
    for (std::size_t w = 0; w < 4; ++w) EXPECT_EQ(words.v[w], known.output[w]);
  }
}

TEST(WhiteNoise, OwnPhiloxGivesThePublishedAnswers) {
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

TEST(WhiteNoise, WordsAreThoseOfTheLibraryForEveryNameAndEveryVectorWidth) {
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

TEST(WhiteNoise, NormalsAreBoxAndMullersOfTheWordsByRealization) {
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

TEST(WhiteNoise, NormalsAreAccurateAtTheEdgesOfTheWordsForEveryVectorWidth) {
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

TEST(WhiteNoise, LargestNormalIsTheOneTheHeaderNames) {
  const std::uint64_t w1 = kUniform, w2 = 0;
  double normals[2];
  detail::noise_versions().front().box_muller(&w1, &w2, 1, normals);
  EXPECT_NEAR(normals[0], std::sqrt(104.0 * std::log(2.0)), 2e-15);
}

TEST(WhiteNoise, BitsArePinned) {
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
TEST(WhiteNoise, EveryVectorWidthGivesTheSameBits) {
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

TEST(WhiteNoise, SlowNoiseIsReportedWhereTheFastestVersionHasNoFusedMultiplyAdd) {
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

TEST(WhiteNoise, WritesNothingBesideItsPlace) {
  for (std::size_t count = 0; count < 300; ++count) {
    for (const std::uint64_t first : {10, 11}) {
      std::vector<double> guarded(count + 2, 77.0);
      WhiteNoise(1).fill({1, 0}, first, count, guarded.data() + 1);
      ASSERT_EQ(guarded.front(), 77.0);
      ASSERT_EQ(guarded.back(), 77.0);
    }
  }
}

TEST(WhiteNoise, EveryNameHasDrawsOfItsOwn) {
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

// From here on: statistics of a fixed sample. Every tolerance is four standard errors of the estimator for independent
// standard normals; one sample in 500 fails one of about thirty comparisons by chance, and this one does not.
constexpr double kStandardErrors = 4.0;
constexpr std::size_t kSample = 1 << 18;

// (1/n) sum x^p and its tolerance: the variance of x^p is m_2p - m_p^2 with m_p = (p-1)!! for even p, else 0.
TEST(WhiteNoise, FirstSixMomentsAreThoseOfTheStandardNormal) {
  const double moment[] = {1, 0, 1, 0, 3, 0, 15, 0, 105, 0, 945, 0, 10395};
  const std::vector<double> x = draw(1, {1, 0}, 0, kSample);
  for (std::size_t power = 1; power <= 6; ++power) {
    double sum = 0.0;
    for (const double value : x) sum += std::pow(value, static_cast<int>(power));
    const double variance = moment[2 * power] - moment[power] * moment[power];
    EXPECT_NEAR(sum / kSample, moment[power], kStandardErrors * std::sqrt(variance / kSample)) << power;
  }
}

// Skewness and excess kurtosis of n normals have standard errors sqrt(6/n) and sqrt(24/n).
TEST(WhiteNoise, SkewnessAndKurtosisAreThoseOfTheNormal) {
  const std::vector<double> x = draw(2, {5, 3}, 1, kSample);
  double mean = 0.0, m2 = 0.0, m3 = 0.0, m4 = 0.0;
  for (const double value : x) mean += value / kSample;
  for (const double value : x) {
    const double d = value - mean;
    m2 += d * d / kSample;
    m3 += d * d * d / kSample;
    m4 += d * d * d * d / kSample;
  }
  EXPECT_NEAR(m3 / std::pow(m2, 1.5), 0.0, kStandardErrors * std::sqrt(6.0 / kSample));
  EXPECT_NEAR(m4 / (m2 * m2) - 3.0, 0.0, kStandardErrors * std::sqrt(24.0 / kSample));
}

// A share p among n has the standard error sqrt(p (1 - p) / n).
TEST(WhiteNoise, TailsHaveTheProbabilitiesOfTheNormal) {
  const std::vector<double> x = draw(3, {1, 0}, 0, 8 * kSample);
  for (const double bound : {0.5, 1.0, 2.0, 3.0, 4.0}) {
    double above = 0.0, below = 0.0;
    for (const double value : x) {
      above += value > bound ? 1.0 : 0.0;
      below += value < -bound ? 1.0 : 0.0;
    }
    const auto n = static_cast<double>(x.size());
    const double p = 0.5 * std::erfc(bound / std::sqrt(2.0));
    EXPECT_NEAR(above / n, p, kStandardErrors * std::sqrt(p * (1.0 - p) / n)) << bound;
    EXPECT_NEAR(below / n, p, kStandardErrors * std::sqrt(p * (1.0 - p) / n)) << -bound;
  }
}

// Pearson's chi^2 over b cells of equal probability has mean b - 1 and variance 2 (b - 1).
TEST(WhiteNoise, DistributionIsTheNormalOne) {
  constexpr std::size_t kCells = 256;
  std::vector<double> hits(kCells);
  for (const double value : draw(4, {2, 8}, 0, kSample)) {
    const double share = 0.5 * std::erfc(-value / std::sqrt(2.0));
    hits[std::min(static_cast<std::size_t>(share * kCells), kCells - 1)] += 1.0;
  }
  const double expected = static_cast<double>(kSample) / kCells;
  double chi_square = 0.0;
  for (const double count : hits) chi_square += (count - expected) * (count - expected) / expected;
  EXPECT_NEAR(chi_square, kCells - 1, kStandardErrors * std::sqrt(2.0 * (kCells - 1)));
}

// The mean product of n pairs of independent standard normals has the standard error 1 / sqrt(n); the mean
// product of x^2 - 1 and y^2 - 1 has 2 / sqrt(n).
void expect_independent(const std::vector<double>& x, const std::vector<double>& y, const std::string& what) {
  const auto n = static_cast<double>(x.size());
  double product = 0.0, square = 0.0;
  for (std::size_t j = 0; j < x.size(); ++j) {
    product += x[j] * y[j] / n;
    square += (x[j] * x[j] - 1.0) * (y[j] * y[j] - 1.0) / n;
  }
  EXPECT_NEAR(product, 0.0, kStandardErrors / std::sqrt(n)) << what;
  EXPECT_NEAR(square, 0.0, kStandardErrors * 2.0 / std::sqrt(n)) << what << ", squares";
}

TEST(WhiteNoise, IsIndependentAcrossVehiclesStepsAndSeeds) {
  const std::vector<double> x = draw(1, {1, 0}, 0, kSample);
  expect_independent(x, draw(1, {2, 0}, 0, kSample), "next vehicle");
  expect_independent(x, draw(1, {1, 1}, 0, kSample), "next step");
  expect_independent(x, draw(1, {2, 1}, 0, kSample), "next vehicle at the next step");
  expect_independent(x, draw(1, {1, -1}, 0, kSample), "initial position");
  expect_independent(x, draw(2, {1, 0}, 0, kSample), "next seed");
  expect_independent(x, draw(1ULL << 32, {1, 0}, 0, kSample), "upper half of the seed");
}

TEST(WhiteNoise, IsIndependentAcrossRealizations) {
  const std::vector<double> x = draw(1, {1, 0}, 0, kSample + 64);
  for (const std::ptrdiff_t lag : {1, 2, 3, 63, 64}) {
    expect_independent({x.begin(), x.end() - 64}, {x.begin() + lag, x.end() - 64 + lag}, "lag " + std::to_string(lag));
  }
}

TEST(WhiteNoise, PartnersOfOneBlockAreIndependent) {
  const std::vector<double> x = draw(1, {1, 0}, 0, 2 * kSample);
  std::vector<double> cosine, sine;
  for (std::size_t j = 0; j < x.size(); j += 2) {
    cosine.push_back(x[j]);
    sine.push_back(x[j + 1]);
  }
  expect_independent(cosine, sine, "cosine and sine");
}

// One realization over many steps and vehicles, as in an endless run.
TEST(WhiteNoise, IsWhiteAlongTimeAndAlongTheString) {
  constexpr std::size_t kShort = 1 << 16;
  std::vector<double> time(kShort + 1), string(kShort + 1);
  const WhiteNoise noise(9);
  for (std::size_t j = 0; j <= kShort; ++j) {
    noise.fill({4, static_cast<std::int64_t>(j)}, 0, 1, &time[j]);
    noise.fill({static_cast<std::uint32_t>(j + 1), 4}, 0, 1, &string[j]);
  }
  for (const std::vector<double>& x : {time, string}) {
    double mean = 0.0, square = 0.0;
    for (const double value : x) {
      mean += value / (kShort + 1);
      square += value * value / (kShort + 1);
    }
    EXPECT_NEAR(mean, 0.0, kStandardErrors / std::sqrt(kShort));
    EXPECT_NEAR(square, 1.0, kStandardErrors * std::sqrt(2.0 / kShort));
    expect_independent({x.begin(), x.end() - 1}, {x.begin() + 1, x.end()}, "lag 1");
  }
}

TEST(WhiteNoise, DrawsUniformsFromTheWordsOfItsBlocks) {
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

// Pinned, as the normals above: recordings and checkpoints depend on them.
TEST(WhiteNoise, HasKnownAnswersForDitherAndLosses) {
  double value;
  WhiteNoise(1).fill_uniform({1, 0, Purpose::dither}, 0, 1, &value);
  EXPECT_EQ(value, 0x1.35199f671b1c8p-3);
  WhiteNoise(1).fill_uniform({1, 0, Purpose::loss}, 0, 1, &value);
  EXPECT_EQ(value, 0x1.3ff90e8cd156cp-1);
}

}  // namespace
}  // namespace platoon
