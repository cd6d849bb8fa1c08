#include "stochastic_platoon/math/statistics/batch_moments.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/numerics/vector_clones.hpp"
#include "stochastic_platoon/math/statistics/lane_tree.hpp"
#include "stochastic_platoon/math/statistics/moments.hpp"

namespace platoon {

namespace {

// Joins a level in pairs: node j of the next level joins nodes 2j and 2j + 1 of 2 half_count values each.
PLATOON_INLINE void join_pairs(const double* mean, const double* deviations, std::size_t pairs, double half_count,
                               double* mean_out, double* deviations_out) {
  for (std::size_t j = 0; j < pairs; ++j) {
    merge_equal(mean[2 * j], deviations[2 * j], mean[2 * j + 1], deviations[2 * j + 1], half_count, &mean_out[j],
                &deviations_out[j]);
  }
}

PLATOON_INLINE void pair_values(const double* values, std::size_t pairs, double* mean_out, double* deviations_out) {
  for (std::size_t j = 0; j < pairs; ++j) {
    const double shift = values[2 * j + 1] - values[2 * j];
    mean_out[j] = 0.5 * (values[2 * j] + values[2 * j + 1]);
    deviations_out[j] = (shift * shift) * 0.5;
  }
}

// One level of a tile with four moments.
struct PowerTile {
  std::array<double, kMomentTile / 2> mean, squared, cubed, fourth;
};

PLATOON_INLINE void pair_powers(const double* values, std::size_t pairs, PowerTile& out) {
  for (std::size_t j = 0; j < pairs; ++j) {
    const double shift = values[2 * j + 1] - values[2 * j], square = shift * shift;
    out.mean[j] = 0.5 * (values[2 * j] + values[2 * j + 1]);
    out.squared[j] = square * 0.5;
    out.cubed[j] = 0.0;
    out.fourth[j] = (square * square) * 0.125;
  }
}

PLATOON_INLINE void join_powers(const PowerTile& in, std::size_t pairs, double half_count, PowerTile& out) {
  for (std::size_t j = 0; j < pairs; ++j) {
    const std::size_t l = 2 * j, r = 2 * j + 1;
    merge_equal_powers(in.mean[r] - in.mean[l], {in.squared[l], in.cubed[l], in.fourth[l]},
                       {in.squared[r], in.cubed[r], in.fourth[r]}, half_count, &out.cubed[j], &out.fourth[j]);
    merge_equal(in.mean[l], in.squared[l], in.mean[r], in.squared[r], half_count, &out.mean[j], &out.squared[j]);
  }
}

}  // namespace

namespace detail {

PLATOON_VECTOR_CLONES
MomentNode reduce_tile(const double* values, unsigned level) {
  if (level == 0) return {values[0], 0.0};
  std::array<double, kMomentTile / 2> mean_a, deviations_a, mean_b, deviations_b;
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

PLATOON_VECTOR_CLONES
MomentNode reduce_tile_to_four(const double* values, unsigned level) {
  if (level == 0) return {values[0], 0.0};
  PowerTile a, b;
  std::size_t pairs = std::size_t{1} << (level - 1);
  pair_powers(values, pairs, a);
  double half_count = 1.0;
  bool in_a = true;
  for (pairs /= 2; pairs > 0; pairs /= 2, half_count *= 2.0, in_a = !in_a) {
    if (in_a) {
      join_powers(a, pairs, half_count, b);
    } else {
      join_powers(b, pairs, half_count, a);
    }
  }
  const PowerTile& last = in_a ? a : b;
  return {last.mean[0], last.squared[0], last.cubed[0], last.fourth[0]};
}

namespace {

struct ValuesOfFour {
  const double *a, *b, *c, *d;

  template <class Vector>
  PLATOON_INLINE FourOf<Vector> operator()(std::size_t j, const Vector&) const {
    const std::size_t r = sizeof(Vector) / sizeof(double) * j;
    Vector of_a, of_b, of_c, of_d;
    load(a + r, of_a);
    load(b + r, of_b);
    load(c + r, of_c);
    load(d + r, of_d);
    return transposed(of_a, of_b, of_c, of_d);
  }
};

}  // namespace

using Cells = std::array<const double*, kCellsAtOnce>;

PLATOON_VECTOR_CLONES
FourNodes reduce_tile_of_cells(const Cells& cells, unsigned level) {
  return reduce_tile_of_four<Lanes>(level, ValuesOfFour{cells[0], cells[1], cells[2], cells[3]});
}

#ifdef PLATOON_WIDE
PLATOON_WIDE
FourNodes reduce_wide_tile_of_cells(const Cells& cells, unsigned level) {
  return reduce_tile_of_four<WideLanes>(level, ValuesOfFour{cells[0], cells[1], cells[2], cells[3]});
}
#else
constexpr auto reduce_wide_tile_of_cells = reduce_tile_of_cells;
#endif

}  // namespace detail

namespace {

MomentNode reduce(const ValuesInTurn& values, std::size_t offset, unsigned level, KeptMoments kept) {
  if (level <= kMomentTileLevel) {
    std::array<double, kMomentTile> buffer;
    const double* const tile = values(offset, std::size_t{1} << level, buffer.data());
    return kept == KeptMoments::four ? detail::reduce_tile_to_four(tile, level) : detail::reduce_tile(tile, level);
  }
  const std::size_t half = std::size_t{1} << (level - 1);
  const MomentNode left = reduce(values, offset, level - 1, kept);
  const MomentNode right = reduce(values, offset + half, level - 1, kept);
  MomentNode joined;
  merge_equal(left.mean, left.squared_deviations, right.mean, right.squared_deviations, 0.5 * static_cast<double>(half),
              &joined.mean, &joined.squared_deviations);
  if (kept == KeptMoments::four) {
    merge_equal_powers(right.mean - left.mean, {left.squared_deviations, left.cubed_deviations, left.fourth_deviations},
                       {right.squared_deviations, right.cubed_deviations, right.fourth_deviations},
                       0.5 * static_cast<double>(half), &joined.cubed_deviations, &joined.fourth_deviations);
  }
  return joined;
}

}  // namespace

std::vector<MomentNode> reduce_batch(std::uint64_t first_realization, std::size_t count, const ValuesInTurn& values,
                                     KeptMoments kept) {
  std::vector<MomentNode> nodes;
  std::size_t offset = 0;
  for (const DyadicRange& range : dyadic_cover(first_realization, count)) {
    nodes.push_back(reduce(values, offset, range.level, kept));
    offset += range.size();
  }
  return nodes;
}

BatchMoments::BatchMoments(std::uint64_t first_realization, std::size_t count, std::size_t cells, KeptMoments kept)
    : first_(first_realization), count_(count), kept_(kept) {
  const std::size_t of_powers = kept == KeptMoments::four ? cells : 0;
  for (const DyadicRange& range : dyadic_cover(first_realization, count)) {
    blocks_.push_back({range, std::vector<double>(cells), std::vector<double>(cells), std::vector<double>(of_powers),
                       std::vector<double>(of_powers)});
  }
}

void BatchMoments::put(std::size_t block, std::size_t cell, const MomentNode& node) {
  blocks_[block].mean[cell] = node.mean;
  blocks_[block].squared_deviations[cell] = node.squared_deviations;
  if (kept_ == KeptMoments::two) return;
  blocks_[block].cubed_deviations[cell] = node.cubed_deviations;
  blocks_[block].fourth_deviations[cell] = node.fourth_deviations;
}

void BatchMoments::require_cell(std::size_t cell) const {
  if (blocks_.empty() || cell < blocks_.front().mean.size()) return;
  throw std::out_of_range("cell " + std::to_string(cell) + ": must be below " +
                          std::to_string(blocks_.front().mean.size()));
}

void BatchMoments::set(std::size_t cell, const double* values) {
  require_cell(cell);
  const ValuesInTurn in_place = [&values](std::size_t offset, std::size_t, double*) { return values + offset; };
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    put(b, cell, reduce(in_place, 0, blocks_[b].range.level, kept_));
    values += blocks_[b].range.size();
  }
}

void BatchMoments::set(const std::vector<CellValues>& cells) {
  if (cells.size() != kCellsAtOnce || kept_ == KeptMoments::four) {
    for (const CellValues& of : cells) set(of.cell, of.values);
    return;
  }
  std::array<const double*, kCellsAtOnce> values;
  for (std::size_t j = 0; j < kCellsAtOnce; ++j) {
    require_cell(cells[j].cell);
    values[j] = cells[j].values;
  }
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const DyadicRange& range = blocks_[b].range;
    if (range.level >= kLowestLaneLevel) {
      const auto tile = [&values](std::size_t offset, unsigned level) {
        const detail::Cells at{values[0] + offset, values[1] + offset, values[2] + offset, values[3] + offset};
        return has_wide_lanes() ? detail::reduce_wide_tile_of_cells(at, level)
                                : detail::reduce_tile_of_cells(at, level);
      };
      const FourNodes nodes = reduce_four(0, range.level, tile);
      for (std::size_t j = 0; j < kCellsAtOnce; ++j) put(b, cells[j].cell, nodes[j]);
    } else {
      for (std::size_t j = 0; j < kCellsAtOnce; ++j) put(b, cells[j].cell, detail::reduce_tile(values[j], range.level));
    }
    for (const double*& of : values) of += range.size();
  }
}

void BatchMoments::set(std::size_t cell, const std::vector<MomentNode>& nodes) {
  require_cell(cell);
  if (nodes.size() != blocks_.size()) {
    throw std::invalid_argument(std::to_string(nodes.size()) + " nodes: must be one for each of " +
                                std::to_string(blocks_.size()) + " blocks");
  }
  for (std::size_t b = 0; b < blocks_.size(); ++b) put(b, cell, nodes[b]);
}

}  // namespace platoon
