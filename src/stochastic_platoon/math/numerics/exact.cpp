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

ExactPolynomial times_power_of_z(ExactPolynomial p, std::ptrdiff_t count) {
  for (; count > 0; --count) {
    p.push_back(Exact(0));
    for (std::size_t j = p.size() - 1; j > 0; --j) p[j] += p[j - 1];
  }
  return p;
}

ExactPolynomial add(ExactPolynomial p, const ExactPolynomial& q) {
  if (p.size() < q.size()) p.resize(q.size(), Exact(0));
  for (std::size_t j = 0; j < q.size(); ++j) p[j] += q[j];
  return p;
}

ExactPolynomial shifted_to_one(ExactPolynomial p) {
  for (std::size_t j = 0; j + 1 < p.size(); ++j) {
    for (std::size_t i = 1; i + j < p.size(); ++i) p[i] += p[i - 1];
  }
  std::reverse(p.begin(), p.end());
  return p;
}

ExactPolynomial shifted_to_origin(ExactPolynomial p) {
  std::reverse(p.begin(), p.end());
  for (std::size_t j = p.size(); j-- > 0;) {
    for (std::size_t i = p.size() - 1 - j; i > 0; --i) p[i] -= p[i - 1];
  }
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
