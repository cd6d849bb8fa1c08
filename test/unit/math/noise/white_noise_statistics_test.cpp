// Statistics of a fixed sample. Every tolerance is four standard errors of the estimator for independent
// standard normals; one sample in 500 fails one of about thirty comparisons by chance, and this one does not.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "unit/math/noise/draw.hpp"

namespace platoon {
namespace {

constexpr double kStandardErrors = 4.0;
constexpr std::size_t kSample = 1 << 18;

// (1/n) sum x^p and its tolerance: the variance of x^p is m_2p - m_p^2 with m_p = (p-1)!! for even p, else 0.
TEST(WhiteNoiseStatistics, HaveTheFirstSixMomentsOfTheStandardNormal) {
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
TEST(WhiteNoiseStatistics, HaveSkewnessAndKurtosisOfTheNormal) {
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
TEST(WhiteNoiseStatistics, HaveTheTailsOfTheNormal) {
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
TEST(WhiteNoiseStatistics, HaveTheDistributionOfTheNormal) {
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

TEST(WhiteNoiseStatistics, AreIndependentAcrossVehiclesStepsAndSeeds) {
  const std::vector<double> x = draw(1, {1, 0}, 0, kSample);
  expect_independent(x, draw(1, {2, 0}, 0, kSample), "next vehicle");
  expect_independent(x, draw(1, {1, 1}, 0, kSample), "next step");
  expect_independent(x, draw(1, {2, 1}, 0, kSample), "next vehicle at the next step");
  expect_independent(x, draw(1, {1, -1}, 0, kSample), "initial position");
  expect_independent(x, draw(2, {1, 0}, 0, kSample), "next seed");
  expect_independent(x, draw(1ULL << 32, {1, 0}, 0, kSample), "upper half of the seed");
}

TEST(WhiteNoiseStatistics, AreIndependentAcrossRealizations) {
  const std::vector<double> x = draw(1, {1, 0}, 0, kSample + 64);
  for (const std::ptrdiff_t lag : {1, 2, 3, 63, 64}) {
    expect_independent({x.begin(), x.end() - 64}, {x.begin() + lag, x.end() - 64 + lag}, "lag " + std::to_string(lag));
  }
}

TEST(WhiteNoiseStatistics, AreIndependentWithinABlock) {
  const std::vector<double> x = draw(1, {1, 0}, 0, 2 * kSample);
  std::vector<double> cosine, sine;
  for (std::size_t j = 0; j < x.size(); j += 2) {
    cosine.push_back(x[j]);
    sine.push_back(x[j + 1]);
  }
  expect_independent(cosine, sine, "cosine and sine");
}

// One realization over many steps and vehicles, as in an endless run.
TEST(WhiteNoiseStatistics, AreWhiteAlongTimeAndAlongTheString) {
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

}  // namespace
}  // namespace platoon
