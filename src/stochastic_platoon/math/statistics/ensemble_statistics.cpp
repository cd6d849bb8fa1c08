#include "stochastic_platoon/math/statistics/ensemble_statistics.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace platoon {

BatchMoments& EnsembleStatistics::open(std::uint64_t first_realization, std::size_t size) {
  return open_.try_emplace(first_realization, first_realization, size, table_.cells(), kept_).first->second;
}

void EnsembleStatistics::add(const ReducedErrors& errors) {
  open(errors.first_realization, errors.count).set(cell(errors.follower, errors.step, steps_), errors.nodes);
}

void EnsembleStatistics::commit(std::uint64_t first_realization) {
  const auto batch = open_.find(first_realization);
  if (batch == open_.end()) {
    throw std::invalid_argument("batch at realization " + std::to_string(first_realization) + ": must be open");
  }
  table_.add(std::move(batch->second));
  open_.erase(batch);
}

}  // namespace platoon
