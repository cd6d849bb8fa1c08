#pragma once

#include <Eigen/Dense>
#include <complex>
#include <vector>

namespace platoon {

/// Real polynomial in z by descending powers: p(z) = p(0) z^n + ... + p(n), as in the model file.
using Polynomial = Eigen::VectorXd;

/// p without its leading zero coefficients; the zero polynomial is [0]. Throws std::invalid_argument if p is empty or
/// has a coefficient that is not finite.
Polynomial trimmed(const Polynomial& p);

/// p(z) q(z).
Polynomial multiply(const Polynomial& p, const Polynomial& q);

/// p(z) + q(z).
Polynomial add(const Polynomial& p, const Polynomial& q);

/// dp/dz.
Polynomial derivative(const Polynomial& p);

/// p(z) by Horner's rule.
std::complex<double> evaluate(const Polynomial& p, std::complex<double> z);

/// The zeros of p, as eigenvalues of its companion matrix; none for a constant.
std::vector<std::complex<double>> roots(const Polynomial& p);

/// Number of zeros of p at z = 1, from the number of derivatives that vanish there. A value counts as zero if it is
/// within 1e-9 of the sum of the moduli of its terms.
int multiplicity_at_one(const Polynomial& p);

}  // namespace platoon
