#include "stochastic_platoon/math/string/effective_sample.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "stochastic_platoon/math/model/state_space.hpp"
#include "stochastic_platoon/math/simulation/platoon_string.hpp"
#include "stochastic_platoon/math/statistics/moments.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "unit/math/paper/lemma_one.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

/// Autocovariances of zeta_i at lags 0 .. count - 1 by the dense matrices of Lemma 1: xi(k+1) = A xi(k) + B_a d(k) +
/// B_b d(k-1), so that E xi(k+1) xi'(k) = A P + B_b P_d B_a'.
std::vector<std::vector<double>> dense_autocovariances(const PlatoonModel& model, std::size_t followers, int count) {
  const StringMatrices string =
      string_matrices(model.default_vehicle().loop.realization, model.default_vehicle().headway, followers);
  const Eigen::MatrixXd p =
      solve_discrete_lyapunov(string.a, noise_covariance(string, model.default_vehicle().position().noise_variance));
  Eigen::MatrixXd at_lag = p;
  std::vector<std::vector<double>> covariances(followers);
  for (int lag = 0; lag < count; ++lag) {
    for (std::size_t i = 0; i < followers; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      covariances[i].push_back((string.c.row(row) * at_lag).dot(string.c.row(row)));
    }
    at_lag = (string.a * at_lag).eval();
    if (lag == 0) at_lag += model.default_vehicle().position().noise_variance * string.b_b * string.b_a.transpose();
  }
  return covariances;
}

/// By n x n matrices: (n - 1) s^2 = x'M x with M = 1 - ones / n, of mean tr M S and variance 2 tr (M S)^2.
IndependentShare dense_sample(const std::vector<double>& covariance, Eigen::Index n) {
  Eigen::MatrixXd s(n, n);
  for (Eigen::Index t = 0; t < n; ++t) {
    for (Eigen::Index u = 0; u < n; ++u) s(t, u) = covariance[static_cast<std::size_t>(std::abs(t - u))];
  }
  const auto steps = static_cast<double>(n);
  const Eigen::MatrixXd ms = s - Eigen::MatrixXd::Constant(n, n, 1.0 / steps) * s;
  const double p = covariance[0], of_mean = s.sum() / (steps * steps),
               of_variance = 2.0 * (ms * ms).trace() / std::pow(steps - 1.0, 2);
  return {p / of_mean / steps, 2.0 * p * p / of_variance / (steps - 1.0), ms.trace() / (steps - 1.0) / p};
}

// From two steps to many times the correlation length.
TEST(EffectiveSample, FollowsFromTheAutocovariancesOfLemmaOne) {
  for (const double headway : {3.2, 2.4}) {
    const PlatoonModel model = paper_platoon(headway);
    const auto covariances = dense_autocovariances(model, 6, 400);
    const std::vector<ErrorCorrelation> found = error_correlations(model, 6);
    ASSERT_EQ(found.size(), 6u);
    for (const std::size_t i : {0u, 3u, 5u}) {
      EXPECT_LT(found[i].length(), 200u);
      for (const int steps : {2, 3, 17, 60, 150, 400}) {
        const IndependentShare expected = dense_sample(covariances[i], steps),
                               sample = found[i].of(static_cast<std::uint64_t>(steps));
        EXPECT_NEAR(sample.mean / expected.mean, 1.0, 1e-9) << headway << " " << i << " " << steps;
        EXPECT_NEAR(sample.variance / expected.variance, 1.0, 1e-9) << headway << " " << i << " " << steps;
        EXPECT_NEAR(sample.expected / expected.expected, 1.0, 1e-9) << headway << " " << i << " " << steps;
      }
    }
  }
}

// The share does not jump where the closed form takes over, nor without kept values.
TEST(EffectiveSample, IsLinearFromTwiceTheCorrelationLengthOn) {
  const ErrorCorrelation found = error_correlations(paper_platoon(2.4), 60).back();
  const std::uint64_t from = 2 * found.length();
  const auto of_ones = [&](std::uint64_t n) { return static_cast<double>(n) / found.of(n).mean; };
  EXPECT_NEAR((of_ones(from - 1) + of_ones(from + 1)) / (2.0 * of_ones(from)), 1.0, 1e-9);
  const std::vector<double> covariance{1.0, -0.4, 0.1};
  const ErrorCorrelation whole(covariance, 0.4, true), rest(covariance, 0.4, false);
  EXPECT_EQ(whole.of(6).variance, rest.of(6).variance);
  EXPECT_TRUE(std::isnan(rest.of(5).variance));
  EXPECT_NEAR(whole.of(5).variance, dense_sample({1.0, -0.4, 0.1, 0.0, 0.0}, 5).variance, 1e-14);
  EXPECT_TRUE(std::isnan(whole.of(1).mean));
}

// The covariance matrix has one block per stretch. Checks the closed form and the sums.
TEST(EffectiveSample, OfIndependentStretchesFollowsFromTheirCovariance) {
  const ErrorCorrelation found({1.0, -0.4, 0.1}, 0.4, true);
  for (const int length : {4, 10}) {
    const auto n = static_cast<Eigen::Index>(3 * length);
    Eigen::MatrixXd s = Eigen::MatrixXd::Zero(n, n);
    const std::vector<double> r{1.0, -0.4, 0.1};
    for (Eigen::Index t = 0; t < n; ++t) {
      for (Eigen::Index u = 0; u < n; ++u) {
        const auto lag = static_cast<std::size_t>(std::abs(t - u));
        if (t / length == u / length && lag < 3) s(t, u) = r[lag];
      }
    }
    const auto steps = static_cast<double>(n);
    const Eigen::MatrixXd ms = s - Eigen::MatrixXd::Constant(n, n, 1.0 / steps) * s;
    const IndependentShare sample = found.of(static_cast<std::uint64_t>(n), 3);
    EXPECT_NEAR(sample.mean, steps / s.sum(), 1e-13) << length;
    EXPECT_NEAR(sample.variance, (steps - 1.0) / (ms * ms).trace(), 1e-13) << length;
    EXPECT_NEAR(sample.expected, ms.trace() / (steps - 1.0), 1e-13) << length;
  }
}

// For the last follower of a long string the mean is worth n P / Phi(0) errors only if n exceeds any number of steps.
TEST(EffectiveSample, IsFarFromItsLimitInAStringUnstablePlatoon) {
  const std::vector<ErrorCorrelation> found = error_correlations(paper_platoon(2.4), 60);
  EXPECT_NEAR(found[19].of(std::uint64_t{1} << 62).mean, 292.8, 0.1);
  EXPECT_NEAR(found[19].of(2928).mean, 191.6, 0.1);
  EXPECT_LT(found[59].of(3000).mean * 1e4, found[59].of(std::uint64_t{1} << 62).mean);
}

TEST(EffectiveSample, OfALongStringTakesNoLongerForABillionSteps) {
  const ErrorCorrelation last = error_correlations(paper_platoon(2.4), 500).back();
  EXPECT_GT(last.of(1000000000).variance, 0.01);
  EXPECT_LT(last.of(1000000000).variance, last.of(5000).variance);
}

// Averages over 1000 steps in each of 3000 realizations: their own variances have a relative standard error of
// sqrt(2 / 3000), five of which are allowed.
TEST(EffectiveSample, GivesTheStandardErrorsOfAveragesOverTime) {
  constexpr std::size_t kBatch = 500, kRealizations = 3000;
  constexpr std::int64_t kSteps = 1000;
  struct Case {
    double headway;
    std::int64_t burn_in;
    std::vector<std::size_t> followers;
  };
  for (const Case& of : {Case{3.2, 200, {1, 4}}, Case{2.4, 1000, {20, 60}}}) {
    const PlatoonModel model = paper_platoon(of.headway);
    const std::size_t count = of.followers.back();
    const std::vector<ErrorCorrelation> correlations = error_correlations(model, count);
    const std::vector<double> variance = stationary_variances(model, count);
    std::vector<Moments> means(count), variances(count);
    for (std::uint64_t first = 0; first < kRealizations; first += kBatch) {
      std::vector<std::vector<Moments>> averages(count, std::vector<Moments>(kBatch));
      PlatoonString(model, 17, count)
          .run(first, kBatch, of.burn_in + kSteps,
               [&](std::size_t i, std::int64_t k, const SignalPositions& positions) {
                 if (k < of.burn_in) return;
                 const std::vector<double> errors = positions.of(tracking_error(model, i));
                 for (std::size_t r = 0; r < kBatch; ++r) averages[i - 1][r].add(errors[r]);
               });
      for (const std::size_t i : of.followers) {
        for (const Moments& average : averages[i - 1]) {
          means[i - 1].add(average.mean);
          variances[i - 1].add(average.variance());
        }
      }
    }
    for (const std::size_t i : of.followers) {
      const IndependentShare sample = correlations[i - 1].of(kSteps);
      const double of_mean = standard_error_of_mean(variance[i - 1], kSteps, sample.mean);
      const double of_variance = standard_error_of_variance(variance[i - 1], kSteps, sample.variance);
      const double tolerance = 5.0 * std::sqrt(2.0 / kRealizations);
      EXPECT_NEAR(means[i - 1].variance() / (of_mean * of_mean), 1.0, tolerance) << of.headway << " " << i;
      EXPECT_NEAR(variances[i - 1].variance() / (of_variance * of_variance), 1.0, tolerance) << of.headway << " " << i;
      EXPECT_NEAR(variances[i - 1].mean, variance[i - 1] * sample.expected,
                  5.0 * of_variance / std::sqrt(kRealizations))
          << of.headway << " " << i;
    }
  }
}

TEST(EffectiveSample, IsUnknownIfPacketsAreLost) {
  PlatoonModel model = paper_platoon(3.2);
  model.default_vehicle().position().link.loss = LossModel{0.1, {}, {1.0}};
  for (const ErrorCorrelation& correlation : error_correlations(model, 3)) {
    EXPECT_EQ(correlation.length(), 0u);
    EXPECT_TRUE(std::isnan(correlation.of(1000).mean));
    EXPECT_TRUE(std::isnan(correlation.of(1000).variance));
  }
}

TEST(EffectiveSample, CountsEveryStepWithoutNoise) {
  PlatoonModel model = paper_platoon(3.2);
  model.default_vehicle().position().noise_variance = 0.0;
  for (const std::uint64_t steps : {2u, 1000u}) {
    const IndependentShare sample = error_correlations(model, 2)[1].of(steps);
    EXPECT_NEAR(sample.variance, 1.0, 1e-12);
    EXPECT_NEAR(sample.mean, 1.0, 1e-12);
    EXPECT_NEAR(sample.expected, 1.0, 1e-12);
  }
}

TEST(EffectiveSample, StaysFiniteForHugeVariances) {
  const IndependentShare last = error_correlations(paper_platoon(1.2), 200).back().of(100000);
  EXPECT_GT(last.variance, 0.0);
  EXPECT_LT(last.variance, 1.0);
}

}  // namespace
}  // namespace platoon
