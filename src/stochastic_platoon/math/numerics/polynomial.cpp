#include "stochastic_platoon/math/numerics/polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/eigenvalues.hpp"

namespace platoon {

Polynomial trimmed(const Polynomial& p) {
  if (p.size() == 0) throw std::invalid_argument("a polynomial needs at least one coefficient");
  if (!p.allFinite()) throw std::invalid_argument("every coefficient of a polynomial must be finite");
  Eigen::Index leading = 0;
  while (leading + 1 < p.size() && p(leading) == 0.0) ++leading;
  return p.tail(p.size() - leading);
}

Polynomial multiply(const Polynomial& p, const Polynomial& q) {
  Polynomial product = Polynomial::Zero(p.size() + q.size() - 1);
  for (Eigen::Index i = 0; i < p.size(); ++i) product.segment(i, q.size()) += p(i) * q;
  return product;
}

Polynomial add(const Polynomial& p, const Polynomial& q) {
  Polynomial sum = Polynomial::Zero(std::max(p.size(), q.size()));
  sum.tail(p.size()) += p;
  sum.tail(q.size()) += q;
  return sum;
}

Polynomial derivative(const Polynomial& p) {
  const Eigen::Index degree = p.size() - 1;
  if (degree < 1) return Polynomial::Zero(1);
  Polynomial slope(degree);
  for (Eigen::Index i = 0; i < degree; ++i) slope(i) = static_cast<double>(degree - i) * p(i);
  return slope;
}

std::complex<double> evaluate(const Polynomial& p, std::complex<double> z) {
  std::complex<double> value = 0.0;
  for (Eigen::Index i = 0; i < p.size(); ++i) value = value * z + p(i);
  return value;
}

std::vector<std::complex<double>> roots(const Polynomial& p) {
  const Polynomial q = trimmed(p);
  const Eigen::Index degree = q.size() - 1;
  if (degree < 1) return {};
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
  companion.row(0) = -q.tail(degree).transpose() / q(0);
  for (Eigen::Index i = 1; i < degree; ++i) companion(i, i - 1) = 1.0;
  const Eigen::VectorXcd found = eigenvalues(companion);
  return {found.data(), found.data() + found.size()};
}

int multiplicity_at_one(const Polynomial& p) {
  constexpr double kTolerance = 1e-9;
  int multiplicity = 0;
  for (Polynomial q = trimmed(p); q.cwiseAbs().sum() > 0.0; q = derivative(q)) {
    if (std::abs(q.sum()) > kTolerance * q.cwiseAbs().sum()) break;
    ++multiplicity;
  }
  return multiplicity;
}

}  // namespace platoon
