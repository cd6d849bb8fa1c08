#include "stochastic_platoon/math/statistics/signal_reduction.hpp"

#include <algorithm>
#include <cstring>

#include "stochastic_platoon/math/statistics/dyadic_range.hpp"
#include "stochastic_platoon/math/statistics/lane_tree.hpp"

namespace platoon {

namespace detail {

namespace {

// The gap and the differences of order 1, 2 and 3 of one tile, and beside them the tracking error.
struct SignalValues {
  const double *predecessor, *y0, *y1, *y2, *y3;
  double offset, first_factor, second_factor, third_factor, error_offset, error_factor;
  double *errors, *gaps;

  PLATOON_INLINE FourLanes operator()(std::size_t j) const {
    const std::size_t r = 4 * j;
    Lanes ahead, own, one, two, three;
    load(predecessor + r, ahead);
    load(y0 + r, own);
    load(y1 + r, one);
    load(y2 + r, two);
    load(y3 + r, three);
    const Lanes apart = ahead - own, gap = apart - offset;
    const Lanes first = own - one, before = one - two, second = first - before,
                third = second - (before - (two - three));
    const Lanes error = (apart - error_offset) + error_factor * first;
    std::memcpy(errors + r, &error, sizeof error);
    std::memcpy(gaps + r, &gap, sizeof gap);
    return transposed(gap, first_factor * first, second_factor * second, third_factor * third);
  }
};

}  // namespace

// `signals`: those of order 0, 1, 2 and 3. All own positions must be given.
PLATOON_VECTOR_CLONES
FourNodes reduce_signal_tile(const std::array<Signal, kCellsAtOnce>& signals, const Signal& error,
                             const SignalPositions& positions, unsigned level, double* errors, double* gaps) {
  const Signal::Own<const double*>& own = positions.own;
  return reduce_tile_of_four(
      level, SignalValues{positions.predecessor, own[0], own[1], own[2], own[3], signals[0].offset, signals[1].factor,
                          signals[2].factor, signals[3].factor, error.offset, error.factor, errors, gaps});
}

}  // namespace detail

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// Whether a lane of the kernel computes it: the gap, or a difference of own positions.
bool has_lane(const Signal& signal) {
  return signal.relative == (signal.order == 0);
}

bool is_tracking_error(const Signal& signal) {
  return signal.relative && signal.order == 1;
}

void form(const Signal& signal, const SignalPositions& positions, std::size_t offset, std::size_t count,
          double* values) {
  const SignalPositions rest = positions.from(offset);
  signal(rest.predecessor, rest.own, count, values);
}

}  // namespace

std::vector<MomentNode> reduce_signal(std::uint64_t first_realization, const Signal& signal,
                                      const SignalPositions& positions, KeptMoments kept) {
  const auto values = [&](std::size_t offset, std::size_t size, double* buffer) {
    form(signal, positions, offset, size, buffer);
    return static_cast<const double*>(buffer);
  };
  return reduce_batch(first_realization, positions.count, values, kept);
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
    std::size_t& place = places[static_cast<std::size_t>(requested[s].order)];
    if (requested.size() > 1 && kept_ == KeptMoments::two && has_lane(requested[s]) && place == kNone) {
      place = s;
      together = true;
    } else {
      nodes_[s] = reduce_signal(first_realization_, requested[s], positions, kept_);
    }
  }
  FormedValues formed;
  if (together && is_tracking_error(signals.error)) formed.errors = values.errors;
  if (places[0] == 0) formed.first = values.first;
  if (together) reduce_together(signals, places, positions, formed);
  if (values.errors != formed.errors) form(signals.error, positions, 0, positions.count, values.errors);
  if (values.first != formed.first) form(requested.front(), positions, 0, positions.count, values.first);
  return nodes_;
}

void SignalReduction::reduce_together(const FollowerSignals& signals, const Places& places,
                                      const SignalPositions& positions, const FormedValues& values) {
  std::array<Signal, kCellsAtOnce> of_order{};
  for (std::size_t order = 0; order < kCellsAtOnce; ++order) {
    if (places[order] == kNone) continue;
    of_order[order] = signals.requested[places[order]];
    nodes_[places[order]].clear();
  }
  SignalPositions all = positions;
  for (const double*& own : all.own) own = own == nullptr ? all.own[0] : own;  // not used
  const auto tile = [&](std::size_t offset, unsigned level) {
    std::array<double, kMomentTile> unused;
    return detail::reduce_signal_tile(of_order, signals.error, all.from(offset), level,
                                      values.errors == nullptr ? unused.data() : values.errors + offset,
                                      values.first == nullptr ? unused.data() : values.first + offset);
  };
  std::size_t offset = 0;
  for (const DyadicRange& range : ranges_) {
    if (range.level >= kLowestLaneLevel) {
      const FourNodes found = reduce_four(offset, range.level, tile);
      for (std::size_t order = 0; order < kCellsAtOnce; ++order) {
        if (places[order] != kNone) nodes_[places[order]].push_back(found[order]);
      }
    } else {
      SignalPositions few = all.from(offset);
      few.count = range.size();
      if (values.errors != nullptr) form(signals.error, few, 0, few.count, values.errors + offset);
      if (values.first != nullptr) form(of_order[0], few, 0, few.count, values.first + offset);
      for (std::size_t order = 0; order < kCellsAtOnce; ++order) {
        if (places[order] != kNone)
          nodes_[places[order]].push_back(reduce_signal(range.first, of_order[order], few, kept_).front());
      }
    }
    offset += range.size();
  }
}

}  // namespace platoon
