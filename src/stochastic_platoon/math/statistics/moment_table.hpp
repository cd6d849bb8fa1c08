#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "stochastic_platoon/math/statistics/batch_moments.hpp"
#include "stochastic_platoon/math/statistics/moments.hpp"
#include "stochastic_platoon/math/statistics/shard.hpp"

namespace platoon {

/// Moments of every cell over any set of realizations, as a pure function of that set.
///
/// Keeps the maximal dyadic blocks of the set: two sibling blocks are joined as soon as both are present. Floating
/// point sums thus always follow the same tree, so batch sizes, arrival order, merging and restarts do not change a
/// bit. For realizations 0 .. R - 1 the table has at most log2(R) + 1 blocks.
class MomentTable {
public:
  explicit MomentTable(std::size_t cells) : cells_(cells) {}

  std::size_t cells() const { return cells_; }
  std::uint64_t count() const;

  /// Adds a block. Throws std::invalid_argument if the table already contains its realizations or its number of cells
  /// differs.
  void add(MomentBlock block);
  void add(BatchMoments batch);
  void merge(const MomentTable& other);

  /// The realizations of a range that the table does not contain, in ascending order.
  std::vector<RealizationRange> missing(const RealizationRange& range) const;

  /// Moments of each cell over all realizations: the blocks in ascending order, merged from the left.
  std::vector<Moments> totals() const;

  /// The maximal blocks, by their first realization.
  const std::map<std::uint64_t, MomentBlock>& blocks() const { return blocks_; }

private:
  std::size_t cells_;
  std::map<std::uint64_t, MomentBlock> blocks_;
};

}  // namespace platoon
