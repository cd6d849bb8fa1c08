#pragma once

#include <algorithm>
#include <complex>
#include <vector>

#include "stochastic_platoon/math/model/transfer_function.hpp"
#include "unit/zeros.hpp"

namespace platoon {

using Zeros = std::vector<std::complex<double>>;

inline TransferFunction fraction(double gain, const Zeros& zeros, const Zeros& poles) {
  return {gain * polynomial_with_zeros(zeros), polynomial_with_zeros(poles)};
}

/// The largest |f - g| / |g| over the unit circle.
inline double distance(const TransferFunction& f, const TransferFunction& g) {
  double largest = 0.0;
  for (int k = 0; k <= 200; ++k) {
    const std::complex<double> z = std::polar(1.0, 3.14159265358979 * k / 200.0);
    largest = std::max(largest, std::abs(f(z) - g(z)) / std::abs(g(z)));
  }
  return largest;
}

/// T = N/D with this D and the N that double integral action requires: N = D(1) + (D'(1) - h D(1)) (z - 1) +
/// (z - 1)^2 extra(z).
inline TransferFunction ramp_tracking(const Polynomial& d, double headway,
                                      const Polynomial& extra = Polynomial::Zero(1)) {
  const double value = d.sum();
  const double slope = derivative(d).sum() - headway * value;
  return {add(Eigen::Vector2d(slope, value - slope), multiply(Eigen::Vector3d(1.0, -2.0, 1.0), extra)), d};
}

}  // namespace platoon
