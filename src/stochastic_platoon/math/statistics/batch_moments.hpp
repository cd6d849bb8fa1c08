#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/statistics/dyadic_range.hpp"
#include "stochastic_platoon/math/statistics/moments.hpp"

namespace platoon {

/// Moments of every cell (a follower at a step) over one dyadic range of realizations.
struct MomentBlock {
  DyadicRange range;
  std::vector<double> mean;                    ///< [m], one per cell
  std::vector<double> squared_deviations;      ///< [m^2], one per cell
  std::vector<double> cubed_deviations = {};   ///< [m^3], one per cell; empty if not kept
  std::vector<double> fourth_deviations = {};  ///< [m^4], the same

  /// Deviations of one cell; the cubes and fourth powers are 0 in a block with two moments.
  Deviations deviations(std::size_t cell) const {
    if (fourth_deviations.empty()) return {squared_deviations[cell], 0.0, 0.0};
    return {squared_deviations[cell], cubed_deviations[cell], fourth_deviations[cell]};
  }
};

/// Mean and sum of squared deviations of one cell over one dyadic range.
struct MomentNode {
  double mean;                     ///< [m]
  double squared_deviations;       ///< [m^2]
  double cubed_deviations = 0.0;   ///< [m^3]; 0 if not kept
  double fourth_deviations = 0.0;  ///< [m^4]; the same
};

/// Values [offset, offset + count) of a batch: returns a pointer to existing values or computes them in `buffer`.
using ValuesInTurn =
    std::function<const double*(std::size_t offset, std::size_t count, double* buffer)>;  // count <= 512

/// The nodes of one cell's values, one per range of dyadic_cover(first_realization, count).
///
/// Values are paired by realization number, level by level, so a node's bits depend on its range only and not on the
/// batch. The values are requested in ascending tiles of at most 512.
std::vector<MomentNode> reduce_batch(std::uint64_t first_realization, std::size_t count, const ValuesInTurn& values,
                                     KeptMoments kept = KeptMoments::two);

/// The values of a cell, one per realization of a batch [m].
struct CellValues {
  std::size_t cell;
  const double* values;
};

/// Number of cells that are reduced side by side.
constexpr std::size_t kCellsAtOnce = 4;

/// Sums are formed in tiles of at most 2^kMomentTileLevel values: all intermediate levels fit in the first level cache.
constexpr unsigned kMomentTileLevel = 9;
constexpr std::size_t kMomentTile = std::size_t{1} << kMomentTileLevel;

/// Moments of one batch of realizations, cell by cell, as blocks of MomentTable's tree.
class BatchMoments {
public:
  BatchMoments(std::uint64_t first_realization, std::size_t count, std::size_t cells,
               KeptMoments kept = KeptMoments::two);

  /// Sets the cell's values, one per realization of the batch [m]. Throws std::out_of_range if `cell` is out of range.
  void set(std::size_t cell, const double* values);

  /// Sets several cells as above. Four at once take half the time of one after the other, with the same bits.
  void set(const std::vector<CellValues>& cells);

  /// Sets the cell's nodes from reduce_batch(). Throws as above, and std::invalid_argument unless there is one per
  /// block.
  void set(std::size_t cell, const std::vector<MomentNode>& nodes);

  const std::vector<MomentBlock>& blocks() const { return blocks_; }

  /// Moves the blocks out.
  std::vector<MomentBlock> release() { return std::move(blocks_); }

private:
  void put(std::size_t block, std::size_t cell, const MomentNode& node);
  void require_cell(std::size_t cell) const;

  KeptMoments kept_;
  std::vector<MomentBlock> blocks_;
};

}  // namespace platoon
