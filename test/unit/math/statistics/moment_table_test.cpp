#include "stochastic_platoon/math/statistics/moment_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <stdexcept>

#include "stochastic_platoon/math/noise/white_noise.hpp"

namespace platoon {
namespace {

constexpr std::size_t kCells = 3;

// Values of realizations first .. first + count - 1 in a cell: a mean that is large compared with the deviation.
std::vector<double> values(std::size_t cell, std::uint64_t first, std::size_t count) {
  std::vector<double> x(count);
  WhiteNoise(1).fill({static_cast<std::uint32_t>(cell), 0}, first, count, x.data());
  for (double& value : x) value = 100.0 * static_cast<double>(cell) + 0.7 * value;
  return x;
}

BatchMoments batch(std::uint64_t first, std::size_t count) {
  BatchMoments moments(first, count, kCells);
  for (std::size_t c = 0; c < kCells; ++c) moments.set(c, values(c, first, count).data());
  return moments;
}

// Realizations first .. end - 1 in batches of this size.
MomentTable table(std::uint64_t first, std::uint64_t end, std::uint64_t size) {
  MomentTable result(kCells);
  for (; first < end; first += size) result.add(batch(first, std::min(size, end - first)));
  return result;
}

bool same_bits(double left, double right) {
  return std::memcmp(&left, &right, sizeof left) == 0;
}

void expect_same_bits(const MomentTable& found, const MomentTable& expected) {
  ASSERT_EQ(found.count(), expected.count());
  ASSERT_EQ(found.blocks().size(), expected.blocks().size());
  auto other = expected.blocks().begin();
  for (const auto& entry : found.blocks()) {
    EXPECT_EQ(entry.second.range.first, other->second.range.first);
    EXPECT_EQ(entry.second.range.level, other->second.range.level);
    for (std::size_t c = 0; c < kCells; ++c) {
      EXPECT_TRUE(same_bits(entry.second.mean[c], other->second.mean[c]));
      EXPECT_TRUE(same_bits(entry.second.squared_deviations[c], other->second.squared_deviations[c]));
    }
    ++other;
  }
  const std::vector<Moments> totals = found.totals(), expected_totals = expected.totals();
  for (std::size_t c = 0; c < kCells; ++c) {
    EXPECT_EQ(totals[c].count, expected_totals[c].count);
    EXPECT_TRUE(same_bits(totals[c].mean, expected_totals[c].mean));
    EXPECT_TRUE(same_bits(totals[c].squared_deviations, expected_totals[c].squared_deviations));
  }
}

constexpr std::uint64_t kRealizations = 20011;

TEST(MomentTable, GivesTheSameBitsForEveryBatchSize) {
  const MomentTable expected = table(0, kRealizations, 8192);
  for (const std::uint64_t size : {1, 2, 7, 512, 1000, 20011}) {
    SCOPED_TRACE(size);
    expect_same_bits(table(0, kRealizations, size), expected);
  }
}

TEST(MomentTable, GivesTheSameBitsForTwoHalvesInEitherOrder) {
  const MomentTable expected = table(0, kRealizations, 8192);
  for (const std::uint64_t cut : {1, 8191, 8192, 10000, 20010}) {
    const MomentTable lower = table(0, cut, 7), upper = table(cut, kRealizations, 1000);
    MomentTable ascending(kCells), descending(kCells);
    ascending.merge(lower);
    ascending.merge(upper);
    descending.merge(upper);
    descending.merge(lower);
    expect_same_bits(ascending, expected);
    expect_same_bits(descending, expected);
  }
}

TEST(MomentTable, GivesTheSameBitsForRandomPartitionsInRandomOrder) {
  std::mt19937 generator(1);
  const MomentTable expected = table(0, 3000, 8192);
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<BatchMoments> parts;
    for (std::uint64_t first = 0; first < 3000;) {
      const std::uint64_t count = std::min<std::uint64_t>(1 + generator() % (trial < 20 ? 20 : 900), 3000 - first);
      parts.push_back(batch(first, count));
      first += count;
    }
    std::shuffle(parts.begin(), parts.end(), generator);
    std::vector<MomentTable> workers(3, MomentTable(kCells));
    for (const BatchMoments& part : parts) workers[generator() % 3].add(part);
    MomentTable merged(kCells);
    for (const MomentTable& worker : workers) merged.merge(worker);
    expect_same_bits(merged, expected);
  }
}

TEST(MomentTable, GivesTheSameBitsForASetWithHoles) {
  MomentTable ascending(kCells), descending(kCells);
  const std::vector<std::uint64_t> firsts = {3, 64, 1000, 40000, std::uint64_t{1} << 40};
  for (auto first = firsts.begin(); first != firsts.end(); ++first) ascending.add(batch(*first, 17));
  for (auto first = firsts.rbegin(); first != firsts.rend(); ++first) {
    descending.add(batch(*first + 5, 12));
    descending.add(batch(*first, 5));
  }
  expect_same_bits(descending, ascending);
}

// Reference: two passes in extended precision. The error of a pairwise mean of n values is at most log2(n) roundings.
TEST(MomentTable, TotalsAreThoseOfTwoPasses) {
  for (const std::uint64_t count : {1, 2, 3, 511, 512, 513, 8192, 20011}) {
    const std::vector<Moments> totals = table(0, count, 8192).totals();
    for (std::size_t c = 0; c < kCells; ++c) {
      const std::vector<double> x = values(c, 0, count);
      long double sum = 0.0L, squares = 0.0L;
      for (const double value : x) sum += value;
      const long double mean = sum / static_cast<long double>(count);
      for (const double value : x) squares += (value - mean) * (value - mean);
      EXPECT_EQ(totals[c].count, count);
      EXPECT_NEAR(totals[c].mean, static_cast<double>(mean), 20 * 1.2e-16 * (1.0 + 100.0 * static_cast<double>(c)));
      EXPECT_NEAR(totals[c].squared_deviations, static_cast<double>(squares),
                  1e-12 * static_cast<double>(squares) + 1e-20);
    }
  }
}

TEST(MomentTable, KeepsAtMostLogTwoPlusOneBlocks) {
  MomentTable growing(kCells);
  for (std::uint64_t count = 1; count <= 2000; ++count) {
    growing.add(batch(count - 1, 1));
    ASSERT_LE(static_cast<double>(growing.blocks().size()), std::log2(static_cast<double>(count)) + 1.0);
  }
}

TEST(MomentTable, IsEmptyAtFirst) {
  const MomentTable empty(kCells);
  EXPECT_EQ(empty.count(), 0u);
  EXPECT_EQ(empty.cells(), kCells);
  ASSERT_EQ(empty.totals().size(), kCells);
  EXPECT_EQ(empty.totals()[0].count, 0u);
  EXPECT_TRUE(std::isnan(empty.totals()[0].variance()));
}

TEST(MomentTable, CountsNoRealizationTwice) {
  const MomentTable expected = table(100, 200, 7);
  MomentTable counted = table(100, 200, 7);
  const std::vector<DyadicRange> taken = {{100, 0}, {128, 5}, {144, 4}, {128, 6}, {64, 6}, {0, 10}, {199, 0}};
  for (const DyadicRange& range : taken) {
    EXPECT_THROW(counted.add(MomentBlock{range, std::vector<double>(kCells), std::vector<double>(kCells)}),
                 std::invalid_argument)
        << range.first << " level " << range.level;
  }
  EXPECT_THROW(counted.add(batch(100, 100)), std::invalid_argument);
  EXPECT_THROW(counted.merge(table(120, 121, 1)), std::invalid_argument);
  expect_same_bits(counted, expected);
  EXPECT_NO_THROW(counted.add(batch(99, 1)));
  EXPECT_NO_THROW(counted.add(batch(200, 1)));
}

TEST(MomentTable, NamesTheRealizationsThatAreThereAlready) {
  MomentTable counted = table(0, 10, 10);
  try {
    counted.add(batch(8, 2));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "realizations from 8 to 9: must not be counted twice");
  }
}

// A damaged file may contain any range.
TEST(MomentTable, RefusesRangesThatAreNoNodeOfTheTree) {
  MomentTable table(1);
  const std::vector<double> one{1.0};
  for (const DyadicRange range : {DyadicRange{1, 1}, {0, 63}, {0, 64}, {std::uint64_t{1} << 63, 0}, {6, 2}})
    EXPECT_THROW(table.add({range, one, one}), std::invalid_argument) << range.first << " " << range.level;
  EXPECT_EQ(table.count(), 0u);
}

TEST(MomentTable, RefusesBlocksOfOtherCells) {
  MomentTable other(kCells + 1);
  EXPECT_THROW(other.add(batch(0, 4)), std::invalid_argument);
  EXPECT_EQ(other.count(), 0u);
  EXPECT_THROW(other.add(MomentBlock{{0, 0}, std::vector<double>(kCells + 1), std::vector<double>(kCells)}),
               std::invalid_argument);
}

TEST(BatchMoments, KeepsTheBlocksOfItsRealizations) {
  const BatchMoments moments = batch(3, 10);
  ASSERT_EQ(moments.blocks().size(), 4u);  // 3, 4 .. 7, 8 .. 11, 12
  EXPECT_EQ(moments.blocks()[1].range.first, 4u);
  EXPECT_EQ(moments.blocks()[1].range.level, 2u);
  const std::vector<double> x = values(2, 3, 10);
  EXPECT_EQ(moments.blocks()[0].mean[2], x[0]);
  EXPECT_EQ(moments.blocks()[0].squared_deviations[2], 0.0);
  EXPECT_EQ(moments.blocks()[3].mean[2], x[9]);
}

TEST(BatchMoments, FourCellsAtOnceHaveTheBitsOfEachAlone) {
  for (const std::size_t count : {1, 2, 3, 5, 8, 100, 511, 512, 1500}) {
    for (const std::uint64_t first : {0, 5, 512}) {
      BatchMoments together(first, count, kCellsAtOnce), alone(first, count, kCellsAtOnce);
      std::vector<std::vector<double>> of_cell;
      std::vector<CellValues> cells;
      for (std::size_t c = 0; c < kCellsAtOnce; ++c) of_cell.push_back(values(c, first, count));
      for (std::size_t c = 0; c < kCellsAtOnce; ++c) cells.push_back({(c + 1) % kCellsAtOnce, of_cell[c].data()});
      together.set(cells);
      for (const CellValues& of : cells) alone.set(of.cell, of.values);
      for (std::size_t b = 0; b < alone.blocks().size(); ++b) {
        for (std::size_t c = 0; c < kCellsAtOnce; ++c) {
          EXPECT_TRUE(same_bits(together.blocks()[b].mean[c], alone.blocks()[b].mean[c])) << count;
          EXPECT_TRUE(same_bits(together.blocks()[b].squared_deviations[c], alone.blocks()[b].squared_deviations[c]));
        }
      }
    }
  }
}

TEST(BatchMoments, RefusesACellThereIsNot) {
  BatchMoments moments(0, 2, kCells);
  const std::vector<double> x = {1.0, 2.0};
  EXPECT_NO_THROW(moments.set(kCells - 1, x.data()));
  EXPECT_THROW(moments.set(kCells, x.data()), std::out_of_range);
}

BatchMoments batch_of_four(std::uint64_t first, std::size_t count) {
  BatchMoments batch(first, count, kCells, KeptMoments::four);
  for (std::size_t c = 0; c < kCells; ++c) batch.set(c, values(c, first, count).data());
  return batch;
}

TEST(MomentTable, KeepsFourMomentsWithTheSameBitsForRandomPartitionsInRandomOrder) {
  std::mt19937 generator(2);
  MomentTable expected(kCells);
  expected.add(batch_of_four(0, 3000));
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<BatchMoments> parts;
    for (std::uint64_t first = 0; first < 3000;) {
      const std::uint64_t count = std::min<std::uint64_t>(1 + generator() % 900, 3000 - first);
      parts.push_back(batch_of_four(first, count));
      first += count;
    }
    std::shuffle(parts.begin(), parts.end(), generator);
    MomentTable found(kCells);
    for (const BatchMoments& part : parts) found.add(part);
    const std::vector<Moments> some = found.totals(), all = expected.totals();
    for (std::size_t c = 0; c < kCells; ++c) {
      EXPECT_EQ(some[c].cubed_deviations, all[c].cubed_deviations);
      EXPECT_EQ(some[c].fourth_deviations, all[c].fourth_deviations);
    }
    expect_same_bits(found, expected);
  }
}

TEST(MomentTable, OfFourMomentsHasThoseOfTwoPassesAndTheBitsOfTwo) {
  for (const std::uint64_t count : {1, 2, 3, 511, 512, 513, 8192, 20011}) {
    MomentTable four(kCells), two(kCells);
    four.add(batch_of_four(0, count));
    two.add(batch(0, count));
    expect_same_bits(four, two);
    const std::vector<Moments> totals = four.totals();
    for (std::size_t c = 0; c < kCells; ++c) {
      const std::vector<double> x = values(c, 0, count);
      long double sum = 0.0L, cubed = 0.0L, fourth = 0.0L, size = 0.0L;
      for (const double value : x) sum += value;
      for (const double value : x) {
        const long double d = value - sum / static_cast<long double>(count);
        cubed += d * d * d;
        size += std::abs(d * d * d);
        fourth += d * d * d * d;
      }
      EXPECT_NEAR(totals[c].cubed_deviations, static_cast<double>(cubed), 1e-12 * static_cast<double>(size));
      EXPECT_NEAR(totals[c].fourth_deviations, static_cast<double>(fourth), 1e-12 * static_cast<double>(fourth));
    }
  }
}

TEST(MomentTable, RefusesToMixWhatKeepsTwoAndFourMoments) {
  MomentTable table(kCells);
  table.add(batch_of_four(0, 4));
  EXPECT_THROW(table.add(batch(4, 4)), std::invalid_argument);
}

std::string shown(const std::vector<RealizationRange>& ranges) {
  std::string text;
  for (const RealizationRange& range : ranges)
    text += std::to_string(range.first) + "-" + std::to_string(range.end) + " ";
  return text;
}

TEST(MomentTable, SaysWhatIsMissingOfARange) {
  MomentTable table(kCells);
  EXPECT_EQ(shown(table.missing({3, 9})), "3-9 ");
  EXPECT_EQ(shown(table.missing({3, 3})), "");
  table.add(batch(4, 3));
  table.add(batch(10, 6));
  EXPECT_EQ(shown(table.missing({0, 20})), "0-4 7-10 16-20 ");
  EXPECT_EQ(shown(table.missing({5, 12})), "7-10 ");
  EXPECT_EQ(shown(table.missing({4, 7})), "");
  EXPECT_EQ(shown(table.missing({12, 16})), "");
  EXPECT_EQ(shown(table.missing({7, 9})), "7-9 ");
  EXPECT_EQ(shown(table.missing({16, 18})), "16-18 ");
}

}  // namespace
}  // namespace platoon
