#include "stochastic_platoon/math/statistics/ensemble_statistics.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace platoon {

void EnsembleStatistics::add(const ReducedSignals& signals) {
  const std::uint64_t first = signals.first_realization;
  BatchTotals& batch = open_.try_emplace(first, first, signals.count, cells_).first->second;
  for (std::size_t kind = 0; kind < signals.nodes.size(); ++kind)
    batch.moments.set(cells_.at(kind, signals.follower, signals.step), signals.nodes[kind]);
  if (!cells_.limits.empty()) batch.limits.add(signals.follower, signals.at_limits);
  if (!signals.gaps.empty()) batch.gaps.add(signals.follower, signals.step, signals.gaps.data());
}

void EnsembleStatistics::commit(std::uint64_t first_realization) {
  const auto batch = open_.find(first_realization);
  if (batch == open_.end()) {
    throw std::invalid_argument("batch at realization " + std::to_string(first_realization) + ": must be open");
  }
  totals_.add(std::move(batch->second));
  open_.erase(batch);
}

}  // namespace platoon
