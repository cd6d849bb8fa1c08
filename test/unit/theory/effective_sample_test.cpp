#include "stochastic_platoon/theory/effective_sample.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "../paper_platoon.hpp"
#include "stochastic_platoon/model/state_space.hpp"
#include "stochastic_platoon/simulation/platoon_string.hpp"
#include "stochastic_platoon/statistics/moments.hpp"
#include "stochastic_platoon/theory/lemma_one.hpp"
#include "stochastic_platoon/theory/stationary_variance.hpp"

namespace platoon {
namespace {

/// Sums over all lags of the autocovariance of zeta_i and of its square, by the dense matrices of Lemma 1:
/// xi(k+1) = A xi(k) + B_a d(k) + B_b d(k-1), so that E xi(k+1) xi'(k) = A P + B_b P_d B_a'.
struct Sums {
  double autocovariance, square;
};

std::vector<Sums> dense_sums(const PlatoonModel& model, std::size_t followers) {
  const StringMatrices string = string_matrices(model.loop.realization, model.headway, followers);
  const Eigen::MatrixXd p = solve_discrete_lyapunov(string.a, noise_covariance(string, model.noise_variance));
  const Eigen::MatrixXd at_lag_one =
      string.a * p + model.noise_variance * string.b_b * string.b_a.transpose();
  std::vector<Sums> sums;
  for (std::size_t i = 0; i < followers; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double variance = (string.c.row(row) * p).dot(string.c.row(row));
    Sums of{variance, variance * variance};
    Eigen::MatrixXd at_lag = at_lag_one;
    for (int lag = 1; lag < 1000; ++lag) {
      const double covariance = (string.c.row(row) * at_lag).dot(string.c.row(row));
      of.autocovariance += 2.0 * covariance;
      of.square += 2.0 * covariance * covariance;
      at_lag = string.a * at_lag;
    }
    sums.push_back(of);
  }
  return sums;
}

TEST(EffectiveSample, IsThatOfTheAutocovariancesOfLemmaOne) {
  for (const double headway : {3.2, 2.4}) {
    const PlatoonModel model = paper_platoon(headway);
    const std::vector<Sums> sums = dense_sums(model, 6);
    const std::vector<double> variance = stationary_variances(model, 6);
    const std::vector<EffectiveSample> samples = effective_samples(model, 6);
    ASSERT_EQ(samples.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(samples[i].mean * sums[i].autocovariance / variance[i], 1.0, 1e-9) << headway << " " << i;
      EXPECT_NEAR(samples[i].variance * sums[i].square / (variance[i] * variance[i]), 1.0, 1e-9)
          << headway << " " << i;
    }
  }
}

// Averages over 4000 steps in each of 8000 realizations: their own variances have a relative standard error of
// sqrt(2 / 8000), five of which are allowed.
TEST(EffectiveSample, GivesTheStandardErrorsOfAveragesOverTime) {
  constexpr std::size_t kFollowers = 4, kBatch = 500;
  constexpr std::int64_t kBurnIn = 200, kSteps = 4000;
  const PlatoonModel model = paper_platoon(3.2);
  const std::vector<EffectiveSample> samples = effective_samples(model, kFollowers);
  const std::vector<double> variance = stationary_variances(model, kFollowers);
  std::vector<Moments> means(kFollowers), variances(kFollowers);
  for (std::uint64_t first = 0; first < 8000; first += kBatch) {
    std::vector<std::vector<Moments>> averages(kFollowers, std::vector<Moments>(kBatch));
    PlatoonString(model, 17, kFollowers)
        .run(first, kBatch, kBurnIn + kSteps,
             [&](std::size_t follower, std::int64_t step, const std::vector<double>& errors) {
               if (step < kBurnIn) return;
               for (std::size_t r = 0; r < kBatch; ++r) averages[follower - 1][r].add(errors[r]);
             });
    for (std::size_t i = 0; i < kFollowers; ++i) {
      for (const Moments& average : averages[i]) {
        means[i].add(average.mean);
        variances[i].add(average.variance());
      }
    }
  }
  for (std::size_t i = 0; i < kFollowers; ++i) {
    const double of_mean = standard_error_of_mean(variance[i], kSteps, samples[i].mean);
    const double of_variance = standard_error_of_variance(variance[i], kSteps, samples[i].variance);
    const double tolerance = 5.0 * std::sqrt(2.0 / 8000.0);
    EXPECT_NEAR(means[i].variance() / (of_mean * of_mean), 1.0, tolerance) << i + 1;
    EXPECT_NEAR(variances[i].variance() / (of_variance * of_variance), 1.0, tolerance) << i + 1;
  }
}

TEST(EffectiveSample, IsUnknownFromTheFirstLinkThatLosesOn) {
  PlatoonModel model = paper_platoon(3.2);
  model.link.loss = LossModel{0.1, {}, {1.0}};
  for (const EffectiveSample& sample : effective_samples(model, 3)) {
    EXPECT_TRUE(std::isnan(sample.mean));
    EXPECT_TRUE(std::isnan(sample.variance));
  }
}

TEST(EffectiveSample, OfNothingRandomIsEveryStep) {
  PlatoonModel model = paper_platoon(3.2);
  model.noise_variance = 0.0;
  EXPECT_EQ(effective_samples(model, 2)[1].variance, 1.0);
  EXPECT_EQ(effective_samples(model, 2)[1].mean, 1.0);
}

TEST(EffectiveSample, StaysAFigureWhereVariancesGrowBeyondEverySquare) {
  const EffectiveSample last = effective_samples(paper_platoon(1.2), 200).back();
  EXPECT_GT(last.variance, 0.0);
  EXPECT_LT(last.variance, 1.0);
}

}  // namespace
}  // namespace platoon
