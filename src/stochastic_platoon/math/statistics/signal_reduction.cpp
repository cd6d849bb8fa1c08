#include "stochastic_platoon/math/statistics/signal_reduction.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/statistics/dyadic_range.hpp"
#include "stochastic_platoon/math/statistics/lane_tree.hpp"
#include "stochastic_platoon/math/statistics/smallest_gaps.hpp"

namespace platoon {

namespace detail {

namespace {

// Inputs and outputs of a kernel, for all realizations of a batch.
struct SignalTiles {
  std::array<const Signal*, kCellsAtOnce> of_order;  // the signals of order 0, 1, 2 and 3
  const Signal* error;
  const double* predecessor;
  Signal::Recent<const double*> own;
  double *errors, *smallest;
};

// The least value in each lane: a kernel of wide lanes has narrow ones in a tile of few realizations.
struct LeastOf {
  Lanes narrow;
  WideLanes wide;

  PLATOON_INLINE Lanes& of(const Lanes&) { return narrow; }
  PLATOON_INLINE WideLanes& of(const WideLanes&) { return wide; }
};

// The gap and the differences of order 1, 2 and 3 of one tile; stores the tracking errors, and lowers `smallest` and
// `least` to the gaps.
struct SignalValues {
  const double *predecessor, *y0, *y1, *y2, *y3;
  double offset, first_factor, second_factor, third_factor, error_offset, error_factor;
  double *errors, *smallest;
  LeastOf* least;

  template <class Vector>
  PLATOON_INLINE FourOf<Vector> operator()(std::size_t j, const Vector&) const {
    const std::size_t r = sizeof(Vector) / sizeof(double) * j;
    Vector ahead, own, one, two, three;
    load(predecessor + r, ahead);
    load(y0 + r, own);
    load(y1 + r, one);
    load(y2 + r, two);
    load(y3 + r, three);
    const Vector apart = ahead - own, gap = apart - offset;
    const Vector first = own - one, before = one - two, second = first - before,
                 third = second - (before - (two - three));
    const Vector error = (apart - error_offset) + error_factor * first;
    std::memcpy(errors + r, &error, sizeof error);
    lower_lanes(gap, smallest + r, least->of(gap));
    return transposed(gap, first_factor * first, second_factor * second, third_factor * third);
  }
};

template <class Vector>
PLATOON_INLINE FourNodes reduce_signals(const SignalTiles& tiles, std::size_t offset, unsigned level, double& least) {
  const Signal::Recent<const double*>& own = tiles.own;
  const auto& of = tiles.of_order;
  LeastOf of_lanes{Lanes{} + least, WideLanes{} + least};
  const FourNodes nodes = reduce_tile_of_four<Vector>(
      level,
      SignalValues{tiles.predecessor + offset, own[0] + offset, own[1] + offset, own[2] + offset, own[3] + offset,
                   of[0]->offset, of[1]->own.factor, of[2]->own.factor, of[3]->own.factor, tiles.error->offset,
                   tiles.error->own.factor, tiles.errors + offset, tiles.smallest + offset, &of_lanes});
  for (std::size_t lane = 0; lane < kCellsAtOnce; ++lane) least = std::min(least, of_lanes.narrow[lane]);
  for (std::size_t lane = 0; lane < 2 * kCellsAtOnce; ++lane) least = std::min(least, of_lanes.wide[lane]);
  return nodes;
}

// The four quarters of a follower's realizations, which take the places of four cells.
struct Quarters {
  const Signal* error;
  SignalPositions positions;
  std::size_t size;  // of a quarter
};

// The tracking errors of a tile in every quarter.
struct ErrorsOfQuarters {
  const double *predecessor, *y0, *y1;
  double offset, factor;
  std::size_t size;

  template <class Vector>
  PLATOON_INLINE void form(std::size_t r, Vector& error) const {
    Vector ahead, own, one;
    load(predecessor + r, ahead);
    load(y0 + r, own);
    load(y1 + r, one);
    error = ((ahead - own) - offset) + factor * (own - one);
  }

  template <class Vector>
  PLATOON_INLINE FourOf<Vector> operator()(std::size_t j, const Vector&) const {
    const std::size_t r = sizeof(Vector) / sizeof(double) * j;
    Vector a, b, c, d;
    form(r, a);
    form(r + size, b);
    form(r + 2 * size, c);
    form(r + 3 * size, d);
    return transposed(a, b, c, d);
  }
};

template <class Vector>
PLATOON_INLINE FourNodes reduce_errors(const Quarters& quarters, std::size_t offset, unsigned level) {
  const SignalPositions& of = quarters.positions;
  return reduce_tile_of_four<Vector>(
      level, ErrorsOfQuarters{of.ahead[0] + offset, of.own[0] + offset, of.own[1] + offset, quarters.error->offset,
                              quarters.error->own.factor, quarters.size});
}

}  // namespace

PLATOON_VECTOR_CLONES
FourNodes reduce_error_tile(const Quarters& quarters, std::size_t offset, unsigned level) {
  return reduce_errors<Lanes>(quarters, offset, level);
}

PLATOON_VECTOR_CLONES
FourNodes reduce_signal_tile(const SignalTiles& tiles, std::size_t offset, unsigned level, double& least) {
  return reduce_signals<Lanes>(tiles, offset, level, least);
}

#ifdef PLATOON_WIDE
PLATOON_WIDE
FourNodes reduce_wide_error_tile(const Quarters& quarters, std::size_t offset, unsigned level) {
  return reduce_errors<WideLanes>(quarters, offset, level);
}

PLATOON_WIDE
FourNodes reduce_wide_signal_tile(const SignalTiles& tiles, std::size_t offset, unsigned level, double& least) {
  return reduce_signals<WideLanes>(tiles, offset, level, least);
}
#else
constexpr auto reduce_wide_error_tile = reduce_error_tile;
constexpr auto reduce_wide_signal_tile = reduce_signal_tile;
#endif

}  // namespace detail

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// Whether a lane of the kernel computes the signal: the gap, or a difference of own positions.
bool has_lane(const Signal& signal) {
  return signal.own.order > 0 ? !signal.is_relative() : signal.of_distance() == 1.0;
}

bool is_tracking_error(const Signal& signal) {
  return signal.of_distance() == 1.0 && signal.own.order == 1;
}

void form(const Signal& signal, const SignalPositions& positions, std::size_t offset, std::size_t count,
          double* values) {
  SignalPositions rest = positions.from(offset);
  rest.count = count;
  rest.form(signal, values);
}

MomentNode joined_nodes(const MomentNode& left, const MomentNode& right, double half_count) {
  MomentNode joined;
  merge_equal(left.mean, left.squared_deviations, right.mean, right.squared_deviations, half_count, &joined.mean,
              &joined.squared_deviations);
  return joined;
}

// The node of 2^level tracking errors, level at least kLowestLaneLevel + 2: the nodes of its quarters, joined.
MomentNode reduce_error(const Signal& error, const SignalPositions& positions, unsigned level) {
  const detail::Quarters quarters{&error, positions, std::size_t{1} << (level - 2)};
  const bool wide = has_wide_lanes();
  const FourNodes nodes = reduce_four(0, level - 2, [&](std::size_t offset, unsigned tile_level) {
    return wide ? detail::reduce_wide_error_tile(quarters, offset, tile_level)
                : detail::reduce_error_tile(quarters, offset, tile_level);
  });
  const double half_count = 0.5 * static_cast<double>(quarters.size);
  return joined_nodes(joined_nodes(nodes[0], nodes[1], half_count), joined_nodes(nodes[2], nodes[3], half_count),
                      2.0 * half_count);
}

}  // namespace

std::vector<MomentNode> reduce_signal(std::uint64_t first_realization, const Signal& signal,
                                      const SignalPositions& positions, KeptMoments kept) {
  const bool in_quarters = is_tracking_error(signal) && kept == KeptMoments::two;
  std::vector<MomentNode> nodes;
  std::size_t offset = 0;
  for (const DyadicRange& range : dyadic_cover(first_realization, positions.count)) {
    const SignalPositions here = positions.from(offset);
    const auto values = [&](std::size_t from, std::size_t size, double* buffer) {
      form(signal, here, from, size, buffer);
      return static_cast<const double*>(buffer);
    };
    nodes.push_back(in_quarters && range.level >= kLowestLaneLevel + 2
                        ? reduce_error(signal, here, range.level)
                        : reduce_batch(range.first, range.size(), values, kept).front());
    offset += range.size();
  }
  return nodes;
}

SignalReduction::SignalReduction(std::uint64_t first_realization, std::size_t count, KeptMoments kept)
    : first_realization_(first_realization), ranges_(dyadic_cover(first_realization, count)), kept_(kept) {}

const std::vector<std::vector<MomentNode>>& SignalReduction::reduce(const FollowerSignals& signals,
                                                                    const SignalPositions& positions,
                                                                    const FormedValues& values) {
  const std::vector<Signal>& requested = signals.requested;
  nodes_.resize(requested.size());
  Places places;
  places.fill(kNone);
  bool together = false;
  for (std::size_t s = 0; s < requested.size(); ++s) {
    std::size_t& place = places[static_cast<std::size_t>(requested[s].own.order)];
    if (requested.size() > 1 && kept_ == KeptMoments::two && has_lane(requested[s]) && place == kNone) {
      place = s;
      together = true;
    } else {
      nodes_[s] = reduce_signal(first_realization_, requested[s], positions, kept_);
    }
  }
  least_ = std::numeric_limits<double>::infinity();
  FormedValues formed;
  if (together && is_tracking_error(signals.error)) formed.errors = values.errors;
  if (places[0] == 0) formed.smallest = values.smallest;
  if (together) reduce_together(signals, places, positions, formed);
  if (values.errors != formed.errors) form(signals.error, positions, 0, positions.count, values.errors);
  if (values.smallest != formed.smallest) lower(requested.front(), positions, values.smallest);
  return nodes_;
}

void SignalReduction::lower(const Signal& signal, const SignalPositions& positions, double* smallest) {
  first_values_.resize(positions.count);
  form(signal, positions, 0, positions.count, first_values_.data());
  least_ = std::min(least_, keep_smaller(first_values_.data(), positions.count, smallest));
}

void SignalReduction::reduce_together(const FollowerSignals& signals, const Places& places,
                                      const SignalPositions& positions, const FormedValues& values) {
  if (values.errors == nullptr || values.smallest == nullptr) unused_.resize(positions.count);
  detail::SignalTiles tiles{{},
                            &signals.error,
                            positions.ahead[0],
                            positions.own,
                            values.errors == nullptr ? unused_.data() : values.errors,
                            values.smallest == nullptr ? unused_.data() : values.smallest};
  for (std::size_t order = 0; order < kCellsAtOnce; ++order) {
    const bool is_requested = places[order] != kNone;
    tiles.of_order[order] = is_requested ? &signals.requested[places[order]] : &signals.error;
    if (is_requested) nodes_[places[order]].clear();
    if (tiles.own[order] == nullptr) tiles.own[order] = tiles.own[0];
  }
  const bool wide = has_wide_lanes();
  double least = std::numeric_limits<double>::infinity();
  const auto tile = [&](std::size_t offset, unsigned level) {
    return wide ? detail::reduce_wide_signal_tile(tiles, offset, level, least)
                : detail::reduce_signal_tile(tiles, offset, level, least);
  };
  std::size_t offset = 0;
  for (const DyadicRange& range : ranges_) {
    if (range.level >= kLowestLaneLevel) {
      const FourNodes found = reduce_four(offset, range.level, tile);
      for (std::size_t order = 0; order < kCellsAtOnce; ++order) {
        if (places[order] != kNone) nodes_[places[order]].push_back(found[order]);
      }
    } else {
      SignalPositions few = positions.from(offset);
      few.count = range.size();
      if (values.errors != nullptr) form(signals.error, few, 0, few.count, values.errors + offset);
      if (values.smallest != nullptr) lower(*tiles.of_order[0], few, values.smallest + offset);
      for (std::size_t order = 0; order < kCellsAtOnce; ++order) {
        if (places[order] != kNone)
          nodes_[places[order]].push_back(reduce_signal(range.first, *tiles.of_order[order], few, kept_).front());
      }
    }
    offset += range.size();
  }
  if (values.smallest != nullptr) least_ = std::min(least_, least);
}

}  // namespace platoon
