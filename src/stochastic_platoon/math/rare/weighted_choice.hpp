#pragma once

#include <cstddef>
#include <vector>

namespace platoon {

/// A choice with probabilities in proportion to weights, which may be below the range of double.
class WeightedChoice {
public:
  /// Natural logarithms of the weights; -infinity for 0.
  explicit WeightedChoice(std::vector<double> log_weights);

  const std::vector<double>& log_weights() const { return log_weights_; }

  /// ln of the sum of all weights.
  double log_sum() const { return log_sum_; }

  /// Index of the largest weight.
  std::size_t largest() const;

  /// The index that belongs to a uniform value in [0, 1).
  std::size_t operator()(double uniform) const;

private:
  std::vector<double> log_weights_, cumulative_;
  double log_sum_;
};

}  // namespace platoon
