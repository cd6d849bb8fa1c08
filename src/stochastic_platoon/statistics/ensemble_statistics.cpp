#include "stochastic_platoon/statistics/ensemble_statistics.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace platoon {

BatchMoments& EnsembleStatistics::open(std::uint64_t first_realization, std::size_t size) {
  const std::lock_guard<std::mutex> lock(opening_);
  return open_.try_emplace(first_realization, first_realization, size, table_.cells()).first->second;
}

void EnsembleStatistics::commit(std::uint64_t first_realization) {
  const std::lock_guard<std::mutex> lock(opening_);
  const auto batch = open_.find(first_realization);
  if (batch == open_.end()) {
    throw std::invalid_argument("batch at realization " + std::to_string(first_realization) +
                                ": must be open");
  }
  table_.add(std::move(batch->second));
  open_.erase(batch);
}

void EnsembleStatistics::discard_open() {
  const std::lock_guard<std::mutex> lock(opening_);
  open_.clear();
}

}  // namespace platoon
