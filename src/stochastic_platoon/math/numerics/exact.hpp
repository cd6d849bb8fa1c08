#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

#include "stochastic_platoon/math/numerics/delta_form.hpp"

namespace platoon {

/// A number of 100 digits and of any size a double can have: sums of products of doubles are exact in it, or
/// so close that the double they are rounded to is the right one.
using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_100::backend_type,
                                            boost::multiprecision::et_off>;

/// Real polynomial by descending powers of z, or by ascending powers of s = z - 1 where that is said.
using ExactPolynomial = std::vector<Exact>;

/// N / D of T by powers of s, the leading coefficient of D being 1.
struct ExactFraction {
  ExactPolynomial numerator;
  ExactPolynomial denominator;
};

ExactPolynomial exact(const Polynomial& p);

/// p q, in whichever powers both are given.
ExactPolynomial multiply(const ExactPolynomial& p, const ExactPolynomial& q);

/// From descending powers of z to ascending powers of s.
ExactPolynomial shifted_to_one(ExactPolynomial p);

/// Rounded, coefficient by coefficient.
Polynomial rounded(const ExactPolynomial& p);
DeltaPolynomial rounded_delta(const ExactPolynomial& p);

}  // namespace platoon
