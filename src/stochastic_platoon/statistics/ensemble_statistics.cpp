#include "stochastic_platoon/statistics/ensemble_statistics.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace platoon {

void EnsembleStatistics::add(std::size_t follower, std::int64_t step, std::uint64_t first_realization,
                             const std::vector<double>& errors) {
  auto batch = open_.find(first_realization);
  if (batch == open_.end()) {
    batch = open_.emplace(first_realization, BatchMoments(first_realization, errors.size(), table_.cells()))
                .first;
  }
  batch->second.set(cell(follower, step, steps_), errors.data());
}

void EnsembleStatistics::commit(std::uint64_t first_realization) {
  const auto batch = open_.find(first_realization);
  if (batch == open_.end()) {
    throw std::invalid_argument("batch at realization " + std::to_string(first_realization) +
                                ": must be open");
  }
  table_.add(std::move(batch->second));
  open_.erase(batch);
}

}  // namespace platoon
