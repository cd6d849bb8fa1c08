#include "stochastic_platoon/math/statistics/ensemble_statistics.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace platoon {
namespace {

constexpr std::size_t kFollowers = 2;
constexpr std::int64_t kSteps = 3;

ReducedSignals reduced(std::size_t follower, std::int64_t step, std::uint64_t first,
                       const std::vector<double>& errors) {
  const auto in_place = [&errors](std::size_t offset, std::size_t, double*) { return errors.data() + offset; };
  return {follower, step, first, errors.size(), {reduce_batch(first, errors.size(), in_place)}};
}

void add_all(EnsembleStatistics& statistics, std::uint64_t first, std::size_t count) {
  for (std::size_t i = 1; i <= kFollowers; ++i) {
    for (std::int64_t k = 0; k < kSteps; ++k) {
      std::vector<double> errors;
      for (std::size_t r = 0; r < count; ++r) {
        errors.push_back(static_cast<double>(first + r) + 100.0 * static_cast<double>(cell(i, k, kSteps)));
      }
      statistics.add(reduced(i, k, first, errors));
    }
  }
}

void expect_first(const EnsembleStatistics& statistics, std::uint64_t count) {
  EXPECT_EQ(statistics.totals()->count(), count);
  const std::vector<Moments> totals = statistics.totals()->moments.totals();
  ASSERT_EQ(totals.size(), 6u);
  for (std::size_t c = 0; c < totals.size() && count > 0; ++c) {
    EXPECT_DOUBLE_EQ(totals[c].mean, 100.0 * static_cast<double>(c) + 0.5 * static_cast<double>(count - 1));
  }
}

TEST(EnsembleStatistics, CellsGoByFollowerAndThenByStep) {
  EXPECT_EQ(cell(1, 0, 10), 0u);
  EXPECT_EQ(cell(1, 9, 10), 9u);
  EXPECT_EQ(cell(2, 0, 10), 10u);
  EXPECT_EQ(cell(20, 99, 100), 1999u);
}

TEST(EnsembleStatistics, CountABatchOnlyWhenItIsCommitted) {
  EnsembleStatistics statistics(SignalCells{kFollowers, kSteps});
  add_all(statistics, 0, 5);
  expect_first(statistics, 0);
  statistics.commit(0);
  expect_first(statistics, 5);
}

TEST(EnsembleStatistics, KeepBatchesOpenSideBySide) {
  EnsembleStatistics statistics(SignalCells{kFollowers, kSteps});
  statistics.add(reduced(1, 0, 0, {0.0, 1.0}));
  add_all(statistics, 2, 2);
  add_all(statistics, 0, 2);
  statistics.commit(2);
  EXPECT_EQ(statistics.totals()->count(), 2u);
  statistics.commit(0);
  expect_first(statistics, 4);
}

TEST(EnsembleStatistics, ForgetWhatIsOpen) {
  EnsembleStatistics statistics(SignalCells{kFollowers, kSteps});
  add_all(statistics, 0, 2);
  statistics.commit(0);
  statistics.add(reduced(1, 0, 2, {77.0, 78.0, 79.0}));
  statistics.restart();
  EXPECT_THROW(statistics.commit(2), std::invalid_argument);
  add_all(statistics, 2, 4);
  statistics.commit(2);
  expect_first(statistics, 6);
}

TEST(EnsembleStatistics, RefuseToCommitWhatIsNotOpenOrCountedAlready) {
  EnsembleStatistics statistics(SignalCells{kFollowers, kSteps});
  EXPECT_THROW(statistics.commit(0), std::invalid_argument);
  add_all(statistics, 0, 2);
  statistics.commit(0);
  try {
    statistics.commit(0);
    ADD_FAILURE() << "committed twice";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "batch at realization 0: must be open");
  }
  add_all(statistics, 1, 2);
  EXPECT_THROW(statistics.commit(1), std::invalid_argument);
}

TEST(EnsembleStatistics, GoOnFromAnEarlierRun) {
  EnsembleStatistics earlier(SignalCells{kFollowers, kSteps}), statistics(SignalCells{kFollowers, kSteps});
  add_all(earlier, 0, 3);
  earlier.commit(0);
  statistics.merge(*earlier.totals());
  add_all(statistics, 3, 4);
  statistics.commit(3);
  expect_first(statistics, 7);
  EXPECT_THROW(statistics.merge(*earlier.totals()), std::invalid_argument);
}

TEST(EnsembleStatistics, AreEmptyUntilABatchIsCommitted) {
  EnsembleStatistics statistics(SignalCells{kFollowers, kSteps});
  EXPECT_TRUE(statistics.empty());
  add_all(statistics, 0, 3);
  EXPECT_TRUE(statistics.empty());
  statistics.commit(0);
  EXPECT_FALSE(statistics.empty());
  EXPECT_EQ(statistics.realizations(), 3u);
  EXPECT_EQ(statistics.last_step(1), kSteps - 1);
  EXPECT_EQ(statistics.moments().size(), kFollowers * kSteps);
  EXPECT_EQ(statistics.totals()->count(), 3u);
}

TEST(EnsembleStatistics, RefuseAFollowerThereIsNot) {
  EnsembleStatistics statistics(SignalCells{kFollowers, kSteps});
  EXPECT_THROW(statistics.add(reduced(kFollowers + 1, 0, 0, {1.0})), std::out_of_range);
}

}  // namespace
}  // namespace platoon
