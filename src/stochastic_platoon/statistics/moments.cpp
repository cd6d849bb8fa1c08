#include "stochastic_platoon/statistics/moments.hpp"

#include <cmath>
#include <limits>

namespace platoon {

double Moments::variance() const {
  if (count < 2) return std::numeric_limits<double>::quiet_NaN();
  return squared_deviations / static_cast<double>(count - 1);
}

void Moments::add(double value) {
  ++count;
  const double deviation = value - mean;
  mean += deviation / static_cast<double>(count);
  squared_deviations += deviation * (value - mean);
}

Moments merge(const Moments& left, const Moments& right) {
  if (left.count == 0) return right;
  if (right.count == 0) return left;
  const auto n_left = static_cast<double>(left.count);
  const auto n_right = static_cast<double>(right.count);
  const double n = n_left + n_right;
  const double shift = right.mean - left.mean;
  return {left.count + right.count, left.mean + shift * (n_right / n),
          left.squared_deviations + right.squared_deviations + shift * shift * (n_left * n_right / n)};
}

double standard_error_of_mean(double variance, std::uint64_t count) {
  return std::sqrt(variance / static_cast<double>(count));
}

double standard_error_of_variance(double variance, std::uint64_t count) {
  if (count < 2) return std::numeric_limits<double>::quiet_NaN();
  return variance * std::sqrt(2.0 / static_cast<double>(count - 1));
}

}  // namespace platoon
