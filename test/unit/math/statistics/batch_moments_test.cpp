#include "stochastic_platoon/math/statistics/batch_moments.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "unit/math/statistics/sample_batches.hpp"
#include "unit/same_bits.hpp"

namespace platoon {
namespace {

TEST(BatchMoments, HaveTheBlocksOfTheirRealizations) {
  const BatchMoments moments = sample_batch(3, 10);
  ASSERT_EQ(moments.blocks().size(), 4u);  // 3, 4 .. 7, 8 .. 11, 12
  EXPECT_EQ(moments.blocks()[1].range.first, 4u);
  EXPECT_EQ(moments.blocks()[1].range.level, 2u);
  const std::vector<double> x = sample_values(2, 3, 10);
  EXPECT_EQ(moments.blocks()[0].mean[2], x[0]);
  EXPECT_EQ(moments.blocks()[0].squared_deviations[2], 0.0);
  EXPECT_EQ(moments.blocks()[3].mean[2], x[9]);
}

TEST(BatchMoments, HaveTheBitsOfEachCellAloneForFourAtOnce) {
  for (const std::size_t count : {1, 2, 3, 5, 8, 100, 511, 512, 1500}) {
    for (const std::uint64_t first : {0, 5, 512}) {
      BatchMoments together(first, count, kCellsAtOnce), alone(first, count, kCellsAtOnce);
      std::vector<std::vector<double>> of_cell;
      std::vector<CellValues> cells;
      for (std::size_t c = 0; c < kCellsAtOnce; ++c) of_cell.push_back(sample_values(c, first, count));
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

TEST(BatchMoments, RejectACellBeyondTheLast) {
  BatchMoments moments(0, 2, kCells);
  const std::vector<double> x = {1.0, 2.0};
  EXPECT_NO_THROW(moments.set(kCells - 1, x.data()));
  EXPECT_THROW(moments.set(kCells, x.data()), std::out_of_range);
}

}  // namespace
}  // namespace platoon
