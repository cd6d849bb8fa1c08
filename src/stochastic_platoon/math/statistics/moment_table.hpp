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
/// Keeps the maximal dyadic blocks of the set: two sibling blocks are joined as soon as both are there.
/// Floating point sums are so always formed along the same tree: batch sizes, the order of arrival, merging
/// and restarts cannot change a bit. For realizations 0 .. R - 1 at most log2(R) + 1 blocks are kept.
class MomentTable {
public:
  explicit MomentTable(std::size_t cells) : cells_(cells) {}

  std::size_t cells() const { return cells_; }
  std::uint64_t count() const;

  /// Takes a block in. Throws std::invalid_argument when its realizations are there already or its cells
  /// differ.
  void add(MomentBlock block);
  void add(BatchMoments batch);
  void merge(const MomentTable& other);

  /// The realizations of a range that are not there, in ascending order.
  std::vector<RealizationRange> missing(const RealizationRange& range) const;

  /// Moments of each cell over all realizations taken in: the blocks in ascending order, merged from the
  /// left.
  std::vector<Moments> totals() const;

  /// The maximal blocks, by their first realization.
  const std::map<std::uint64_t, MomentBlock>& blocks() const { return blocks_; }

private:
  std::size_t cells_;
  std::map<std::uint64_t, MomentBlock> blocks_;
};

}  // namespace platoon
