#pragma once

#include <complex>
#include <vector>

#include "stochastic_platoon/math/numerics/polynomial.hpp"

namespace platoon {

/// Real polynomial by ascending powers of s = z - 1, p[0] + p[1] s + ...: the Taylor coefficients about z = 1.
///
/// The poles and zeros of a vehicle with fast sampling or a long headway lie close to z = 1, where powers of z cancel;
/// this form keeps their digits. (R. H. Middleton and G. C. Goodwin, Digital Control and Estimation: A Unified
/// Approach, 1990, call s the delta operator.) Extended precision.
using DeltaPolynomial = std::vector<long double>;

/// T = N / D by powers of s, with leading coefficient 1 in D.
struct DeltaFraction {
  DeltaPolynomial numerator;
  DeltaPolynomial denominator;
};

/// p by powers of s; only the result is rounded.
DeltaPolynomial delta_form(const Polynomial& p);

/// p by powers of z, rounded to double.
Polynomial z_form(const DeltaPolynomial& p);

/// The zeros of p in s, as accurate as the coefficients of p determine them (numerics/zeros.hpp); none for a constant.
std::vector<std::complex<long double>> zeros(const DeltaPolynomial& p);

/// The largest modulus of z = 1 + s over the zeros of p; 0 for a constant.
double spectral_radius(const DeltaPolynomial& p);

/// The same over given zeros s; 0 for none.
double spectral_radius(const std::vector<std::complex<long double>>& places);

/// |1 + s| - 1, without cancellation for small s.
long double modulus_minus_one(std::complex<long double> s);

/// The complex frequencies w = -j ln(1 + s) of poles or zeros s; none for one at z = 0. A spectrum is singular at those
/// of its poles.
std::vector<std::complex<double>> frequencies_of(const std::vector<std::complex<long double>>& places);

}  // namespace platoon
