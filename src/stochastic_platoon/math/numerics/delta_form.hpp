#pragma once

#include <complex>
#include <vector>

#include "stochastic_platoon/math/numerics/polynomial.hpp"

namespace platoon {

/// Real polynomial by ascending powers of s = z - 1, p[0] + p[1] s + ...: the Taylor coefficients about z
/// = 1.
///
/// Poles and zeros of a vehicle that is sampled fast, or that keeps a long headway, lie close to z = 1, where
/// powers of z cancel: the digits of such a loop are in this form (R. H. Middleton and G. C. Goodwin, Digital
/// Control and Estimation: A Unified Approach, 1990, call s the delta operator). Extended precision.
using DeltaPolynomial = std::vector<long double>;

/// N / D of T by powers of s, the leading coefficient of D being 1.
struct DeltaFraction {
  DeltaPolynomial numerator;
  DeltaPolynomial denominator;
};

/// p by powers of s, exactly but for the rounding of the result.
DeltaPolynomial delta_form(const Polynomial& p);

/// p by powers of z, rounded to double.
Polynomial z_form(const DeltaPolynomial& p);

/// The zeros of p in s, to the accuracy that p's coefficients determine them with; none for a constant. By
/// simultaneous iteration (O. Aberth, Math. Comp. 27, 1973) from the eigenvalues of the companion matrix.
std::vector<std::complex<long double>> zeros(const DeltaPolynomial& p);

/// The largest modulus of z = 1 + s over the zeros of p; 0 for a constant.
double spectral_radius(const DeltaPolynomial& p);

/// |1 + s| - 1, without cancellation for small s.
long double modulus_minus_one(std::complex<long double> s);

}  // namespace platoon
