#include "stochastic_platoon/simulation/platoon_string.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "../paper_platoon.hpp"
#include "stochastic_platoon/statistics/agreement.hpp"
#include "stochastic_platoon/theory/error_moments.hpp"

namespace platoon {
namespace {

// Everything that can be there is: standstill distance, random initial positions, changes of speed.
PlatoonModel eventful_platoon(double headway) {
  PlatoonModel model = paper_platoon(headway);
  model.standstill_distance = 7.0;
  model.initial_position = {0.8, 0.3};
  model.leader = LeaderProfile({{0, 20.0}, {10, 5.0}, {20, 12.0}}, 0.1);
  return model;
}

using Errors = std::map<std::pair<std::size_t, std::int64_t>, std::vector<double>>;

Errors errors_of(PlatoonString& string, std::uint64_t first, std::size_t count, std::int64_t steps) {
  Errors all;
  string.run(first, count, steps, [&all](std::size_t i, std::int64_t k, const std::vector<double>& errors) {
    EXPECT_TRUE(all.emplace(std::make_pair(i, k), errors).second) << "told twice: " << i << ", " << k;
  });
  return all;
}

const auto kNoProgress = [](std::uint64_t) {};

TEST(PlatoonString, ErrorsAreThoseOfTheEquationsWrittenOut) {
  constexpr std::uint64_t kRealization = 12345;
  constexpr std::uint32_t kFollowers = 4;
  constexpr std::int64_t kSteps = 30;
  const PlatoonModel model = eventful_platoon(3.2);
  const StateSpace& loop = model.loop.realization;
  const auto g = [&](std::uint32_t i, std::int64_t k) {
    double value;
    WhiteNoise(8).fill({i, k}, kRealization, 1, &value);
    return value;
  };
  const Eigen::VectorXd equilibrium = unit_equilibrium(loop);
  std::vector<Eigen::VectorXd> x = {0.0 * equilibrium};
  for (std::uint32_t i = 1; i <= kFollowers; ++i)
    x.push_back(equilibrium * (-7.0 * i + 0.8 + std::sqrt(0.3) * g(i, -1)));
  PlatoonString string(model, 8, kFollowers);
  const Errors found = errors_of(string, kRealization, 1, kSteps);
  ASSERT_EQ(found.size(), static_cast<std::size_t>(kFollowers * kSteps));
  for (std::int64_t k = 0; k < kSteps; ++k) {
    const std::vector<Eigen::VectorXd> before = x;
    x[0] = loop.a() * before[0] + loop.b() * model.leader.position(k - 1);
    for (std::uint32_t i = 1; i <= kFollowers; ++i) {
      const double d = k == 0 ? 0.0 : std::sqrt(0.6) * g(i, k - 1);
      const double y = loop.c() * before[i - 1];
      x[i] = loop.a() * before[i] + loop.b() * (y + d - 7.0);
    }
    for (std::uint32_t i = 1; i <= kFollowers; ++i) {
      const double y = loop.c() * x[i], y_before = loop.c() * before[i], predecessor = loop.c() * x[i - 1];
      EXPECT_NEAR(found.at({i, k})[0], predecessor - y - 7.0 - 3.2 * (y - y_before), 1e-12) << i << ", " << k;
    }
  }
}

TEST(PlatoonString, StaysInFormationWhenNothingDisturbsIt) {
  PlatoonModel model = paper_platoon();
  model.noise_variance = 0.0;
  model.standstill_distance = 7.0;
  model.leader = LeaderProfile({}, 0.1);
  PlatoonString string(model, 1, 6);
  for (const auto& entry : errors_of(string, 0, 3, 50)) {
    for (const double error : entry.second) EXPECT_NEAR(error, 0.0, 1e-12);
  }
}

TEST(PlatoonString, GivesTheSameBitsInEveryBatch) {
  PlatoonString string(eventful_platoon(3.2), 1, 3);
  const Errors whole = errors_of(string, 0, 40, 20);
  for (const std::size_t batch : {1, 7, 33}) {
    for (std::size_t first = 0; first < 40; first += batch) {
      for (const auto& part : errors_of(string, first, std::min(batch, 40 - first), 20)) {
        ASSERT_EQ(std::memcmp(part.second.data(), whole.at(part.first).data() + first,
                              part.second.size() * sizeof(double)),
                  0);
      }
    }
  }
}

TEST(MonteCarlo, GivesTheSameBitsForEveryNumberOfThreadsAndBatchSize) {
  const PlatoonModel model = eventful_platoon(3.2);
  const auto totals = [&](unsigned threads, std::uint64_t batch) {
    const MomentTable table = monte_carlo(model, {3, 3, 20, 1501, batch}, threads, kNoProgress);
    EXPECT_EQ(table.count(), 1501u);
    return table.totals();
  };
  const std::vector<Moments> expected = totals(1, 8192);
  ASSERT_EQ(expected.size(), 60u);
  for (const unsigned threads : {1u, 2u, 3u}) {
    for (const std::uint64_t batch : {1, 7, 8192}) {
      const std::vector<Moments> found = totals(threads, batch);
      for (std::size_t c = 0; c < found.size(); ++c) {
        ASSERT_EQ(found[c].mean, expected[c].mean)
            << threads << " threads, batches of " << batch << ", cell " << c;
        ASSERT_EQ(found[c].squared_deviations, expected[c].squared_deviations);
      }
    }
  }
}

TEST(MonteCarlo, OfOtherSeedsIsAnotherSample) {
  const PlatoonModel model = paper_platoon();
  EXPECT_NE(monte_carlo(model, {1, 1, 4, 10, 10}, 1, kNoProgress).totals().back().mean,
            monte_carlo(model, {2, 1, 4, 10, 10}, 1, kNoProgress).totals().back().mean);
}

// Means and variances of all (i, k) against theory, in units of the estimators' standard errors; the largest
// of so many scores exceeds the bound once in a thousand samples, and this sample is fixed.
TEST(MonteCarlo, AgreesWithTheory) {
  for (const double headway : {3.2, 2.4}) {
    const PlatoonModel model = eventful_platoon(headway);
    const MomentTable table = monte_carlo(model, {1, 5, 40, 8000, 1000}, 2, kNoProgress);
    const ErrorMoments theory = error_moments(model, 5, 40);
    const Agreement found = agreement(table.totals(), theory.mean, theory.variance);
    const double bound = largest_plausible_score(2 * theory.mean.size());
    EXPECT_LT(found.max_abs_z_mean, bound) << headway;
    EXPECT_LT(found.max_abs_z_variance, bound) << headway;
    EXPECT_GT(found.max_abs_z_mean, 1.0) << "too good to be true";
  }
}

TEST(MonteCarlo, NoticesATheoryThatIsAFewPercentOff) {
  PlatoonModel model = eventful_platoon(3.2);
  const MomentTable table = monte_carlo(model, {1, 5, 40, 8000, 1000}, 2, kNoProgress);
  model.noise_variance *= 1.08;
  const ErrorMoments theory = error_moments(model, 5, 40);
  EXPECT_GT(agreement(table.totals(), theory.mean, theory.variance).max_abs_z_variance,
            largest_plausible_score(2 * theory.mean.size()));
}

TEST(MonteCarlo, TellsItsProgressUpToTheEnd) {
  std::vector<std::uint64_t> told;
  monte_carlo(paper_platoon(), {1, 2, 5, 100, 7}, 3, [&told](std::uint64_t done) { told.push_back(done); });
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 100u);
}

TEST(MonteCarlo, TakesNoThreadsForOne) {
  EXPECT_EQ(monte_carlo(paper_platoon(), {1, 1, 2, 10, 3}, 0, kNoProgress).count(), 10u);
}

}  // namespace
}  // namespace platoon
