#pragma once

#include <array>
#include <cstddef>

#include "stochastic_platoon/math/model/vector_clones.hpp"
#include "stochastic_platoon/math/statistics/batch_moments.hpp"

namespace platoon {

/// Four doubles. Kernels use it so that every machine computes four cells side by side; each lane does the operations
/// of merge_equal(), so that the bits are those of one cell after the other.
using Lanes = double __attribute__((vector_size(32)));
static_assert(sizeof(Lanes) == kCellsAtOnce * sizeof(double), "one lane a cell");

/// The binary tree of MomentTable over a tile of values of four cells, one per lane. Joining two nodes needs no
/// shuffles.
struct LaneTree {
  static constexpr unsigned kLowestLevel = 2;
  static constexpr std::size_t kMostLeaves = kMomentTile / 4;

  std::array<Lanes, kMostLeaves> mean, deviations;

  /// Node j of level 2, from its four values.
  PLATOON_INLINE void join_values(std::size_t j, const std::array<Lanes, 4>& x) {
    const Lanes left = 0.5 * (x[0] + x[1]), right = 0.5 * (x[2] + x[3]), shift = right - left;
    const Lanes of_left = x[1] - x[0], of_right = x[3] - x[2];
    mean[j] = 0.5 * (left + right);
    deviations[j] = ((of_left * of_left) * 0.5 + (of_right * of_right) * 0.5) + shift * shift;
  }

  /// Joins `count` nodes of level 2 up to the root, which is node 0 then.
  PLATOON_INLINE void join_nodes(std::size_t count) {
    double half_count = 2.0;
    for (count /= 2; count > 0; count /= 2, half_count *= 2.0) {
      for (std::size_t j = 0; j < count; ++j) {
        const Lanes left = mean[2 * j], right = mean[2 * j + 1], shift = right - left;
        mean[j] = 0.5 * (left + right);
        deviations[j] = (deviations[2 * j] + deviations[2 * j + 1]) + (shift * shift) * half_count;
      }
    }
  }

  MomentNode root(std::size_t lane) const { return {mean[0][lane], deviations[0][lane]}; }
};

}  // namespace platoon
