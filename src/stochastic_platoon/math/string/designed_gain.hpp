#pragma once

#include <complex>
#include <cstddef>

#include "stochastic_platoon/math/model/loop_design.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

namespace platoon {

/// T on the unit circle from plant and controller. With W = 1 / (G K) and H = (1 + h) - h / z, 1 / T = H (1 + W) behind
/// a headway filter and H + W without one (paper, section 3). Coefficients of T by powers of z - 1 lose a digit for
/// every two or three steps of input delay; here the delay stays a power of z, and the double integrators of G K make W
/// small where |T| is near 1.
class DesignedGain {
public:
  DesignedGain(const LoopDesign& design, double headway);

  struct Value {
    std::complex<long double> transfer;  ///< T
    long double excess;                  ///< |1/T|^2 - 1, without cancellation near w = 0; infinite where T = 0
  };
  Value at(const CirclePoint& point) const;

private:
  CirclePolynomial numerator_, denominator_;  ///< G K = numerator / denominator z^-delay, by powers of z - 1
  std::ptrdiff_t delay_;
  bool filtered_;
  long double headway_;
};

}  // namespace platoon
