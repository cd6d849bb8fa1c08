#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/numerics/delta_form.hpp"

namespace platoon {

/// A number of 100 digits that covers the exponent range of double. Sums of products of doubles are exact, or accurate
/// enough to round to the correct double.
using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_100::backend_type,
                                            boost::multiprecision::et_off>;

/// Real polynomial by descending powers of z, or by ascending powers of s = z - 1 if stated.
using ExactPolynomial = std::vector<Exact>;

/// T = N / D by powers of s, with leading coefficient 1 in D.
struct ExactFraction {
  ExactPolynomial numerator;
  ExactPolynomial denominator;
};

ExactPolynomial exact(const Polynomial& p);

/// p q, by powers of z or of s, the same as both factors.
ExactPolynomial multiply(const ExactPolynomial& p, const ExactPolynomial& q);

ExactPolynomial add(ExactPolynomial p, const ExactPolynomial& q);

/// p z^count, by powers of s; p itself if count <= 0.
ExactPolynomial times_power_of_z(ExactPolynomial p, std::ptrdiff_t count);

/// Converts from descending powers of z to ascending powers of s.
ExactPolynomial shifted_to_one(ExactPolynomial p);

/// Converts back.
ExactPolynomial shifted_to_origin(ExactPolynomial p);

/// The polynomial with every coefficient rounded.
Polynomial rounded(const ExactPolynomial& p);
DeltaPolynomial rounded_delta(const ExactPolynomial& p);

}  // namespace platoon
