#include "stochastic_platoon/math/statistics/moment_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "unit/math/statistics/sample_batches.hpp"
#include "unit/math/statistics/two_pass_moments.hpp"
#include "unit/messages.hpp"
#include "unit/same_bits.hpp"

namespace platoon {
namespace {

constexpr std::uint64_t kRealizations = 20011;

TEST(MomentTable, HasTheSameBitsForEveryBatchSize) {
  const MomentTable expected = sample_table(0, kRealizations, 8192);
  for (const std::uint64_t size : {1, 2, 7, 512, 1000, 20011}) {
    SCOPED_TRACE(size);
    expect_same_bits(sample_table(0, kRealizations, size), expected);
  }
}

TEST(MomentTable, HasTheSameBitsForTwoHalvesInEitherOrder) {
  const MomentTable expected = sample_table(0, kRealizations, 8192);
  for (const std::uint64_t cut : {1, 8191, 8192, 10000, 20010}) {
    const MomentTable lower = sample_table(0, cut, 7), upper = sample_table(cut, kRealizations, 1000);
    MomentTable ascending(kCells), descending(kCells);
    ascending.merge(lower);
    ascending.merge(upper);
    descending.merge(upper);
    descending.merge(lower);
    expect_same_bits(ascending, expected);
    expect_same_bits(descending, expected);
  }
}

TEST(MomentTable, HasTheSameBitsForRandomPartitionsInRandomOrder) {
  std::mt19937 generator(1);
  for (const KeptMoments kept : {KeptMoments::two, KeptMoments::four}) {
    const MomentTable expected = sample_table(0, 3000, 8192, kept);
    for (int trial = 0; trial < 40; ++trial) {
      std::vector<BatchMoments> parts;
      for (std::uint64_t first = 0; first < 3000;) {
        const std::uint64_t count = std::min<std::uint64_t>(1 + generator() % (trial < 20 ? 20 : 900), 3000 - first);
        parts.push_back(sample_batch(first, count, kept));
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
}

TEST(MomentTable, HasTheSameBitsForASetWithHoles) {
  MomentTable ascending(kCells), descending(kCells);
  const std::vector<std::uint64_t> firsts = {3, 64, 1000, 40000, std::uint64_t{1} << 40};
  for (auto first = firsts.begin(); first != firsts.end(); ++first) ascending.add(sample_batch(*first, 17));
  for (auto first = firsts.rbegin(); first != firsts.rend(); ++first) {
    descending.add(sample_batch(*first + 5, 12));
    descending.add(sample_batch(*first, 5));
  }
  expect_same_bits(descending, ascending);
}

// The error of a pairwise mean of n values is at most log2(n) roundings.
TEST(MomentTable, HasTheTotalsOfTwoPasses) {
  for (const std::uint64_t count : {1, 2, 3, 511, 512, 513, 8192, 20011}) {
    const std::vector<Moments> two = sample_table(0, count, 8192).totals(),
                               four = sample_table(0, count, count, KeptMoments::four).totals();
    for (std::size_t c = 0; c < kCells; ++c) {
      const Moments expected = two_pass_moments(sample_values(c, 0, count));
      EXPECT_EQ(two[c].count, count);
      EXPECT_NEAR(two[c].mean, expected.mean, 20 * 1.2e-16 * (1.0 + 100.0 * static_cast<double>(c)));
      EXPECT_NEAR(two[c].squared_deviations, expected.squared_deviations, 1e-12 * expected.squared_deviations + 1e-20);
      EXPECT_TRUE(same_bits(four[c].mean, two[c].mean));
      EXPECT_TRUE(same_bits(four[c].squared_deviations, two[c].squared_deviations));
      const double fourth = expected.fourth_deviations;
      const double sizes = std::pow(static_cast<double>(count) * fourth * fourth * fourth, 0.25);  // sum |d|^3 at most
      EXPECT_NEAR(four[c].cubed_deviations, expected.cubed_deviations, 1e-12 * sizes);
      EXPECT_NEAR(four[c].fourth_deviations, fourth, 1e-12 * fourth);
    }
  }
}

TEST(MomentTable, KeepsAtMostLogTwoPlusOneBlocks) {
  MomentTable growing(kCells);
  for (std::uint64_t count = 1; count <= 2000; ++count) {
    growing.add(sample_batch(count - 1, 1));
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
  const MomentTable expected = sample_table(100, 200, 7);
  MomentTable counted = sample_table(100, 200, 7);
  const std::vector<DyadicRange> taken = {{100, 0}, {128, 5}, {144, 4}, {128, 6}, {64, 6}, {0, 10}, {199, 0}};
  for (const DyadicRange& range : taken) {
    EXPECT_THROW(counted.add(MomentBlock{range, std::vector<double>(kCells), std::vector<double>(kCells)}),
                 std::invalid_argument)
        << range.first << " level " << range.level;
  }
  EXPECT_THROW(counted.add(sample_batch(100, 100)), std::invalid_argument);
  EXPECT_THROW(counted.merge(sample_table(120, 121, 1)), std::invalid_argument);
  expect_same_bits(counted, expected);
  EXPECT_NO_THROW(counted.add(sample_batch(99, 1)));
  EXPECT_NO_THROW(counted.add(sample_batch(200, 1)));
}

TEST(MomentTable, NamesRealizationsThatAreAddedTwice) {
  MomentTable counted = sample_table(0, 10, 10);
  EXPECT_EQ(message_of<std::invalid_argument>([&counted] { counted.add(sample_batch(8, 2)); }),
            "realizations from 8 to 9: must not be counted twice");
}

// A damaged file may contain any range.
TEST(MomentTable, RejectsARangeThatIsNotDyadic) {
  MomentTable table(1);
  const std::vector<double> one{1.0};
  for (const DyadicRange range : {DyadicRange{1, 1}, {0, 63}, {0, 64}, {std::uint64_t{1} << 63, 0}, {6, 2}})
    EXPECT_THROW(table.add({range, one, one}), std::invalid_argument) << range.first << " " << range.level;
  EXPECT_EQ(table.count(), 0u);
}

TEST(MomentTable, RejectsBlocksWithOtherCells) {
  MomentTable other(kCells + 1);
  EXPECT_THROW(other.add(sample_batch(0, 4)), std::invalid_argument);
  EXPECT_EQ(other.count(), 0u);
  EXPECT_THROW(other.add(MomentBlock{{0, 0}, std::vector<double>(kCells + 1), std::vector<double>(kCells)}),
               std::invalid_argument);
}

TEST(MomentTable, RejectsAMixtureOfTwoAndFourMoments) {
  MomentTable table(kCells);
  table.add(sample_batch(0, 4, KeptMoments::four));
  EXPECT_THROW(table.add(sample_batch(4, 4)), std::invalid_argument);
}

std::string shown(const std::vector<RealizationRange>& ranges) {
  std::string text;
  for (const RealizationRange& range : ranges)
    text += std::to_string(range.first) + "-" + std::to_string(range.end) + " ";
  return text;
}

TEST(MomentTable, HasTheMissingRealizationsOfARange) {
  MomentTable table(kCells);
  EXPECT_EQ(shown(table.missing({3, 9})), "3-9 ");
  EXPECT_EQ(shown(table.missing({3, 3})), "");
  table.add(sample_batch(4, 3));
  table.add(sample_batch(10, 6));
  EXPECT_EQ(shown(table.missing({0, 20})), "0-4 7-10 16-20 ");
  EXPECT_EQ(shown(table.missing({5, 12})), "7-10 ");
  EXPECT_EQ(shown(table.missing({4, 7})), "");
  EXPECT_EQ(shown(table.missing({12, 16})), "");
  EXPECT_EQ(shown(table.missing({7, 9})), "7-9 ");
  EXPECT_EQ(shown(table.missing({16, 18})), "16-18 ");
}

}  // namespace
}  // namespace platoon
