#include "stochastic_platoon/statistics/ensemble_statistics.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace platoon {

void EnsembleStatistics::add(std::size_t follower, std::int64_t step, std::uint64_t first_realization,
                             const std::vector<double>& errors) {
  open(first_realization, errors.size())->set(cell(follower, step, steps_), errors.data());
}

std::shared_ptr<BatchMoments> EnsembleStatistics::open(std::uint64_t first_realization, std::size_t size) {
  const std::lock_guard<std::mutex> lock(opening_);
  std::shared_ptr<BatchMoments>& batch = open_[first_realization];
  if (!batch) batch = std::make_shared<BatchMoments>(first_realization, size, table_.cells());
  return batch;
}

void EnsembleStatistics::commit(std::uint64_t first_realization) {
  const std::lock_guard<std::mutex> lock(opening_);
  const auto batch = open_.find(first_realization);
  if (batch == open_.end()) {
    throw std::invalid_argument("batch at realization " + std::to_string(first_realization) +
                                ": must be open");
  }
  table_.add(std::move(*batch->second));
  open_.erase(batch);
}

void EnsembleStatistics::discard_open() {
  const std::lock_guard<std::mutex> lock(opening_);
  open_.clear();
}

}  // namespace platoon
