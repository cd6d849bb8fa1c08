#include "stochastic_platoon/math/rare/weighted_choice.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace platoon {

WeightedChoice::WeightedChoice(std::vector<double> log_weights) : log_weights_(std::move(log_weights)) {
  const double most = log_weights_[largest()];
  double sum = 0.0;
  for (const double value : log_weights_) {
    if (value > -std::numeric_limits<double>::infinity()) sum += std::exp(value - most);
    cumulative_.push_back(sum);
  }
  for (double& value : cumulative_) value /= sum;
  log_sum_ = most + std::log(sum);
}

std::size_t WeightedChoice::largest() const {
  return static_cast<std::size_t>(std::max_element(log_weights_.begin(), log_weights_.end()) - log_weights_.begin());
}

std::size_t WeightedChoice::operator()(double uniform) const {
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), uniform);
  return static_cast<std::size_t>(std::min(found, std::prev(cumulative_.end())) - cumulative_.begin());
}

}  // namespace platoon
