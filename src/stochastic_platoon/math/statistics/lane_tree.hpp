#pragma once

#include <array>
#include <cstddef>
#include <cstring>

#include "stochastic_platoon/math/numerics/vector_clones.hpp"
#include "stochastic_platoon/math/statistics/batch_moments.hpp"

namespace platoon {

/// Four doubles. Kernels use it so that every machine computes four cells side by side; each lane does the operations
/// of merge_equal(), so that the bits are those of one cell after the other.
using Lanes = double __attribute__((vector_size(32)));
static_assert(sizeof(Lanes) == kCellsAtOnce * sizeof(double), "one lane a cell");

/// Eight doubles, for processors with such registers: four cells at two places of the tree.
using WideLanes = double __attribute__((vector_size(64)));

/// One value or node per cell.
template <class Vector>
using FourOf = std::array<Vector, kCellsAtOnce>;
using FourNodes = std::array<MomentNode, kCellsAtOnce>;

// `lanes` is a reference, as the baseline's calling convention has no such vectors.
template <class Vector>
PLATOON_INLINE void load(const double* values, Vector& lanes) {
  std::memcpy(&lanes, values, sizeof lanes);
}

/// Lowers values to `lanes` wherever these are smaller, and `least` likewise.
template <class Vector>
PLATOON_INLINE void lower_lanes(const Vector& lanes, double* values, Vector& least) {
  Vector low;
  load(values, low);
  low = lanes < low ? lanes : low;
  std::memcpy(values, &low, sizeof low);
  least = lanes < least ? lanes : least;
}

#ifdef __clang__
#define PLATOON_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define PLATOON_SHUFFLE(a, b, ...) __builtin_shuffle(a, b, PlacesOf<decltype(a + b)>{__VA_ARGS__})
template <class Vector>
using PlacesOf = decltype(Vector{} < Vector{});
#endif

/// From four realizations of one cell per vector to four cells of one realization.
PLATOON_INLINE FourOf<Lanes> transposed(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d) {
  const Lanes even_ab = PLATOON_SHUFFLE(a, b, 0, 4, 2, 6), odd_ab = PLATOON_SHUFFLE(a, b, 1, 5, 3, 7),
              even_cd = PLATOON_SHUFFLE(c, d, 0, 4, 2, 6), odd_cd = PLATOON_SHUFFLE(c, d, 1, 5, 3, 7);
  return {PLATOON_SHUFFLE(even_ab, even_cd, 0, 1, 4, 5), PLATOON_SHUFFLE(odd_ab, odd_cd, 0, 1, 4, 5),
          PLATOON_SHUFFLE(even_ab, even_cd, 2, 3, 6, 7), PLATOON_SHUFFLE(odd_ab, odd_cd, 2, 3, 6, 7)};
}

/// From eight realizations of one cell per vector to four cells of realizations r and r + 4.
PLATOON_INLINE FourOf<WideLanes> transposed(const WideLanes& a, const WideLanes& b, const WideLanes& c,
                                            const WideLanes& d) {
  const WideLanes even_ab = PLATOON_SHUFFLE(a, b, 0, 8, 2, 10, 4, 12, 6, 14),
                  odd_ab = PLATOON_SHUFFLE(a, b, 1, 9, 3, 11, 5, 13, 7, 15),
                  even_cd = PLATOON_SHUFFLE(c, d, 0, 8, 2, 10, 4, 12, 6, 14),
                  odd_cd = PLATOON_SHUFFLE(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
  return {PLATOON_SHUFFLE(even_ab, even_cd, 0, 1, 8, 9, 4, 5, 12, 13),
          PLATOON_SHUFFLE(odd_ab, odd_cd, 0, 1, 8, 9, 4, 5, 12, 13),
          PLATOON_SHUFFLE(even_ab, even_cd, 2, 3, 10, 11, 6, 7, 14, 15),
          PLATOON_SHUFFLE(odd_ab, odd_cd, 2, 3, 10, 11, 6, 7, 14, 15)};
}

/// Nodes of four cells, one per lane. Joining two needs no shuffles.
template <class Vector>
struct LaneNode {
  Vector mean, deviations;
};

/// The node of four values per cell.
template <class Vector>
PLATOON_INLINE LaneNode<Vector> node_of(const FourOf<Vector>& x) {
  const Vector left = 0.5 * (x[0] + x[1]), right = 0.5 * (x[2] + x[3]), shift = right - left;
  const Vector of_left = x[1] - x[0], of_right = x[3] - x[2];
  return {0.5 * (left + right), ((of_left * of_left) * 0.5 + (of_right * of_right) * 0.5) + shift * shift};
}

/// merge_equal() in every lane.
template <class Vector>
PLATOON_INLINE LaneNode<Vector> joined(const LaneNode<Vector>& left, const LaneNode<Vector>& right, double half_count) {
  const Vector shift = right.mean - left.mean;
  return {0.5 * (left.mean + right.mean), (left.deviations + right.deviations) + (shift * shift) * half_count};
}

/// The halves 0 or the halves 1 of two wide nodes.
template <std::size_t kHalf>
PLATOON_INLINE LaneNode<WideLanes> halves_of(const LaneNode<WideLanes>& a, const LaneNode<WideLanes>& b) {
  constexpr long long k = kHalf * kCellsAtOnce;
  return {PLATOON_SHUFFLE(a.mean, b.mean, k, k + 1, k + 2, k + 3, k + 8, k + 9, k + 10, k + 11),
          PLATOON_SHUFFLE(a.deviations, b.deviations, k, k + 1, k + 2, k + 3, k + 8, k + 9, k + 10, k + 11)};
}

template <std::size_t kHalf>
PLATOON_INLINE LaneNode<Lanes> half_of(const LaneNode<WideLanes>& wide) {
  LaneNode<Lanes> node;
  std::memcpy(&node.mean, reinterpret_cast<const char*>(&wide.mean) + kHalf * sizeof(Lanes), sizeof(Lanes));
  std::memcpy(&node.deviations, reinterpret_cast<const char*>(&wide.deviations) + kHalf * sizeof(Lanes), sizeof(Lanes));
  return node;
}

/// The node of realizations 16 j .. 16 j + 15, joined in registers.
template <class Values>
PLATOON_INLINE LaneNode<Lanes> node_of_sixteen(const Values& values, std::size_t j, const Lanes& tag) {
  const LaneNode<Lanes> left = joined(node_of(values(4 * j, tag)), node_of(values(4 * j + 1, tag)), 2.0);
  return joined(left, joined(node_of(values(4 * j + 2, tag)), node_of(values(4 * j + 3, tag)), 2.0), 4.0);
}

template <class Values>
PLATOON_INLINE LaneNode<Lanes> node_of_sixteen(const Values& values, std::size_t j, const WideLanes& tag) {
  const LaneNode<WideLanes> a = node_of(values(2 * j, tag)), b = node_of(values(2 * j + 1, tag));
  const LaneNode<WideLanes> both = joined(halves_of<0>(a, b), halves_of<1>(a, b), 2.0);
  return joined(half_of<0>(both), half_of<1>(both), 4.0);
}

/// The lowest level of nodes that reduce_tile_of_four() forms.
constexpr unsigned kLowestLaneLevel = 2;

/// The nodes of four cells over a tile of 2^level values, level from kLowestLaneLevel to kMomentTileLevel: the binary
/// tree of MomentTable. `values(j, Vector{})` returns vector j of the tile's realizations, transposed; its call must be
/// PLATOON_INLINE. Vector: Lanes or WideLanes, for as many realizations; the bits are the same.
template <class Vector, class Values>
PLATOON_INLINE FourNodes reduce_tile_of_four(unsigned level, const Values& values) {
  std::array<LaneNode<Lanes>, kMomentTile / 16> tree;
  if (level == kLowestLaneLevel) {
    tree[0] = node_of(values(0, Lanes{}));
  } else if (level == kLowestLaneLevel + 1) {
    tree[0] = joined(node_of(values(0, Lanes{})), node_of(values(1, Lanes{})), 2.0);
  } else {
    std::size_t count = std::size_t{1} << (level - 4);
    for (std::size_t j = 0; j < count; ++j) tree[j] = node_of_sixteen(values, j, Vector{});
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
