#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "stochastic_platoon/statistics/dyadic_range.hpp"

namespace platoon {

/// Moments of every cell (a follower at a step) over one dyadic range of realizations.
struct MomentBlock {
  DyadicRange range;
  std::vector<double> mean;                ///< [m], one per cell
  std::vector<double> squared_deviations;  ///< [m^2], one per cell
};

/// Moments of one batch of realizations, cell by cell, as blocks of the tree that MomentTable keeps.
///
/// Values are paired by realization number, level by level, so a block's bits depend on its range alone and
/// not on the batch in which it was formed.
class BatchMoments {
public:
  BatchMoments(std::uint64_t first_realization, std::size_t count, std::size_t cells);

  std::uint64_t first_realization() const { return first_; }
  std::size_t count() const { return count_; }

  /// Takes the cell's values, one for each realization of the batch. Throws std::out_of_range for a cell
  /// there is not.
  void set(std::size_t cell, const double* values);

  const std::vector<MomentBlock>& blocks() const { return blocks_; }

  /// Gives the blocks away and keeps none.
  std::vector<MomentBlock> release() { return std::move(blocks_); }

private:
  std::uint64_t first_;
  std::size_t count_;
  std::vector<MomentBlock> blocks_;
};

}  // namespace platoon
