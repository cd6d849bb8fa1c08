#include "stochastic_platoon/math/statistics/moments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "unit/math/statistics/two_pass_moments.hpp"

namespace platoon {
namespace {

std::vector<double> sample(std::size_t count, double mean, double deviation) {
  std::mt19937 generator(1);
  std::normal_distribution<double> value(mean, deviation);
  std::vector<double> values(count);
  for (double& v : values) v = value(generator);
  return values;
}

Moments welford(const std::vector<double>& values, std::size_t first, std::size_t count) {
  Moments moments;
  for (std::size_t j = first; j < first + count; ++j) moments.add(values[j]);
  return moments;
}

void expect_near(const Moments& found, const Moments& expected) {
  EXPECT_EQ(found.count, expected.count);
  EXPECT_NEAR(found.mean, expected.mean, 1e-13 * (1.0 + std::abs(expected.mean)));
  EXPECT_NEAR(found.squared_deviations, expected.squared_deviations, 1e-11 * expected.squared_deviations);
}

TEST(Moments, OfASmallSampleHaveTheirExactValues) {
  Moments moments;
  for (const double value : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) moments.add(value);
  EXPECT_EQ(moments.count, 8u);
  EXPECT_DOUBLE_EQ(moments.mean, 5.0);
  EXPECT_DOUBLE_EQ(moments.squared_deviations, 32.0);
  EXPECT_DOUBLE_EQ(moments.variance(), 32.0 / 7.0);
}

TEST(Moments, AddedOneByOneEqualThoseOfTwoPasses) {
  for (const double mean : {0.0, 1e4}) {
    const std::vector<double> values = sample(5000, mean, 2.0);
    expect_near(welford(values, 0, values.size()), two_pass_moments(values));
  }
}

TEST(Moments, MergedEqualThoseOfTheUnion) {
  const std::vector<double> values = sample(1000, 1e4, 2.0);
  for (const std::size_t cut : {0, 1, 2, 333, 999, 1000}) {
    const Moments left = welford(values, 0, cut);
    const Moments right = welford(values, cut, values.size() - cut);
    expect_near(merge(left, right), two_pass_moments(values));
    expect_near(merge(right, left), two_pass_moments(values));
  }
}

TEST(Moments, AreNotChangedByAnEmptySample) {
  const Moments some{3, 1.5, 2.5};
  for (const Moments& merged : {merge(some, Moments{}), merge(Moments{}, some)}) {
    EXPECT_EQ(merged.count, 3u);
    EXPECT_EQ(merged.mean, 1.5);
    EXPECT_EQ(merged.squared_deviations, 2.5);
  }
}

TEST(Moments, HaveNoVarianceBelowTwoValues) {
  Moments moments;
  EXPECT_TRUE(std::isnan(moments.variance()));
  moments.add(3.0);
  EXPECT_TRUE(std::isnan(moments.variance()));
  moments.add(5.0);
  EXPECT_DOUBLE_EQ(moments.variance(), 2.0);
}

TEST(Moments, KeepANaN) {
  Moments moments = welford({1.0, 2.0}, 0, 2);
  moments.add(std::nan(""));
  moments.add(1.0);
  EXPECT_TRUE(std::isnan(moments.mean));
  EXPECT_TRUE(std::isnan(merge(moments, Moments{5, 1.0, 1.0}).variance()));
}

TEST(StandardErrors, FollowTheirFormulas) {
  EXPECT_DOUBLE_EQ(standard_error_of_mean(0.6, 2400), std::sqrt(0.6 / 2400.0));
  EXPECT_DOUBLE_EQ(standard_error_of_variance(0.6, 201), 0.06);
  EXPECT_TRUE(std::isnan(standard_error_of_variance(0.6, 1)));
  EXPECT_TRUE(std::isnan(standard_error_of_variance(0.6, 0)));
}

// The estimates of 2000 samples of 50 normals have the standard deviations of the formulas. A standard deviation of
// 2000 values has a relative standard error of 1 / sqrt(4000) (a little more for the skewed variance); the tolerance is
// five of them.
TEST(StandardErrors, EqualTheScatterOfTheEstimates) {
  constexpr std::size_t kSamples = 2000, kCount = 50;
  const std::vector<double> values = sample(kSamples * kCount, 3.0, std::sqrt(0.6));
  Moments means, variances;
  for (std::size_t s = 0; s < kSamples; ++s) {
    const Moments one = welford(values, s * kCount, kCount);
    means.add(one.mean);
    variances.add(one.variance());
  }
  const double tolerance = 5.0 / std::sqrt(2.0 * kSamples);
  EXPECT_NEAR(std::sqrt(means.variance()) / standard_error_of_mean(0.6, kCount), 1.0, tolerance);
  EXPECT_NEAR(std::sqrt(variances.variance()) / standard_error_of_variance(0.6, kCount), 1.0, tolerance);
}

std::vector<double> skewed_sample(std::size_t count) {
  std::vector<double> values = sample(count, 0.5, 1.0);
  for (double& v : values) v = 100.0 + v * v * v;
  return values;
}

TEST(Moments, OfFourPowersMergedEqualThoseOfTheUnion) {
  const std::vector<double> values = skewed_sample(1000);
  const Moments expected = two_pass_moments(values);
  for (const std::size_t cut : {1, 2, 333, 999}) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(cut);
    const Moments merged = merge(two_pass_moments({values.begin(), middle}), two_pass_moments({middle, values.end()}));
    EXPECT_NEAR(merged.squared_deviations, expected.squared_deviations, 1e-12 * expected.squared_deviations);
    EXPECT_NEAR(merged.cubed_deviations, expected.cubed_deviations, 1e-12 * std::abs(expected.cubed_deviations));
    EXPECT_NEAR(merged.fourth_deviations, expected.fourth_deviations, 1e-12 * expected.fourth_deviations);
  }
}

TEST(Moments, NeedTheFourthPowersForTheErrorOfAnyVariance) {
  Moments moments;
  for (const double value : {1.0, 2.0, 4.0}) moments.add(value);
  EXPECT_TRUE(std::isnan(standard_error_of_variance(moments)));
  // Of two values d apart: v = d^2 / 2, m_4 = d^4 / 16, and the error sqrt((m_4 + v^2) / 2).
  const double of_two = standard_error_of_variance(two_pass_moments({1.0, 3.0}));
  EXPECT_DOUBLE_EQ(of_two, std::sqrt((1.0 + 4.0) / 2.0));
  EXPECT_GT(standard_error_of_variance(two_pass_moments({1.0, 2.0, 3.0})), 0.4);
  EXPECT_TRUE(std::isnan(standard_error_of_variance(two_pass_moments({1.0}))));
  // For the value 1 with probability q, else 0: m4 - v^2 = q (1 - q) (1 - 2 q)^2.
  std::vector<double> values(1000, 0.0);
  for (std::size_t j = 0; j < 100; ++j) values[10 * j] = 1.0;
  EXPECT_NEAR(standard_error_of_variance(two_pass_moments(values)), std::sqrt(0.1 * 0.9 * 0.64 / 1000.0), 1e-5);
}

}  // namespace
}  // namespace platoon
