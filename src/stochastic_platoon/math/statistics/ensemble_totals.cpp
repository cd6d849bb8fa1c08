#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"

#include <algorithm>
#include <utility>

#include "stochastic_platoon/math/model/signal.hpp"

namespace platoon {

std::size_t SignalCells::at(std::size_t kind, std::size_t follower, std::int64_t step) const {
  return kind * of_one_kind() + cell(follower, step, steps);
}

SignalCells signal_cells(const PlatoonModel& model, std::size_t followers, std::int64_t steps,
                         const std::vector<std::string>& signals) {
  const bool has_gap = std::find(signals.begin(), signals.end(), kGap) != signals.end();
  return {followers,
          steps,
          signals,
          has_gap ? gap_counting(model, followers) : GapCounting{},
          has_normal_errors(model) ? KeptMoments::two : KeptMoments::four,
          counted_limits(model, followers)};
}

BatchTotals::BatchTotals(std::uint64_t first_realization, std::size_t count, const SignalCells& cells)
    : moments(first_realization, count, cells.count(), cells.kept),
      gaps(first_realization, count, cells.gaps.followers),
      limits(cells.limits.size()),
      cells_(cells),
      reduction_(first_realization, count, cells.kept) {}

void BatchTotals::add(std::size_t follower, std::int64_t step, const FollowerSignals& signals,
                      const SignalPositions& positions) {
  AlignedValues& errors = errors_[waiting_.size()];
  errors.resize(positions.count);
  FormedValues values;
  values.errors = errors.data();
  if (cells_.has_gap()) values.smallest = gaps.lowered(follower);
  const std::vector<std::vector<MomentNode>>& nodes = reduction_.reduce(signals, positions, values);
  for (std::size_t s = 0; s < nodes.size(); ++s) moments.set(cells_.at(1 + s, follower, step), nodes[s]);
  if (cells_.has_gap()) gaps.lowered_to(follower, step, reduction_.least());
  if (!cells_.limits.empty()) limits.add(follower, count_at_limits(cells_.limits[follower - 1], positions));
  waiting_.push_back({cells_.at(0, follower, step), errors.data()});
  if (waiting_.size() == kCellsAtOnce) finish();
}

void BatchTotals::finish() {
  moments.set(waiting_);
  waiting_.clear();
}

void EnsembleTotals::add(BatchTotals batch) {
  moments.add(std::move(batch.moments));
  gaps.add(batch.gaps);
  limits.merge(batch.limits);
}

void EnsembleTotals::merge(const EnsembleTotals& other) {
  moments.merge(other.moments);
  gaps.merge(other.gaps);
  limits.merge(other.limits);
}

}  // namespace platoon
