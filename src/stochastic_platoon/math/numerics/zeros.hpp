#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/numerics/exact.hpp"

namespace platoon {

/// The zeros s of p, by ascending powers of s = z - 1, with multiplicity; none for a constant. The sizes of the zeros
/// may differ by any factor: each is accurate to 1e-15 of its own modulus, or as the digits of a multiple zero allow.
/// Conjugates follow each other; a zero whose conjugate is itself is real.
///
/// Simultaneous iteration (O. Aberth, Math. Comp. 27, 1973) in extended precision from starts on the Newton polygon of
/// the coefficients (D. A. Bini, Numer. Algorithms 13, 1996), continued in a hundred digits for zeros that extended
/// precision does not resolve. `rounding`: relative error of the coefficients, to which p counts as divisible by 1 + s.
std::vector<std::complex<long double>> zeros(const ExactPolynomial& p, long double rounding = 1e-90L);

/// The zeros s of a(s) (1 + s)^delay + b(s), whose first term has the higher degree: the closed-loop poles with an
/// input delay. Expanded in powers of s, the sum loses a digit for every two or three steps of delay; here both terms
/// are evaluated as they stand, in extended precision.
std::vector<std::complex<long double>> zeros_behind_delay(const ExactPolynomial& a, std::size_t delay,
                                                          const ExactPolynomial& b);

}  // namespace platoon
