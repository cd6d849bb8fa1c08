#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/numerics/exact.hpp"

namespace platoon {

/// The zeros s of a(s) (1 + s)^delay + b(s), whose first term has the higher degree: the closed-loop poles with an
/// input delay. Expanded in powers of s, the sum loses a digit for every two or three steps of delay; here both terms
/// are evaluated as they stand. Simultaneous iteration (O. Aberth, Math. Comp. 27, 1973) in extended precision.
std::vector<std::complex<long double>> zeros_behind_delay(const ExactPolynomial& a, std::size_t delay,
                                                          const ExactPolynomial& b);

}  // namespace platoon
