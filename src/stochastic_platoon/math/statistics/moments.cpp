#include "stochastic_platoon/math/statistics/moments.hpp"

#include <cmath>

#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

double Moments::variance() const {
  if (count < 2) return kNaN;
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
  const double a = n_left / n, b = n_right / n;  // their shares
  const double square = shift * shift;
  return {left.count + right.count, left.mean + shift * (n_right / n),
          left.squared_deviations + right.squared_deviations + shift * shift * (n_left * n_right / n),
          left.cubed_deviations + right.cubed_deviations + square * shift * (n_left * b) * (a - b) +
              3.0 * shift * (a * right.squared_deviations - b * left.squared_deviations),
          left.fourth_deviations + right.fourth_deviations + square * square * (n_left * b) * (a * a - a * b + b * b) +
              6.0 * square * (a * a * right.squared_deviations + b * b * left.squared_deviations) +
              4.0 * shift * (a * right.cubed_deviations - b * left.cubed_deviations)};
}

double standard_error_of_mean(double variance, std::uint64_t count, double share) {
  return std::sqrt(variance / (static_cast<double>(count) * share));
}

double standard_error_of_variance(double variance, std::uint64_t count, double share) {
  if (count < 2) return kNaN;
  return variance * std::sqrt(2.0 / (static_cast<double>(count - 1) * share));
}

double standard_error_of_variance(const Moments& measured) {
  const auto n = static_cast<double>(measured.count);
  if (measured.count < 2) return kNaN;
  const double variance = measured.variance();
  return std::sqrt((measured.fourth_deviations / n - variance * variance * ((n - 3.0) / (n - 1.0))) / n);
}

}  // namespace platoon
