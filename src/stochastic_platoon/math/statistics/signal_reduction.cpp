#include "stochastic_platoon/math/statistics/signal_reduction.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "stochastic_platoon/math/statistics/dyadic_range.hpp"
#include "stochastic_platoon/math/statistics/lane_tree.hpp"

namespace platoon {

using FourSignals = std::array<Signal, kCellsAtOnce>;
using FourNodes = std::array<MomentNode, kCellsAtOnce>;

namespace detail {

// From one vector per signal to one per realization.
PLATOON_INLINE void transpose(const std::array<Lanes, 4>& v, std::array<Lanes, 4>& x) {
#ifdef __clang__
  const Lanes even_ab = __builtin_shufflevector(v[0], v[1], 0, 4, 2, 6),
              odd_ab = __builtin_shufflevector(v[0], v[1], 1, 5, 3, 7),
              even_cd = __builtin_shufflevector(v[2], v[3], 0, 4, 2, 6),
              odd_cd = __builtin_shufflevector(v[2], v[3], 1, 5, 3, 7);
  x[0] = __builtin_shufflevector(even_ab, even_cd, 0, 1, 4, 5);
  x[1] = __builtin_shufflevector(odd_ab, odd_cd, 0, 1, 4, 5);
  x[2] = __builtin_shufflevector(even_ab, even_cd, 2, 3, 6, 7);
  x[3] = __builtin_shufflevector(odd_ab, odd_cd, 2, 3, 6, 7);
#else
  using Places = long long __attribute__((vector_size(32)));
  const Lanes even_ab = __builtin_shuffle(v[0], v[1], Places{0, 4, 2, 6}),
              odd_ab = __builtin_shuffle(v[0], v[1], Places{1, 5, 3, 7}),
              even_cd = __builtin_shuffle(v[2], v[3], Places{0, 4, 2, 6}),
              odd_cd = __builtin_shuffle(v[2], v[3], Places{1, 5, 3, 7});
  x[0] = __builtin_shuffle(even_ab, even_cd, Places{0, 1, 4, 5});
  x[1] = __builtin_shuffle(odd_ab, odd_cd, Places{0, 1, 4, 5});
  x[2] = __builtin_shuffle(even_ab, even_cd, Places{2, 3, 6, 7});
  x[3] = __builtin_shuffle(odd_ab, odd_cd, Places{2, 3, 6, 7});
#endif
}

PLATOON_INLINE void load(const double* values, Lanes& lanes) {
  std::memcpy(&lanes, values, sizeof lanes);
}

// Tiles of 2^level realizations, level >= LaneTree::kLowestLevel. All steps of own positions must be given.
PLATOON_VECTOR_CLONES
void reduce_signal_tiles(const FourSignals& signals, const SignalPositions& positions, unsigned level,
                         double* first_values, FourNodes& nodes) {
  LaneTree tree;
  const std::size_t count = (std::size_t{1} << level) / 4;
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t r = 4 * j;
    Lanes predecessor, y0, y1, y2, y3;
    load(positions.predecessor + r, predecessor);
    load(positions.own[0] + r, y0);
    load(positions.own[1] + r, y1);
    load(positions.own[2] + r, y2);
    load(positions.own[3] + r, y3);
    const Lanes apart = predecessor - y0, first = y0 - y1, first_before = y1 - y2, second = first - first_before,
                third = second - (first_before - (y2 - y3));
    std::array<Lanes, 4> v, x;
    for (std::size_t s = 0; s < kCellsAtOnce; ++s) {
      const Signal& signal = signals[s];
      const Lanes difference = signal.order == 1 ? first : signal.order == 2 ? second : third;
      if (signal.order == 0) {
        v[s] = apart - signal.offset;
      } else if (signal.relative) {
        v[s] = (apart - signal.offset) + signal.factor * difference;
      } else {
        v[s] = signal.factor * difference;
      }
    }
    if (first_values != nullptr) std::memcpy(first_values + r, &v[0], sizeof v[0]);
    transpose(v, x);
    tree.join_values(j, x);
  }
  tree.join_nodes(count);
  for (std::size_t s = 0; s < kCellsAtOnce; ++s) nodes[s] = tree.root(s);
}

}  // namespace detail

namespace {

FourNodes reduce(const FourSignals& signals, const SignalPositions& positions, unsigned level, double* first_values) {
  FourNodes nodes;
  if (level <= kMomentTileLevel) {
    detail::reduce_signal_tiles(signals, positions, level, first_values, nodes);
    return nodes;
  }
  const std::size_t half = std::size_t{1} << (level - 1);
  const FourNodes left = reduce(signals, positions, level - 1, first_values);
  const FourNodes right =
      reduce(signals, positions.from(half), level - 1, first_values == nullptr ? nullptr : first_values + half);
  for (std::size_t s = 0; s < kCellsAtOnce; ++s) {
    merge_equal(left[s].mean, left[s].squared_deviations, right[s].mean, right[s].squared_deviations,
                0.5 * static_cast<double>(half), &nodes[s].mean, &nodes[s].squared_deviations);
  }
  return nodes;
}

std::vector<MomentNode> reduce_one(std::uint64_t first_realization, const Signal& signal,
                                   const SignalPositions& positions, KeptMoments kept, double* all_values) {
  const auto values = [&](std::size_t offset, std::size_t size, double* buffer) {
    double* const to = all_values != nullptr ? all_values + offset : buffer;
    const SignalPositions rest = positions.from(offset);
    signal(rest.predecessor, rest.own, size, to);
    return static_cast<const double*>(to);
  };
  return reduce_batch(first_realization, positions.count, values, kept);
}

// Where two to four signals share their loads; small ranges one by one.
void reduce_together(std::uint64_t first_realization, const Signal* signals, std::size_t size,
                     const SignalPositions& positions, double* first_values,
                     std::vector<std::vector<MomentNode>>& nodes) {
  FourSignals four;
  for (std::size_t s = 0; s < kCellsAtOnce; ++s) four[s] = signals[std::min(s, size - 1)];
  SignalPositions rest = positions;
  for (const double*& own : rest.own) own = own == nullptr ? rest.own[0] : own;  // not used
  const std::size_t first = nodes.size();
  nodes.resize(first + size);
  for (const DyadicRange& range : dyadic_cover(first_realization, positions.count)) {
    double* const values = first_values == nullptr ? nullptr : first_values + (positions.count - rest.count);
    if (range.level >= LaneTree::kLowestLevel) {
      const FourNodes found = reduce(four, rest, range.level, values);
      for (std::size_t s = 0; s < size; ++s) nodes[first + s].push_back(found[s]);
    } else {
      SignalPositions few = rest;
      few.count = range.size();
      for (std::size_t s = 0; s < size; ++s)
        nodes[first + s].push_back(
            reduce_one(range.first, signals[s], few, KeptMoments::two, s == 0 ? values : nullptr).front());
    }
    rest = rest.from(range.size());
  }
}

}  // namespace

std::vector<std::vector<MomentNode>> reduce_signals(std::uint64_t first_realization, const std::vector<Signal>& signals,
                                                    const SignalPositions& positions, KeptMoments kept,
                                                    double* first_values) {
  std::vector<std::vector<MomentNode>> nodes;
  for (std::size_t s = 0; s < signals.size();) {
    double* const values = s == 0 ? first_values : nullptr;
    const std::size_t size = std::min(kCellsAtOnce, signals.size() - s);
    if (size > 1 && kept == KeptMoments::two) {
      reduce_together(first_realization, &signals[s], size, positions, values, nodes);
      s += size;
    } else {
      nodes.push_back(reduce_one(first_realization, signals[s++], positions, kept, values));
    }
  }
  return nodes;
}

}  // namespace platoon
