#include "stochastic_platoon/math/statistics/smallest_gaps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <vector>

#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

const GapCounting kCounting{1, 0.5, 1.0};

BatchGaps batch(std::uint64_t first, const std::vector<double>& gaps, std::int64_t step = 3) {
  BatchGaps result(first, gaps.size(), 1);
  result.add(1, step, gaps.data());
  return result;
}

TEST(BatchGaps, KeepTheSmallestAndTheEarliestOfEqualOnesInAnyOrder) {
  BatchGaps gaps(0, 3, 1);
  const std::vector<double> at_7{2.0, -1.0, 4.0}, at_5{2.0, 0.0, 5.0}, at_9{1.0, -1.0, 4.0};
  gaps.add(1, 7, at_7.data());
  gaps.add(1, 5, at_5.data());
  gaps.add(1, 9, at_9.data());
  EXPECT_TRUE(gaps.smallest(1) == (AlignedValues{1.0, -1.0, 4.0}));
  EXPECT_EQ(gaps.first(1).gap, -1.0);
  EXPECT_EQ(gaps.first(1).realization, 1u);
  EXPECT_EQ(gaps.first(1).step, 7);
}

TEST(BatchGaps, LoweredByTheCallerEqualAddedOnes) {
  const std::vector<std::vector<double>> steps{{3.0, 2.0, 4.0}, {5.0, 2.0, 2.0}, {2.0, 9.0, 9.0}, {1.0, 0.5, 0.5}};
  BatchGaps added(7, 3, 1), lowered(7, 3, 1);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    added.add(1, static_cast<std::int64_t>(k), steps[k].data());
    const double least = keep_smaller(steps[k].data(), 3, lowered.lowered(1));
    EXPECT_EQ(least, *std::min_element(steps[k].begin(), steps[k].end()));
    lowered.lowered_to(1, static_cast<std::int64_t>(k), least);
    EXPECT_TRUE(lowered.smallest(1) == added.smallest(1));
    EXPECT_EQ(lowered.first(1).gap, added.first(1).gap);
    EXPECT_EQ(lowered.first(1).realization, added.first(1).realization);
    EXPECT_EQ(lowered.first(1).step, added.first(1).step) << "after step " << k;
  }
}

TEST(BatchGaps, LoweredByTheCallerAreFoundAnywhere) {
  for (const std::size_t count : {1, 63, 64, 65, 200}) {
    for (const std::size_t place : {std::size_t{0}, count / 2, count - 1}) {
      std::vector<double> gaps(count, 3.0);
      gaps[place] = 1.0;
      BatchGaps lowered(100, count, 1);
      lowered.lowered_to(1, 4, keep_smaller(gaps.data(), count, lowered.lowered(1)));
      EXPECT_EQ(lowered.first(1).realization, 100 + place);
      EXPECT_EQ(lowered.first(1).gap, 1.0);
    }
  }
}

TEST(GapTable, CountsCollisionsUnsafeGapsAndBins) {
  GapTable table(kCounting);
  table.add(batch(10, {-0.2, 0.2, 0.999, 1.0, -0.2}));
  const FollowerGaps& of = table.followers().front();
  EXPECT_EQ(of.smallest.gap, -0.2);
  EXPECT_EQ(of.smallest.realization, 10u);
  EXPECT_EQ(of.smallest.step, 3);
  EXPECT_EQ(of.collisions, 2u);
  EXPECT_EQ(of.unsafe, 4u);
  EXPECT_EQ(of.histogram, (std::map<std::int64_t, std::uint64_t>{{-1, 2}, {0, 1}, {1, 1}, {2, 1}}));
}

TEST(GapTable, IsTheSameForAnyOrderOfTheBatches) {
  const std::vector<BatchGaps> batches{batch(0, {1.0, 0.3, 0.7}, 6), batch(3, {0.3, 2.0}, 2), batch(5, {0.3}, 1)};
  GapTable forward(kCounting), backward(kCounting), merged(kCounting);
  for (std::size_t b = 0; b < batches.size(); ++b) {
    forward.add(batches[b]);
    backward.add(batches[batches.size() - 1 - b]);
    GapTable part(kCounting);
    part.add(batches[(b + 1) % batches.size()]);
    merged.merge(part);
  }
  for (const GapTable* table : {&forward, &backward, &merged}) {
    const FollowerGaps& of = table->followers().front();
    EXPECT_EQ(of.smallest.gap, 0.3);
    EXPECT_EQ(of.smallest.realization, 1u) << "the first of the realizations with this gap";
    EXPECT_EQ(of.smallest.step, 6);
    EXPECT_EQ(of.unsafe, 4u);
    EXPECT_EQ(of.histogram, forward.followers().front().histogram);
  }
}

TEST(GapTable, CountsGapsFarOutsideInTheOuterBins) {
  GapTable table(kCounting);
  const double infinite = std::numeric_limits<double>::infinity();
  table.add(batch(0, {-infinite, infinite, -1e300, 49999.9, 50000.0, 1e9}));
  const std::int64_t most = FollowerGaps::kMostBins;
  EXPECT_EQ(table.followers().front().histogram,
            (std::map<std::int64_t, std::uint64_t>{{-most, 2}, {most - 1, 1}, {most, 3}}));
}

TEST(GapTable, RejectsTheGapsOfAnotherString) {
  EXPECT_THROW(GapTable(kCounting).merge(GapTable({2, 0.5})), std::invalid_argument);
}

TEST(GapCounting, HasARoundBinWidthBelowAFifthOfTheNoise) {
  PlatoonModel model = paper_platoon();
  for (const auto& [variance, width] : std::vector<std::pair<double, double>>{
           {0.6, 0.1}, {0.01, 0.02}, {1e-8, 2e-5}, {100.0, 2.0}, {30000.0, 20.0}, {0.0, 0.01}}) {
    model.default_vehicle().position().noise_variance = variance;
    EXPECT_DOUBLE_EQ(gap_counting(model, 5).bin_width, width) << variance;
  }
}

TEST(GapTable, TellsTheGapsOfCarsWithPositionsOfACentimetreApart) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().position().noise_variance = 1e-4;
  GapTable table(gap_counting(model, 1));
  table.add(batch(0, {30.001, 90.001, 150.001}));
  EXPECT_EQ(table.followers().front().histogram,
            (std::map<std::int64_t, std::uint64_t>{{15000, 1}, {45000, 1}, {75000, 1}}));
}

}  // namespace
}  // namespace platoon
