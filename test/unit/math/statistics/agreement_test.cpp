#include "stochastic_platoon/math/statistics/agreement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "unit/agreement_of.hpp"

#include "unit/math/statistics/two_pass_moments.hpp"

namespace platoon {
namespace {

Moments measured(std::uint64_t count, double mean, double variance) {
  return {count, mean, variance * static_cast<double>(count - 1)};
}

Scores scores(const Moments& of, double mean, double variance, double rounding = 0.0, double fourth_moment = kNaN) {
  return platoon::scores({of, mean, variance, rounding, {}, fourth_moment});
}

TEST(Scores, OfTheMeanAreDistancesInStandardErrors) {
  EXPECT_NEAR(scores(measured(201, 1.3, 0.9), 1.0, 0.6).mean, 0.3 / std::sqrt(0.6 / 201.0), 1e-12);
  EXPECT_NEAR(scores(measured(2, 0.7, 0.9), 1.0, 0.6).mean, -0.3 / std::sqrt(0.3), 1e-12);
}

// With 2 degrees of freedom the chi-squared distribution is exponential, P(x > a) = exp(-a / 2); with 1 it is
// that of a squared normal.
TEST(Scores, OfTheVarianceHaveTheTailOfChiSquared) {
  const auto upper = [](double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); };
  for (const double ratio : {3.0, 10.0, 30.0}) {
    EXPECT_NEAR(upper(scores(measured(3, 0.0, ratio * 0.6), 0.0, 0.6).variance), std::exp(-ratio),
                1e-12 * std::exp(-ratio));
    EXPECT_NEAR(upper(scores(measured(2, 0.0, ratio * 0.6), 0.0, 0.6).variance), 2.0 * upper(std::sqrt(ratio)),
                1e-12 * upper(std::sqrt(ratio)));
  }
  const double below = scores(measured(3, 0.0, 0.6e-6), 0.0, 0.6).variance;
  EXPECT_NEAR(upper(-below), -std::expm1(-1e-6), 1e-19);
  EXPECT_EQ(scores(measured(3, 0.0, 0.0), 0.0, 0.6).variance, -kInfinity);
}

// Between the median and the mean of chi-squared, and on both sides: the score grows with the variance.
TEST(Scores, OfTheVarianceGrowWithIt) {
  for (const std::uint64_t count : {2u, 3u, 10u, 1000u}) {
    double before = -kInfinity;
    for (double ratio = 1e-3; ratio < 1e4; ratio *= 1.01) {
      const double z = scores(measured(count, 0.0, ratio), 0.0, 1.0).variance;
      EXPECT_GT(z, before) << count << " values, ratio " << ratio;
      before = z;
    }
  }
}

// The tail probability of a score beyond 37 underflows; there the asymptotic formula takes over without a step.
TEST(Scores, OfTheVarianceContinueBeyondTheRangeOfDouble) {
  for (const std::uint64_t count : {2u, 3u, 10u, 1000u, 1000000u}) {
    double ratio = 1.0, before = 0.0, step = 0.0;
    for (; before < 60.0; ratio *= 1.0001) {
      if (ratio == 1.0) before = scores(measured(count, 0.0, ratio), 0.0, 1.0).variance;
      const double z = scores(measured(count, 0.0, ratio), 0.0, 1.0).variance;
      ASSERT_GT(z, before - 1e-2) << count << " values, ratio " << ratio;
      step = std::max(step, z - before);
      before = z;
    }
    EXPECT_LT(step, 0.11) << count;
  }
}

// A variance of rounding over one that has decayed.
TEST(Scores, OfTheVarianceExistAtEveryRatio) {
  for (const std::uint64_t count : {2u, 400u, 1000000u}) {
    for (const double ratio : {1e10, 1e40, 1e200, 1e300}) {
      const double z = scores(measured(count, 0.0, ratio), 0.0, 1.0).variance;
      EXPECT_GT(z, 1e4) << count << " values, ratio " << ratio;
    }
    EXPECT_LT(scores(measured(count, 0.0, 1e-300), 0.0, 1.0).variance, 0.0);
  }
}

TEST(Scores, OfManyValuesAreDistancesInStandardErrors) {
  const std::uint64_t count = 100000000;
  const double error = 0.6 * std::sqrt(2.0 / static_cast<double>(count - 1));
  for (const double z : {-4.0, -1.0, 0.5, 3.0}) {
    EXPECT_NEAR(scores(measured(count, 0.0, 0.6 + z * error), 0.0, 0.6).variance, z, 1e-3 * z * z + 1e-3);
  }
}

// Normal samples: the share of scores beyond the bound is the nominal one.
TEST(Scores, OfFewRealizationsExceedABoundAsOftenAsStated) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  const double bound = 2.5758293035489004;  // |z| beyond it once in 100
  for (const std::uint64_t count : {2u, 3u, 10u, 100u}) {
    constexpr int kSamples = 40000;
    int mean_beyond = 0, variance_beyond = 0;
    for (int sample = 0; sample < kSamples; ++sample) {
      Moments moments;
      for (std::uint64_t r = 0; r < count; ++r) moments.add(0.3 + std::sqrt(2.0) * normal(generator));
      const Scores z = scores(moments, 0.3, 2.0);
      mean_beyond += std::abs(z.mean) > bound ? 1 : 0;
      variance_beyond += std::abs(z.variance) > bound ? 1 : 0;
    }
    const double error = std::sqrt(0.01 * 0.99 * kSamples);  // binomial
    EXPECT_NEAR(mean_beyond, 0.01 * kSamples, 4.0 * error) << count;
    EXPECT_NEAR(variance_beyond, 0.01 * kSamples, 4.0 * error) << count;
  }
}

/// Standard normal values; with probability `chance` a value is 20 + 30 times a normal instead.
struct RareOutliers {
  double chance;
  double mean() const { return 20.0 * chance; }
  double variance() const { return raw(2) - mean() * mean(); }
  double fourth_moment() const {
    const double m = mean();
    return raw(4) - 4.0 * m * raw(3) + 6.0 * m * m * raw(2) - 3.0 * m * m * m * m;
  }
  double draw(std::mt19937_64& generator) const {
    std::normal_distribution<double> normal;
    const double value = normal(generator);
    return std::uniform_real_distribution<double>()(generator) < chance ? 20.0 + 30.0 * value : value;
  }

private:
  double raw(int power) const {
    const double s = 900.0, a = 20.0;
    const double of_outliers = power == 2   ? a * a + s
                               : power == 3 ? a * a * a + 3.0 * a * s
                                            : a * a * a * a + 6.0 * a * a * s + 3.0 * s * s;
    return chance * of_outliers + (1.0 - chance) * (power == 2 ? 1.0 : power == 3 ? 0.0 : 3.0);
  }
};

// With or without outliers among the values, the share beyond the bound for once in 1000 is at most that, to three
// standard errors. With a measured fourth moment and the bound for normal scores it exceeds a tenth.
TEST(Scores, OfAnyDistributionExceedTheirBoundNoMoreOftenThanStated) {
  std::mt19937_64 generator(11);
  for (const RareOutliers& of : {RareOutliers{0.0003}, RareOutliers{0.003}, RareOutliers{0.03}}) {
    for (const int count : {20, 200, 1000}) {
      constexpr int kSamples = 4000;
      int mean_beyond = 0, variance_beyond = 0, by_measured = 0;
      for (int sample = 0; sample < kSamples; ++sample) {
        std::vector<double> values;
        for (int r = 0; r < count; ++r) values.push_back(of.draw(generator));
        const Moments moments = two_pass_moments(values);
        const Scores z = scores(moments, of.mean(), of.variance(), 0.0, of.fourth_moment());
        mean_beyond += std::abs(z.mean) > plausible_score_of_any(1) ? 1 : 0;
        variance_beyond += std::abs(z.variance) > plausible_score_of_any(1) ? 1 : 0;
        by_measured +=
            std::abs(scores(moments, of.mean(), of.variance()).variance) > largest_plausible_score(1) ? 1 : 0;
      }
      const double most = 0.001 * kSamples + 3.0 * std::sqrt(0.001 * kSamples);
      EXPECT_LE(mean_beyond, most) << of.chance << " " << count;
      EXPECT_LE(variance_beyond, most) << of.chance << " " << count;
      if (of.chance * count < 0.5) {
        EXPECT_GT(by_measured, kSamples / 10) << of.chance << " " << count;
      }
    }
  }
}

// For many values the scores are distances in standard errors, so that a difference is detected.
TEST(Scores, OfAnyDistributionAreDistancesInStandardErrors) {
  const double v = 0.6, fourth = 9.0 * v * v, n = 1e6;
  for (const double z : {-7.0, -3.0, 4.0, 8.0}) {
    const double error = std::sqrt((fourth - v * v) / n), variance = v + z * error;
    const Moments moments{1000000, 5.0, variance * n, 0.0, 9.0 * variance * variance * n};
    EXPECT_NEAR(scores(moments, 5.0, v, 0.0, fourth).variance, z, 0.02 * std::abs(z));
    const Moments shifted{1000000, 5.0 + z * std::sqrt(v / n), v * n, 0.0, fourth * n};
    EXPECT_NEAR(scores(shifted, 5.0, v, 0.0, fourth).mean, z, 0.02 * std::abs(z));
  }
  EXPECT_EQ(scores(measured(100, 5.1, 1.0), 5.0, 1.0, 0.2, 9.0).mean, 0.0) << "within the rounding";
}

// The variance is due to rare events alone, and none of them is among these values.
TEST(ValuesNeeded, DistinguishNoEventsFromTheTheoreticalVariance) {
  const double v = 0.6, fourth = 700.0 * v * v;
  const double needed = values_needed(v, fourth, 4000);
  EXPECT_NEAR(needed, 24400.0, 100.0);
  const auto of = [&](double n) {
    const Moments nothing{static_cast<std::uint64_t>(n), 0.0, 0.0, 0.0, 0.0};
    return std::abs(scores(nothing, 0.0, v, 0.0, fourth).variance);
  };
  EXPECT_GT(of(1.1 * needed), plausible_score_of_any(4000));
  EXPECT_LT(of(0.6 * needed), plausible_score_of_any(4000));
  EXPECT_EQ(values_needed(0.0, 0.0, 4000), 0.0);
  EXPECT_TRUE(std::isinf(values_needed(kInfinity, kNaN, 4000)));
}

TEST(Scores, AreZeroWithinTheRounding) {
  const Scores z = scores(measured(100, 5.0 + 1e-12, 1e-25), 5.0, 0.0, 2e-12);
  EXPECT_EQ(z.mean, 0.0);
  EXPECT_EQ(z.variance, 0.0);
  EXPECT_TRUE(std::isinf(scores(measured(100, 5.0 + 1e-12, 0.0), 5.0, 0.0, 5e-13).mean));
  EXPECT_TRUE(std::isinf(scores(measured(100, 5.0, 1e-25), 5.0, 0.0, 2e-13).variance));
  EXPECT_NEAR(scores(measured(100, 5.3, 1.0), 5.0, 1.0, 0.1).mean, 2.0, 1e-12);
}

TEST(Scores, WithoutRandomnessAreInfiniteForAnyDifference) {
  EXPECT_TRUE(std::isinf(scores(measured(100, 5.0001, 0.0), 5.0, 0.0).mean));
  EXPECT_TRUE(std::isinf(scores(measured(100, 5.0, 1e-4), 5.0, 0.0).variance));
}

TEST(Scores, OfUndefinedMomentsAreNeverPlausible) {
  EXPECT_FALSE(std::abs(scores(measured(100, kNaN, 1.0), 5.0, 1.0).mean) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(100, kNaN, 0.0), 5.0, 0.0).mean) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(100, 5.0, kNaN), 5.0, 1.0).variance) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(100, 5.0, 1.0), kNaN, 1.0).mean) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(100, 5.0, 1.0), 5.0, kNaN).variance) < 40.0);
  EXPECT_FALSE(std::abs(scores(measured(1, 5.0, 0.0), 5.0, 1.0).variance) < 40.0);
  EXPECT_FALSE(std::abs(scores(Moments{}, 5.0, 1.0).mean) < 40.0);
  EXPECT_FALSE(std::abs(scores(Moments{}, 5.0, 1.0).variance) < 40.0);
}

TEST(Agreement, IsTheLargestModulusOverAllCells) {
  const Agreement found = agreement_of({measured(101, 0.1, 1.0), measured(101, -0.4, 1.3), measured(101, 0.2, 0.5)},
                                       {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0});
  EXPECT_NEAR(found.max_abs_z_mean, 0.4 * std::sqrt(101.0), 1e-12);
  EXPECT_EQ(found.max_abs_z_variance, -scores(measured(101, 0.2, 0.5), 0.0, 1.0).variance);
}

// One value in 400 is 20, all others -20 / 399: the bound holds although a sample of 100 values seldom has one.
TEST(Agreement, OfMeansAloneHoldsForAnyDistribution) {
  const double rare = 1.0 / 400.0, high = 20.0, low = -rare * high / (1.0 - rare);
  const double variance = rare * high * high + (1.0 - rare) * low * low;
  std::mt19937_64 random(11);
  std::bernoulli_distribution is_rare(rare);
  int disagree = 0, shifted_disagree = 0;
  for (int run = 0; run < 2000; ++run) {
    LargestScores scores, of_shifted;
    double sum = 0.0, squares = 0.0;
    constexpr int kValues = 1000;
    for (int n = 0; n < kValues; ++n) {
      const double value = is_rare(random) ? high : low;
      sum += value;
      squares += value * value;
    }
    const double mean = sum / kValues;
    const Moments values = measured(kValues, mean, (squares - kValues * mean * mean) / (kValues - 1));
    scores.add_mean({values, 0.0, variance});
    of_shifted.add_mean({values, 0.5 * std::sqrt(variance), variance});
    EXPECT_TRUE(scores.agreement().means_only);
    EXPECT_TRUE(std::isnan(scores.agreement().max_abs_z_variance));
    EXPECT_EQ(scores.agreement().largest(), scores.agreement().max_abs_z_mean);
    EXPECT_EQ(scores.agreement().plausible_z, plausible_score_of_any(1));
    disagree += scores.agreement().agrees() ? 0 : 1;
    shifted_disagree += of_shifted.agreement().agrees() ? 0 : 1;
  }
  EXPECT_LE(disagree, 8) << "2 of 2000 at most on average";
  EXPECT_EQ(shifted_disagree, 2000);
  LargestScores undefined;
  undefined.add_mean({measured(100, kNaN, 1.0), 0.0, 1.0});
  EXPECT_FALSE(undefined.agreement().agrees());
}

TEST(Agreement, OfNoCellsIsZero) {
  EXPECT_EQ(agreement_of({}, {}, {}).max_abs_z_mean, 0.0);
  EXPECT_EQ(agreement_of({}, {}, {}).max_abs_z_variance, 0.0);
}

TEST(Agreement, IsNeverPlausibleWithANaNInAnyCell) {
  const Moments good = measured(101, 0.1, 1.1), bad = measured(101, kNaN, kNaN);
  const std::vector<double> zero(3, 0.0), one(3, 1.0);
  for (std::size_t place = 0; place < 3; ++place) {
    std::vector<Moments> cells(3, good);
    cells[place] = bad;
    const Agreement found = agreement_of(cells, zero, one);
    EXPECT_FALSE(found.max_abs_z_mean < 40.0) << "NaN in cell " << place;
    EXPECT_FALSE(found.max_abs_z_variance < 40.0) << "NaN in cell " << place;
  }
}

// The two-sided quantiles of the standard normal at 0.001, 0.0001 and 0.000001.
TEST(LargestPlausibleScore, IsTheNormalQuantileOfAThousandthOverAllScores) {
  EXPECT_NEAR(largest_plausible_score(1), 3.290526731491896, 1e-12);
  EXPECT_NEAR(largest_plausible_score(10), 3.890591886413120, 1e-12);
  EXPECT_NEAR(largest_plausible_score(1000), 4.891638475699428, 1e-11);
  EXPECT_EQ(largest_plausible_score(0), largest_plausible_score(1));
}

}  // namespace
}  // namespace platoon
