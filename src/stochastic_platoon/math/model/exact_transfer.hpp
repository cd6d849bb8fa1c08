#pragma once

#include <cstddef>

#include "stochastic_platoon/math/model/transfer_function.hpp"
#include "stochastic_platoon/math/numerics/exact.hpp"

namespace platoon {

/// n(s) / d(s) z^-delay with s = z - 1, to a hundred digits. Neither n nor d is zero at z = 0; d has leading
/// coefficient 1. A negative delay stands for zeros at z = 0.
struct ExactTransfer {
  ExactPolynomial numerator;
  ExactPolynomial denominator;
  std::ptrdiff_t delay = 0;

  /// Number of poles at z = 1 minus number of zeros there.
  int integrators() const;
};

/// The fraction with the coefficients of the given doubles. Poles that are at z = 1 to the rounding of the coefficients
/// are placed there exactly.
ExactTransfer exact_transfer(const TransferFunction& fraction);

/// The exact zero-order hold equivalent of N(s) / D(s) with an input delay; see Plant.
ExactTransfer zero_order_hold(const Polynomial& numerator, const Polynomial& denominator, double input_delay,
                              double sample_period);

}  // namespace platoon
