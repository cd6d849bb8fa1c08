#pragma once

#include <array>
#include <cstddef>
#include <cstring>

#include "stochastic_platoon/math/model/vector_clones.hpp"
#include "stochastic_platoon/math/statistics/batch_moments.hpp"

namespace platoon {

/// Four doubles. Kernels use it so that every machine computes four cells side by side; each lane does the operations
/// of merge_equal(), so that the bits are those of one cell after the other.
using Lanes = double __attribute__((vector_size(32)));
static_assert(sizeof(Lanes) == kCellsAtOnce * sizeof(double), "one lane a cell");

/// One value or node per cell.
using FourLanes = std::array<Lanes, kCellsAtOnce>;
using FourNodes = std::array<MomentNode, kCellsAtOnce>;

// A reference, as the baseline's calling convention has no such vectors.
PLATOON_INLINE void load(const double* values, Lanes& lanes) {
  std::memcpy(&lanes, values, sizeof lanes);
}

/// From four realizations of one cell per vector to four cells of one realization.
PLATOON_INLINE FourLanes transposed(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d) {
#ifdef __clang__
  const Lanes even_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), odd_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7),
              even_cd = __builtin_shufflevector(c, d, 0, 4, 2, 6), odd_cd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return {__builtin_shufflevector(even_ab, even_cd, 0, 1, 4, 5), __builtin_shufflevector(odd_ab, odd_cd, 0, 1, 4, 5),
          __builtin_shufflevector(even_ab, even_cd, 2, 3, 6, 7), __builtin_shufflevector(odd_ab, odd_cd, 2, 3, 6, 7)};
#else
  using Places = long long __attribute__((vector_size(32)));
  constexpr Places kEven{0, 4, 2, 6}, kOdd{1, 5, 3, 7}, kFirst{0, 1, 4, 5}, kLast{2, 3, 6, 7};
  const Lanes even_ab = __builtin_shuffle(a, b, kEven), odd_ab = __builtin_shuffle(a, b, kOdd),
              even_cd = __builtin_shuffle(c, d, kEven), odd_cd = __builtin_shuffle(c, d, kOdd);
  return {__builtin_shuffle(even_ab, even_cd, kFirst), __builtin_shuffle(odd_ab, odd_cd, kFirst),
          __builtin_shuffle(even_ab, even_cd, kLast), __builtin_shuffle(odd_ab, odd_cd, kLast)};
#endif
}

/// Nodes of four cells, one per lane. Joining two needs no shuffles.
struct LaneNode {
  Lanes mean, deviations;
};

/// The node of four values per cell.
PLATOON_INLINE LaneNode node_of(const FourLanes& x) {
  const Lanes left = 0.5 * (x[0] + x[1]), right = 0.5 * (x[2] + x[3]), shift = right - left;
  const Lanes of_left = x[1] - x[0], of_right = x[3] - x[2];
  return {0.5 * (left + right), ((of_left * of_left) * 0.5 + (of_right * of_right) * 0.5) + shift * shift};
}

/// merge_equal() in every lane.
PLATOON_INLINE LaneNode joined(const LaneNode& left, const LaneNode& right, double half_count) {
  const Lanes shift = right.mean - left.mean;
  return {0.5 * (left.mean + right.mean), (left.deviations + right.deviations) + (shift * shift) * half_count};
}

/// The lowest level of nodes that reduce_tile_of_four() forms.
constexpr unsigned kLowestLaneLevel = 2;

/// The nodes of four cells over a tile of 2^level values, level from kLowestLaneLevel to kMomentTileLevel: the binary
/// tree of MomentTable. `values` returns realizations 4 j .. 4 j + 3 of the tile, each with its four cells; its call
/// must be PLATOON_INLINE. Sixteen realizations at a time are joined in registers.
template <class Values>
PLATOON_INLINE FourNodes reduce_tile_of_four(unsigned level, const Values& values) {
  std::array<LaneNode, kMomentTile / 16> tree;
  if (level == kLowestLaneLevel) {
    tree[0] = node_of(values(0));
  } else if (level == kLowestLaneLevel + 1) {
    tree[0] = joined(node_of(values(0)), node_of(values(1)), 2.0);
  } else {
    std::size_t count = std::size_t{1} << (level - 4);
    for (std::size_t j = 0; j < count; ++j) {
      const LaneNode left = joined(node_of(values(4 * j)), node_of(values(4 * j + 1)), 2.0);
      tree[j] = joined(left, joined(node_of(values(4 * j + 2)), node_of(values(4 * j + 3)), 2.0), 4.0);
    }
    double half_count = 8.0;
    for (count /= 2; count > 0; count /= 2, half_count *= 2.0) {
      for (std::size_t j = 0; j < count; ++j) tree[j] = joined(tree[2 * j], tree[2 * j + 1], half_count);
    }
  }
  FourNodes nodes;
  for (std::size_t cell = 0; cell < kCellsAtOnce; ++cell) nodes[cell] = {tree[0].mean[cell], tree[0].deviations[cell]};
  return nodes;
}

/// The nodes of four cells over 2^level values from `offset` on: tile(offset, level) where a tile suffices.
template <class Tile>
FourNodes reduce_four(std::size_t offset, unsigned level, const Tile& tile) {
  if (level <= kMomentTileLevel) return tile(offset, level);
  const std::size_t half = std::size_t{1} << (level - 1);
  const FourNodes left = reduce_four(offset, level - 1, tile), right = reduce_four(offset + half, level - 1, tile);
  FourNodes nodes;
  for (std::size_t cell = 0; cell < kCellsAtOnce; ++cell) {
    merge_equal(left[cell].mean, left[cell].squared_deviations, right[cell].mean, right[cell].squared_deviations,
                0.5 * static_cast<double>(half), &nodes[cell].mean, &nodes[cell].squared_deviations);
  }
  return nodes;
}

}  // namespace platoon
