#include "stochastic_platoon/math/numerics/exact.hpp"

#include <algorithm>
#include <cstddef>

namespace platoon {

ExactPolynomial exact(const Polynomial& p) {
  return ExactPolynomial(p.data(), p.data() + p.size());
}

ExactPolynomial multiply(const ExactPolynomial& p, const ExactPolynomial& q) {
  ExactPolynomial product(p.size() + q.size() - 1, Exact(0));
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (std::size_t j = 0; j < q.size(); ++j) product[i + j] += p[i] * q[j];
  }
  return product;
}

ExactPolynomial shifted_to_one(ExactPolynomial p) {
  for (std::size_t j = 0; j + 1 < p.size(); ++j) {
    for (std::size_t i = 1; i + j < p.size(); ++i) p[i] += p[i - 1];
  }
  std::reverse(p.begin(), p.end());
  return p;
}

Polynomial rounded(const ExactPolynomial& p) {
  Polynomial result(static_cast<Eigen::Index>(p.size()));
  for (std::size_t i = 0; i < p.size(); ++i) result(static_cast<Eigen::Index>(i)) = p[i].convert_to<double>();
  return result;
}

DeltaPolynomial rounded_delta(const ExactPolynomial& p) {
  DeltaPolynomial result;
  for (const Exact& coefficient : p) result.push_back(coefficient.convert_to<long double>());
  return result;
}

}  // namespace platoon
