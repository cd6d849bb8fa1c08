#include "stochastic_platoon/math/channel/information_age.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace platoon {
namespace {

LossModel losses(double q, std::optional<double> mean_burst = {}) {
  LossModel loss;
  loss.probability = q;
  loss.mean_burst = mean_burst;
  return loss;
}

TEST(InformationAge, OfIndependentLossesIsGeometric) {
  const std::vector<double> p = age_probabilities(losses(0.25));
  for (std::size_t n = 0; n < p.size(); ++n) EXPECT_NEAR(p[n], 0.75 * std::pow(0.25, static_cast<double>(n)), 1e-16);
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(mean_age(losses(0.25)), 1.0 / 3.0);
  EXPECT_EQ(age_probabilities(losses(0.0)), (std::vector<double>{1.0}));
}

TEST(InformationAge, SumsToOneAndHasItsMeanForAnyBursts) {
  for (const LossModel& loss : {losses(0.1, 2.0), losses(0.4, 9.0), losses(0.8, 4.0), losses(0.3, 1.0 / 0.7)}) {
    const std::vector<double> p = age_probabilities(loss);
    double sum = 0.0, mean = 0.0;
    for (std::size_t n = 0; n < p.size(); ++n) {
      sum += p[n];
      mean += static_cast<double>(n) * p[n];
    }
    EXPECT_NEAR(sum, 1.0, 2e-12);
    EXPECT_NEAR(mean, mean_age(loss), 1e-9);
    for (const std::int64_t steps : {1, 7, 100}) {
      double shares = 0.0;
      for (std::int64_t n = 0; n <= steps + 3; ++n) shares += expected_age_share(loss, n, steps);
      EXPECT_NEAR(shares, 1.0, 1e-14) << steps;
    }
  }
}

// The chain step by step: the probability that the age is n at step k.
TEST(InformationAge, HasTheSharesOfTheChain) {
  const LossModel loss = losses(0.3, 2.5);
  constexpr std::int64_t kSteps = 12;
  std::vector<double> now(kSteps + 2, 0.0), shares(kSteps + 2, 0.0);
  for (std::int64_t k = 0; k < kSteps; ++k) {
    std::vector<double> next(kSteps + 2, 0.0);
    if (k == 0) {
      next[0] = 1.0 - loss.probability;
      next[1] = loss.probability;
    } else {
      for (std::size_t n = 0; n <= kSteps; ++n) {
        const double lost = n == 0 ? loss.after_arrival() : loss.after_loss();
        next[0] += (1.0 - lost) * now[n];
        next[n + 1] += lost * now[n];
      }
    }
    now = next;
    for (std::size_t n = 0; n < now.size(); ++n) shares[n] += now[n] / kSteps;
  }
  for (std::size_t n = 0; n < shares.size(); ++n)
    EXPECT_NEAR(expected_age_share(loss, static_cast<std::int64_t>(n), kSteps), shares[n], 1e-15) << n;
}

// Steps of different realizations are independent: the standard error of a share follows from the realizations.
TEST(InformationAge, HasTheSharesOfItsDraws) {
  for (const LossModel& loss : {losses(0.2), losses(0.2, 3.0)}) {
    constexpr std::uint64_t kRealizations = 40000;
    constexpr std::int64_t kSteps = 30;
    const std::vector<std::uint64_t> counts = count_ages(loss, 5, 2, kRealizations, kSteps);
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}), kRealizations * kSteps);
    for (std::size_t n = 0; n < 6; ++n) {
      const double expected = expected_age_share(loss, static_cast<std::int64_t>(n), kSteps);
      const double share = static_cast<double>(counts[n]) / static_cast<double>(kRealizations * kSteps);
      // Upper bound: the error if all steps of a realization had the same age.
      const double error = std::sqrt(expected * (1.0 - expected) / kRealizations);
      EXPECT_NEAR(share, expected, 4.0 * error) << n;
    }
  }
}

TEST(InformationAge, IsCountedInRealizationsFromAnyOneOn) {
  const LossModel loss = losses(0.3, 2.0);
  std::vector<std::uint64_t> counts = count_ages(loss, 5, 2, 3, 400), later = count_ages(loss, 5, 2, 2, 400, 1);
  const std::vector<std::uint64_t> first = count_ages(loss, 5, 2, 1, 400);
  later.resize(counts.size());
  for (std::size_t n = 0; n < first.size(); ++n) later[n] += first[n];
  EXPECT_EQ(later, counts);
  EXPECT_NE(count_ages(loss, 5, 2, 1, 400, 1), first);
}

TEST(InformationAge, FollowsATraceAndRejectsLossesByDistance) {
  LossModel loss;
  loss.trace = std::make_shared<LossTrace>(LossTrace::of_runs("2 1 1 3"));
  loss.probability = loss.trace->probability();
  // Entries 1 1 0 1 0 0 0, periodic: ages 0 0 1 0 1 2 3, except for losses that reach back before step 0.
  const std::vector<std::uint64_t> counts = count_ages(loss, 1, 1, 2000, 700);
  ASSERT_EQ(counts.size(), 4u);
  const double all = 2000.0 * 700.0;
  for (std::size_t n = 0; n < 4; ++n)
    EXPECT_NEAR(static_cast<double>(counts[n]) / all, (n == 0 ? 3.0 : n == 1 ? 2.0 : 1.0) / 7.0, 0.003) << n;
  EXPECT_THROW(age_probabilities(loss), std::invalid_argument);
  LossModel by_distance = losses(0.1);
  by_distance.by_distance.emplace(std::vector<LossByDistance::Point>{{1.0, 0.1}});
  EXPECT_THROW(count_ages(by_distance, 1, 1, 1, 1), std::invalid_argument);
  EXPECT_THROW(mean_age(by_distance), std::invalid_argument);
}

TEST(InformationAge, IsExceededWithTheGivenProbabilityOnly) {
  for (const auto& [q, b] :
       {std::pair(0.5, 1e5), {0.1, 3.0}, {0.25, 1.0 / 0.75}, {0.001, 2.0}, {1e-7, 5.0}, {0.5, 1.0}}) {
    const LossModel loss = losses(q, b);
    for (const double rest : {1e-6, 1e-3}) {
      const double n = age_exceeded_with(loss, rest);
      const auto exceeded = [&](double age) { return q * std::pow(1.0 - 1.0 / b, age); };
      EXPECT_LE(exceeded(n), rest * (1.0 + 1e-9)) << q << " " << b;
      if (n > 0.0) {
        EXPECT_GT(exceeded(n - 1.0), rest) << q << " " << b;
      }
    }
  }
  EXPECT_EQ(age_exceeded_with(losses(0.5, 1e5), 1e-6), 1312230.0);
  EXPECT_EQ(age_exceeded_with(losses(0.1), 1e-6), 5.0) << "0.1 0.1^5 = 1e-6";
}

// A chain whose states lose always or never is that of bursts; one with more memory is compared with its own draws.
TEST(InformationAge, OfAChainOfStates) {
  LossModel loss;
  loss.markov =
      std::make_shared<MarkovLosses>((Eigen::Matrix2d() << 0.9, 0.1, 0.25, 0.75).finished(), Eigen::Vector2d(0.0, 1.0));
  loss.probability = loss.markov->loss_probability();
  const LossModel bursts{loss.probability, 4.0, {1.0}};
  EXPECT_NEAR(mean_age(loss), mean_age(bursts), 1e-14);
  EXPECT_EQ(age_exceeded_with(loss, 1e-6), age_exceeded_with(bursts, 1e-6));
  for (std::int64_t n = 0; n < 30; ++n)
    EXPECT_NEAR(expected_age_share(loss, n, 100), expected_age_share(bursts, n, 100), 1e-15) << n;

  loss.markov =
      std::make_shared<MarkovLosses>((Eigen::Matrix2d() << 0.9, 0.1, 0.3, 0.7).finished(), Eigen::Vector2d(0.02, 0.7));
  loss.probability = loss.markov->loss_probability();
  constexpr std::uint64_t kRealizations = 20000;
  constexpr std::int64_t kSteps = 50;
  const std::vector<std::uint64_t> counts = count_ages(loss, 11, 3, kRealizations, kSteps);
  for (std::int64_t n = 0; n < 8; ++n) {
    const double share = expected_age_share(loss, n, kSteps);
    // Steps of one realization are dependent: at most fully.
    const double error = std::sqrt(share * (1.0 - share) / static_cast<double>(kRealizations));
    const double measured = static_cast<double>(counts[static_cast<std::size_t>(n)]) /
                            static_cast<double>(kRealizations * static_cast<std::uint64_t>(kSteps));
    EXPECT_NEAR(measured, share, 4.0 * error) << n;
  }
}

}  // namespace
}  // namespace platoon
