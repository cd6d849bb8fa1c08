#include "stochastic_platoon/math/statistics/ensemble_statistics.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "unit/messages.hpp"

namespace platoon {
namespace {

constexpr std::size_t kFollowers = 2;
constexpr std::int64_t kSteps = 3;

ReducedSignals reduced(std::size_t follower, std::int64_t step, std::uint64_t first,
                       const std::vector<double>& errors) {
  const auto in_place = [&errors](std::size_t offset, std::size_t, double*) { return errors.data() + offset; };
  return {follower, step, first, errors.size(), {reduce_batch(first, errors.size(), in_place)}};
}

// Batches whose errors are known.
class EnsembleStatisticsTest : public testing::Test {
protected:
  void add_all(std::uint64_t first, std::size_t count) {
    for (std::size_t i = 1; i <= kFollowers; ++i) {
      for (std::int64_t k = 0; k < kSteps; ++k) {
        std::vector<double> errors;
        for (std::size_t r = 0; r < count; ++r) {
          errors.push_back(static_cast<double>(first + r) + 100.0 * static_cast<double>(cell(i, k, kSteps)));
        }
        statistics_.add(reduced(i, k, first, errors));
      }
    }
  }

  void expect_first(std::uint64_t count) const {
    EXPECT_EQ(statistics_.totals()->count(), count);
    const std::vector<Moments> totals = statistics_.totals()->moments.totals();
    ASSERT_EQ(totals.size(), 6u);
    for (std::size_t c = 0; c < totals.size() && count > 0; ++c) {
      EXPECT_DOUBLE_EQ(totals[c].mean, 100.0 * static_cast<double>(c) + 0.5 * static_cast<double>(count - 1));
    }
  }

  EnsembleStatistics statistics_{SignalCells{kFollowers, kSteps}};
};

TEST(Cell, IsOrderedByFollowerAndThenByStep) {
  EXPECT_EQ(cell(1, 0, 10), 0u);
  EXPECT_EQ(cell(1, 9, 10), 9u);
  EXPECT_EQ(cell(2, 0, 10), 10u);
  EXPECT_EQ(cell(20, 99, 100), 1999u);
}

TEST_F(EnsembleStatisticsTest, CountABatchOnlyOnceItIsCommitted) {
  add_all(0, 5);
  expect_first(0);
  statistics_.commit(0);
  expect_first(5);
}

TEST_F(EnsembleStatisticsTest, KeepBatchesOpenSideBySide) {
  statistics_.add(reduced(1, 0, 0, {0.0, 1.0}));
  add_all(2, 2);
  add_all(0, 2);
  statistics_.commit(2);
  EXPECT_EQ(statistics_.totals()->count(), 2u);
  statistics_.commit(0);
  expect_first(4);
}

TEST_F(EnsembleStatisticsTest, DropOpenBatchesInARestart) {
  add_all(0, 2);
  statistics_.commit(0);
  statistics_.add(reduced(1, 0, 2, {77.0, 78.0, 79.0}));
  statistics_.restart();
  EXPECT_THROW(statistics_.commit(2), std::invalid_argument);
  add_all(2, 4);
  statistics_.commit(2);
  expect_first(6);
}

TEST_F(EnsembleStatisticsTest, RejectABatchThatIsNotOpenOrCountedAlready) {
  EXPECT_THROW(statistics_.commit(0), std::invalid_argument);
  add_all(0, 2);
  statistics_.commit(0);
  EXPECT_EQ(message_of<std::invalid_argument>([this] { statistics_.commit(0); }),
            "batch at realization 0: must be open");
  add_all(1, 2);
  EXPECT_THROW(statistics_.commit(1), std::invalid_argument);
}

TEST_F(EnsembleStatisticsTest, ContinueAnEarlierRun) {
  add_all(0, 3);
  statistics_.commit(0);
  const EnsembleTotals earlier = *statistics_.totals();
  statistics_ = EnsembleStatistics(SignalCells{kFollowers, kSteps});
  statistics_.merge(earlier);
  add_all(3, 4);
  statistics_.commit(3);
  expect_first(7);
  EXPECT_THROW(statistics_.merge(earlier), std::invalid_argument);
}

TEST_F(EnsembleStatisticsTest, AreEmptyUntilABatchIsCommitted) {
  EXPECT_TRUE(statistics_.empty());
  add_all(0, 3);
  EXPECT_TRUE(statistics_.empty());
  statistics_.commit(0);
  EXPECT_FALSE(statistics_.empty());
  EXPECT_EQ(statistics_.realizations(), 3u);
  EXPECT_EQ(statistics_.last_step(1), kSteps - 1);
  EXPECT_EQ(statistics_.moments().size(), kFollowers * kSteps);
  EXPECT_EQ(statistics_.totals()->count(), 3u);
}

TEST_F(EnsembleStatisticsTest, RejectAFollowerBeyondTheLast) {
  EXPECT_THROW(statistics_.add(reduced(kFollowers + 1, 0, 0, {1.0})), std::out_of_range);
}

}  // namespace
}  // namespace platoon
