#include "stochastic_platoon/math/simulation/ensemble_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "unit/agreement_of.hpp"
#include "unit/monte_carlo.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/same_bits.hpp"

namespace platoon {
namespace {

TEST(MonteCarlo, GivesTheSameBitsForEveryNumberOfThreadsAndBatchSize) {
  const PlatoonModel model = eventful_platoon(3.2);
  const auto totals = [&](unsigned threads, std::uint64_t batch) {
    const EnsembleTotals table = monte_carlo(model, {3, 3, 20, batch}, 1501, threads);
    EXPECT_EQ(table.count(), 1501u);
    return table.moments.totals();
  };
  const std::vector<Moments> expected = totals(1, 8192);
  ASSERT_EQ(expected.size(), 60u);
  for (const unsigned threads : {1u, 2u, 3u}) {
    for (const std::uint64_t batch : {1, 7, 8192}) {
      SCOPED_TRACE(std::to_string(threads) + " threads, batches of " + std::to_string(batch));
      expect_same_bits(totals(threads, batch), expected);
    }
  }
}

TEST(MonteCarlo, DependsOnTheSeed) {
  const PlatoonModel model = paper_platoon();
  EXPECT_NE(monte_carlo(model, {1, 1, 4, 10}, 10).moments.totals().back().mean,
            monte_carlo(model, {2, 1, 4, 10}, 10).moments.totals().back().mean);
}

// Means and variances of all (i, k) against theory, in units of the estimators' standard errors; the largest
// of so many scores exceeds the bound once in a thousand samples, and this sample is fixed.
TEST(MonteCarlo, AgreesWithTheory) {
  for (const double headway : {3.2, 2.4}) {
    const PlatoonModel model = eventful_platoon(headway);
    const EnsembleTotals table = monte_carlo(model, {1, 5, 40, 1000}, 8000, 2);
    const SignalMoments theory = error_moments(model, 5, 40);
    const Agreement found = agreement_of(table.moments.totals(), theory.mean, theory.variance);
    const double bound = largest_plausible_score(2 * theory.mean.size());
    EXPECT_LT(found.max_abs_z_mean, bound) << headway;
    EXPECT_LT(found.max_abs_z_variance, bound) << headway;
    EXPECT_GT(found.max_abs_z_mean, 1.0) << "too good to be true";
  }
}

TEST(MonteCarlo, DisagreesWithATheoryThatIsAFewPercentOff) {
  PlatoonModel model = eventful_platoon(3.2);
  const EnsembleTotals table = monte_carlo(model, {1, 5, 40, 1000}, 8000, 2);
  model.default_vehicle().position().noise_variance *= 1.08;
  const SignalMoments theory = error_moments(model, 5, 40);
  EXPECT_GT(agreement_of(table.moments.totals(), theory.mean, theory.variance).max_abs_z_variance,
            largest_plausible_score(2 * theory.mean.size()));
}

TEST(EnsembleRun, IsWatchedWhileItsThreadsComplete) {
  EnsembleRun run(paper_platoon(), {1, 2, 5, 7}, {0, 100});
  std::vector<std::uint64_t> seen;
  complete(run, 3, [&] { seen.push_back(run.done()); });
  ASSERT_FALSE(seen.empty());
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back(), 100u);
}

TEST(MonteCarlo, RunsInOneThreadIfNoneIsGiven) {
  EXPECT_EQ(monte_carlo(paper_platoon(), {1, 1, 2, 3}, 10, 0).count(), 10u);
}

constexpr std::uint64_t kRealizations = 1000;
const Ensemble kEnsemble{3, 2, 10, 32, {"gap", "jerk"}};
const SignalCells kCells = signal_cells(eventful_platoon(3.2), 2, 10, kEnsemble.signals);

void expect_same_totals(const EnsembleTotals& found, const EnsembleTotals& expected) {
  expect_same_bits(found.moments, expected.moments);
  expect_same_gaps(found.gaps, expected.gaps);
}

TEST(EnsembleRun, InAnyNumberOfShardsHasTheBitsOfOneRun) {
  const PlatoonModel model = eventful_platoon(3.2);
  const EnsembleTotals expected = monte_carlo(model, kEnsemble, kRealizations);
  for (const std::uint64_t of : {1, 2, 3, 5, 7, 16, 31, 64}) {
    EnsembleTotals joined(kCells);
    for (std::uint64_t at = 0; at < of; ++at) {
      EnsembleRun shard(model, kEnsemble, range_of({(at * 37 + 5) % of, of}, kRealizations));
      EXPECT_TRUE(shard.work());
      joined.merge(shard.release());
    }
    expect_same_totals(joined, expected);
  }
}

TEST(EnsembleRun, StartsNoBatchOnceItIsStopped) {
  EnsembleRun run(paper_platoon(), kEnsemble, {0, kRealizations});
  run.stop();
  EXPECT_FALSE(run.work());
  EXPECT_TRUE(run.all_begun());
  EXPECT_FALSE(run.is_complete());
}

TEST(EnsembleRun, ComputesMissingRealizationsOnly) {
  const PlatoonModel model = eventful_platoon(3.2);
  const RealizationRange range{100, 900};
  EnsembleRun whole(model, kEnsemble, range);
  complete(whole, 2, [] {});
  const EnsembleTotals expected = whole.release();
  EnsembleTotals earlier(kCells);
  for (const RealizationRange& there : {RealizationRange{100, 131}, RealizationRange{400, 401}}) {
    EnsembleRun part(model, kEnsemble, there);
    part.work();
    earlier.merge(part.release());
  }
  EnsembleRun rest(model, kEnsemble, range, earlier);
  EXPECT_EQ(rest.done(), 32u);
  EXPECT_FALSE(rest.is_complete());
  EXPECT_TRUE(rest.work());
  EXPECT_EQ(rest.done(), 800u);
  EXPECT_TRUE(rest.is_complete());
  expect_same_totals(rest.release(), expected);
}

TEST(EnsembleRun, IsCompleteIfEverythingIsGiven) {
  const PlatoonModel model = paper_platoon();
  EnsembleRun run(model, kEnsemble, {0, 64});
  run.work();
  EnsembleRun again(model, kEnsemble, {0, 64}, run.release());
  EXPECT_TRUE(again.all_begun());
  EXPECT_TRUE(again.is_complete());
  EXPECT_FALSE(again.work());
}

TEST(EnsembleRun, ShowsTotalsFromWhichARunCanContinue) {
  const PlatoonModel model = eventful_platoon(3.2);
  const EnsembleTotals expected = monte_carlo(model, kEnsemble, kRealizations);
  EnsembleRun run(model, kEnsemble, {0, kRealizations}, EnsembleTotals(kCells), 0.0);
  std::vector<EnsembleTotals> shown;
  std::thread worker([&run] { run.work(); });
  while (!run.is_complete()) run.read([&shown](const EnsembleTotals& table) { shown.push_back(table); });
  worker.join();
  run.read([&shown](const EnsembleTotals& table) { shown.push_back(table); });
  expect_same_totals(shown.back(), expected);
  for (std::size_t at = 0; at < shown.size(); at += std::max<std::size_t>(shown.size() / 5, 1)) {
    EnsembleRun rest(model, kEnsemble, {0, kRealizations}, shown[at]);
    rest.work();
    expect_same_totals(rest.release(), expected);
  }
}

TEST(EnsembleRun, IsCompletedByOneOfItsThreads) {
  const PlatoonModel model = paper_platoon();
  for (const double hand_over_seconds : {0.0, 1e9}) {
    EnsembleRun run(model, kEnsemble, {0, 1000}, EnsembleTotals(kCells), hand_over_seconds);
    std::atomic<int> completed{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) threads.emplace_back([&] { completed += run.work() ? 1 : 0; });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(completed, 1);
  }
}

TEST(EnsembleRun, LeavesItsBatchWhenItIsAbandoned) {
  const Ensemble minutes{3, 2, 200000, 65536, {}};
  EnsembleRun run(paper_platoon(), minutes, {0, minutes.batch});
  std::thread worker([&run] { run.work(); });
  while (!run.all_begun()) std::this_thread::yield();
  run.abandon();
  worker.join();
  EXPECT_EQ(run.done(), 0u);
  EXPECT_FALSE(run.is_complete());
}

TEST(EnsembleRun, IsAbandonedIfItsTickThrows) {
  const Ensemble minutes{3, 2, 200000, 65536, {}};
  EnsembleRun run(paper_platoon(), minutes, {0, minutes.batch});
  EXPECT_THROW(complete(run, 2, [] { throw Interrupted(); }), Interrupted);
  EXPECT_EQ(run.done(), 0u);
  EXPECT_FALSE(run.is_complete());
}

}  // namespace
}  // namespace platoon
