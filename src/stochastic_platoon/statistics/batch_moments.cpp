#include "stochastic_platoon/statistics/batch_moments.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/model/vector_clones.hpp"
#include "stochastic_platoon/statistics/moments.hpp"

namespace platoon {

namespace {

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

// Tiles of 512 values: every intermediate level stays in the first level cache.
constexpr unsigned kTileLevel = 9;
constexpr std::size_t kTile = std::size_t{1} << kTileLevel;

}  // namespace

namespace detail {

PLATOON_VECTOR_CLONES
MomentNode reduce_tile(const double* values, unsigned level) {
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
  return in_a ? MomentNode{mean_a[0], deviations_a[0]} : MomentNode{mean_b[0], deviations_b[0]};
}

}  // namespace detail

namespace {

MomentNode reduce(const ValuesInTurn& values, std::size_t offset, unsigned level) {
  if (level <= kTileLevel) {
    std::array<double, kTile> buffer;
    return detail::reduce_tile(values(offset, std::size_t{1} << level, buffer.data()), level);
  }
  const std::size_t half = std::size_t{1} << (level - 1);
  const MomentNode left = reduce(values, offset, level - 1);
  const MomentNode right = reduce(values, offset + half, level - 1);
  MomentNode joined;
  merge_equal(left.mean, left.squared_deviations, right.mean, right.squared_deviations,
              0.5 * static_cast<double>(half), &joined.mean, &joined.squared_deviations);
  return joined;
}

}  // namespace

std::vector<MomentNode> reduce_batch(std::uint64_t first_realization, std::size_t count,
                                     const ValuesInTurn& values) {
  std::vector<MomentNode> nodes;
  std::size_t offset = 0;
  for (const DyadicRange& range : dyadic_cover(first_realization, count)) {
    nodes.push_back(reduce(values, offset, range.level));
    offset += range.size();
  }
  return nodes;
}

BatchMoments::BatchMoments(std::uint64_t first_realization, std::size_t count, std::size_t cells)
    : first_(first_realization), count_(count) {
  for (const DyadicRange& range : dyadic_cover(first_realization, count)) {
    blocks_.push_back({range, std::vector<double>(cells), std::vector<double>(cells)});
  }
}

void BatchMoments::require_cell(std::size_t cell) const {
  if (blocks_.empty() || cell < blocks_.front().mean.size()) return;
  throw std::out_of_range("cell " + std::to_string(cell) + ": must be below " +
                          std::to_string(blocks_.front().mean.size()));
}

void BatchMoments::set(std::size_t cell, const double* values) {
  require_cell(cell);
  const ValuesInTurn in_place = [&values](std::size_t offset, std::size_t, double*) {
    return values + offset;
  };
  for (MomentBlock& block : blocks_) {
    const MomentNode node = reduce(in_place, 0, block.range.level);
    block.mean[cell] = node.mean;
    block.squared_deviations[cell] = node.squared_deviations;
    values += block.range.size();
  }
}

void BatchMoments::set(std::size_t cell, const std::vector<MomentNode>& nodes) {
  require_cell(cell);
  if (nodes.size() != blocks_.size()) {
    throw std::invalid_argument(std::to_string(nodes.size()) + " nodes: must be one for each of " +
                                std::to_string(blocks_.size()) + " blocks");
  }
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    blocks_[b].mean[cell] = nodes[b].mean;
    blocks_[b].squared_deviations[cell] = nodes[b].squared_deviations;
  }
}

}  // namespace platoon
