#include "stochastic_platoon/math/numerics/exact_resolvent.hpp"

#include <cstddef>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

ExactMatrix product(const ExactMatrix& a, const ExactMatrix& b) {
  return a.lazyProduct(b);
}

ExactPolynomial ExactResolvent::numerator(const ExactMatrix& b) const {
  ExactPolynomial sum;
  for (std::size_t j = 0; j < numerators.size(); ++j)
    sum = add(sum, multiply(numerators[j], {b(static_cast<Eigen::Index>(j), 0)}));
  return sum;
}

// adj(zI - M) by descending powers of z: I, then A_k = M A_{k-1} + d_k I with d_k = -tr(M A_{k-1}) / k.
ExactResolvent exact_resolvent(const ExactMatrix& m, const ExactMatrix& c) {
  const Eigen::Index n = m.rows();
  ExactResolvent result{std::vector<ExactPolynomial>(static_cast<std::size_t>(n)), {Exact(1)}};
  ExactMatrix adjugate_term = ExactMatrix::Identity(n, n);
  for (Eigen::Index k = 1; k <= n; ++k) {
    check_interruption();
    const ExactMatrix row = product(c, adjugate_term);
    for (Eigen::Index j = 0; j < n; ++j) result.numerators[static_cast<std::size_t>(j)].push_back(row(0, j));
    adjugate_term = product(m, adjugate_term);
    const Exact coefficient = (Exact(0) - adjugate_term.trace()) / Exact(k);  // 0, not -0, for a trace of 0
    result.denominator.push_back(coefficient);
    adjugate_term.diagonal().array() += coefficient;
  }
  return result;
}

}  // namespace platoon
