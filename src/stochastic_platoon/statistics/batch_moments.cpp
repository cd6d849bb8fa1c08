#include "stochastic_platoon/statistics/batch_moments.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/model/vector_clones.hpp"
#include "stochastic_platoon/statistics/moments.hpp"

namespace platoon {

namespace detail {

struct Node {
  double mean;
  double squared_deviations;
};

}  // namespace detail

namespace {

using detail::Node;

// Halves a level: node j of the next one joins nodes 2j and 2j + 1, of 2 half_count values each.
PLATOON_INLINE void join_pairs(const double* mean, const double* deviations, std::size_t pairs,
                               double half_count, double* mean_out, double* deviations_out) {
  for (std::size_t j = 0; j < pairs; ++j) {
    merge_equal(mean[2 * j], deviations[2 * j], mean[2 * j + 1], deviations[2 * j + 1], half_count,
                &mean_out[j], &deviations_out[j]);
  }
}

PLATOON_INLINE void pair_values(const double* values, std::size_t pairs, double* mean_out,
                                double* deviations_out) {
  for (std::size_t j = 0; j < pairs; ++j) {
    const double shift = values[2 * j + 1] - values[2 * j];
    mean_out[j] = 0.5 * (values[2 * j] + values[2 * j + 1]);
    deviations_out[j] = (shift * shift) * 0.5;
  }
}

constexpr unsigned kTileLevel =
    9;  // tiles of 512 values: every intermediate level stays in the first level cache
constexpr std::size_t kTile = std::size_t{1} << kTileLevel;

}  // namespace

namespace detail {

PLATOON_VECTOR_CLONES
Node reduce_tile(const double* values, unsigned level) {
  if (level == 0) return {values[0], 0.0};
  std::array<double, kTile / 2> mean_a, deviations_a, mean_b, deviations_b;
  std::size_t pairs = std::size_t{1} << (level - 1);
  pair_values(values, pairs, mean_a.data(), deviations_a.data());
  double half_count = 1.0;
  bool in_a = true;
  for (pairs /= 2; pairs > 0; pairs /= 2, half_count *= 2.0, in_a = !in_a) {
    if (in_a) {
      join_pairs(mean_a.data(), deviations_a.data(), pairs, half_count, mean_b.data(), deviations_b.data());
    } else {
      join_pairs(mean_b.data(), deviations_b.data(), pairs, half_count, mean_a.data(), deviations_a.data());
    }
  }
  return in_a ? Node{mean_a[0], deviations_a[0]} : Node{mean_b[0], deviations_b[0]};
}

}  // namespace detail

namespace {

Node reduce(const double* values, unsigned level) {
  if (level <= kTileLevel) return detail::reduce_tile(values, level);
  const std::size_t half = std::size_t{1} << (level - 1);
  const Node left = reduce(values, level - 1);
  const Node right = reduce(values + half, level - 1);
  Node joined;
  merge_equal(left.mean, left.squared_deviations, right.mean, right.squared_deviations,
              0.5 * static_cast<double>(half), &joined.mean, &joined.squared_deviations);
  return joined;
}

}  // namespace

BatchMoments::BatchMoments(std::uint64_t first_realization, std::size_t count, std::size_t cells)
    : first_(first_realization), count_(count) {
  for (const DyadicRange& range : dyadic_cover(first_realization, count)) {
    blocks_.push_back({range, std::vector<double>(cells), std::vector<double>(cells)});
  }
}

void BatchMoments::set(std::size_t cell, const double* values) {
  for (MomentBlock& block : blocks_) {
    if (cell >= block.mean.size()) {
      throw std::out_of_range("cell " + std::to_string(cell) + ": must be below " +
                              std::to_string(block.mean.size()));
    }
    const Node node = reduce(values, block.range.level);
    block.mean[cell] = node.mean;
    block.squared_deviations[cell] = node.squared_deviations;
    values += block.range.size();
  }
}

}  // namespace platoon
