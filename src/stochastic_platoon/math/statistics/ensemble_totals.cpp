#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"

#include <algorithm>
#include <utility>

#include "stochastic_platoon/math/statistics/error_averages.hpp"

namespace platoon {

std::size_t SignalCells::at(std::size_t kind, std::size_t follower, std::int64_t step) const {
  return kind * of_one_kind() + cell(follower, step, steps);
}

SignalCells signal_cells(const PlatoonModel& model, std::size_t followers, std::int64_t steps,
                         const std::vector<std::string>& signals) {
  const bool has_gap = std::find(signals.begin(), signals.end(), kGap) != signals.end();
  return {followers, steps, signals, has_gap ? gap_counting(model, followers) : GapCounting{}};
}

BatchTotals::BatchTotals(std::uint64_t first_realization, std::size_t count, const SignalCells& cells, KeptMoments kept)
    : moments(first_realization, count, cells.count(), kept), gaps(first_realization, count, cells.gaps.followers) {}

void EnsembleTotals::add(BatchTotals batch) {
  moments.add(std::move(batch.moments));
  gaps.add(batch.gaps);
}

void EnsembleTotals::merge(const EnsembleTotals& other) {
  moments.merge(other.moments);
  gaps.merge(other.gaps);
}

}  // namespace platoon
