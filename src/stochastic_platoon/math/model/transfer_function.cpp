#include "stochastic_platoon/math/model/transfer_function.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

constexpr double kTolerance = 1e-13;  // of reduce()

/// Quotient of a division without remainder.
Polynomial exact_quotient(const Polynomial& dividend, const Polynomial& divisor) {
  Polynomial remainder = dividend;
  const Eigen::Index terms = dividend.size() - divisor.size() + 1;
  Polynomial quotient(terms);
  for (Eigen::Index i = 0; i < terms; ++i) {
    quotient(i) = remainder(i) / divisor(0);
    remainder.segment(i, divisor.size()) -= quotient(i) * divisor;
  }
  return quotient;
}

/// Matrix of (v, u) -> N v - D u for deg v = deg u = degree, over coefficients by descending powers.
Eigen::MatrixXd cofactor_map(const Polynomial& n, const Polynomial& d, Eigen::Index degree) {
  const Eigen::Index rows = d.size() + degree;
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(rows, 2 * (degree + 1));
  for (Eigen::Index j = 0; j <= degree; ++j) {
    map.col(j).segment(j + d.size() - n.size(), n.size()) = n;
    map.col(degree + 1 + j).segment(j, d.size()) = -d;
  }
  return map;
}

/// The null vector of a matrix with no more columns than rows, if it has one to the tolerance. Uses a QR decomposition
/// at a tenth of the cost of singular values: up to a small factor, its last pivot is the smallest singular value.
std::optional<Eigen::VectorXd> null_vector(const Eigen::MatrixXd& map) {
  const Eigen::Index last = map.cols() - 1;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(map);
  const Eigen::MatrixXd& r = qr.matrixQR();
  if (std::abs(r(last, last)) > 10.0 * kTolerance * std::abs(r(0, 0))) return std::nullopt;
  Eigen::VectorXd null(map.cols());
  null.head(last) = -r.topLeftCorner(last, last).triangularView<Eigen::Upper>().solve(r.col(last).head(last));
  null(last) = 1.0;
  return (qr.colsPermutation() * null).normalized();
}

TransferFunction without_common_zeros_at_origin(const TransferFunction& fraction, Eigen::Index* count) {
  Polynomial n = fraction.numerator();
  Polynomial d = fraction.denominator();
  *count = 0;
  while (n.size() > 1 && d.size() > 1 && n(n.size() - 1) == 0.0 && d(d.size() - 1) == 0.0) {
    n.conservativeResize(n.size() - 1);
    d.conservativeResize(d.size() - 1);
    ++*count;
  }
  return {n, d};
}

/// Matrix of q -> p q, with q given by `columns` coefficients.
Eigen::MatrixXd product_map(const Polynomial& p, Eigen::Index columns) {
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(p.size() + columns - 1, columns);
  for (Eigen::Index j = 0; j < columns; ++j) map.col(j).segment(j, p.size()) = p;
  return map;
}

/// p - f q in twice the precision of double, as both terms are equal to rounding. (long double differs from machine to
/// machine, and A and B with it.)
Eigen::VectorXd residual_of(const Polynomial& p, const Polynomial& f, const Polynomial& q) {
  Eigen::VectorXd high = p, low = Eigen::VectorXd::Zero(p.size());
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const double product = f(i) * q(j), before = high(i + j);
      high(i + j) = before - product;
      const double subtracted = before - high(i + j);
      low(i + j) += (before - (high(i + j) + subtracted)) - (product - subtracted) - std::fma(f(i), q(j), -product);
    }
  }
  return high + low;
}

// The gap between the singular values limits the accuracy of a null vector. Gauss-Newton steps on g u - N = 0, g v - D
// = 0 (v and g monic) refine u, v and g to the rounding of the coefficients.
Reduction refined_reduction(const TransferFunction& fraction, const Reduction& rough) {
  Polynomial u = rough.minimal.numerator(), v = rough.minimal.denominator(), g = rough.common_factor;
  const Polynomial& n = fraction.numerator();
  const Polynomial& d = fraction.denominator();
  const Eigen::Index of_u = u.size(), of_v = v.size() - 1, of_g = g.size() - 1;
  if (n.size() != of_u + of_g) return rough;
  for (int step = 0; step < 3; ++step) {
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(n.size() + d.size(), of_u + of_v + of_g);
    jacobian.topLeftCorner(n.size(), of_u) = product_map(g, of_u);
    jacobian.block(n.size(), of_u, d.size(), of_v) = product_map(g, v.size()).rightCols(of_v);
    jacobian.topRightCorner(n.size(), of_g) = product_map(u, g.size()).rightCols(of_g);
    jacobian.bottomRightCorner(d.size(), of_g) = product_map(v, g.size()).rightCols(of_g);
    Eigen::VectorXd residual(n.size() + d.size());
    residual << residual_of(n, g, u), residual_of(d, g, v);
    const Eigen::VectorXd change = jacobian.colPivHouseholderQr().solve(residual);
    if (!change.allFinite()) return rough;
    u += change.head(of_u);
    v.tail(of_v) += change.segment(of_u, of_v);
    g.tail(of_g) += change.tail(of_g);
  }
  return {TransferFunction(u, v), g};
}

// Whether g u and g v equal N and D to the rounding of a feedback's coefficients. Otherwise g is not a common factor.
bool is_factorization(const TransferFunction& fraction, const Reduction& found) {
  constexpr double kRounding = 32.0 * std::numeric_limits<double>::epsilon();
  const auto matches = [&](const Polynomial& p, const Polynomial& factor) {
    const Polynomial product = multiply(found.common_factor, factor);
    if (product.size() != p.size()) return false;
    return (p - product).cwiseAbs().maxCoeff() <= kRounding * p.cwiseAbs().maxCoeff();
  };
  return matches(fraction.numerator(), found.minimal.numerator()) &&
         matches(fraction.denominator(), found.minimal.denominator());
}

// Whether two fractions agree on the unit circle, except for w below 0.03, where poles at z = 1 magnify any rounding.
// This check is needed because poles and zeros that lie close together make the Sylvester matrix singular to working
// precision without a common factor.
bool is_same_function(const TransferFunction& one, const TransferFunction& other) {
  constexpr int kFrequencies = 32;
  for (int i = 0; i <= kFrequencies; ++i) {
    const double w = 0.03 * std::pow(3.1415 / 0.03, static_cast<double>(i) / kFrequencies);
    const std::complex<double> z = std::polar(1.0, w);
    if (std::abs(one(z) - other(z)) > 3e-9 * std::abs(other(z))) return false;
  }
  return true;
}

}  // namespace

TransferFunction::TransferFunction(const Polynomial& numerator, const Polynomial& denominator)
    : numerator_(trimmed(numerator)), denominator_(trimmed(denominator)) {
  if (denominator_(0) == 0.0) throw std::invalid_argument("denominator 0: a denominator must not be zero");
  const double leading = denominator_(0);
  numerator_ /= leading;
  denominator_ /= leading;
  if (!numerator_.allFinite() || !denominator_.allFinite()) {
    throw std::invalid_argument(formatted(
        "denominator: leading coefficient %g: too small, as the other coefficients overflow when they are divided by it",
        leading));
  }
}

int TransferFunction::relative_degree() const {
  if (numerator_(0) == 0.0) return static_cast<int>(denominator_.size());
  return static_cast<int>(denominator_.size() - numerator_.size());
}

std::complex<double> TransferFunction::operator()(std::complex<double> z) const {
  return evaluate(numerator_, z) / evaluate(denominator_, z);
}

Reduction reduce(const TransferFunction& fraction) {
  Eigen::Index at_origin = 0;
  const TransferFunction stripped = without_common_zeros_at_origin(fraction, &at_origin);
  Polynomial common = Polynomial::Zero(at_origin + 1);
  common(0) = 1.0;
  const Polynomial& n = stripped.numerator();
  const Polynomial& d = stripped.denominator();
  if (n(0) == 0.0) return {TransferFunction(Polynomial::Zero(1), Polynomial::Ones(1)), multiply(common, d)};
  if (n.size() > d.size()) return {stripped, common};  // improper: no caller needs lowest terms
  const double n_size = n.stableNorm(), d_size = d.stableNorm();
  const Polynomial unit_n = n / n_size;
  const Polynomial unit_d = d / d_size;
  // The map of the largest degree includes those of all smaller degrees.
  if (d.size() < 2 || !null_vector(cofactor_map(unit_n, unit_d, d.size() - 2))) return {stripped, common};
  const Eigen::Index relative_degree = d.size() - n.size();  // also that of u / v: v has no smaller degree
  for (Eigen::Index degree = relative_degree; degree + 1 < d.size(); ++degree) {
    const std::optional<Eigen::VectorXd> null = null_vector(cofactor_map(unit_n, unit_d, degree));
    if (!null) continue;
    const Polynomial v = null->head(degree + 1);
    Polynomial u = null->tail(degree + 1) * (n_size / d_size);
    u.head(relative_degree).setZero();  // only rounding errors
    if (std::abs(v(0)) < kTolerance || !u.allFinite() || !(u / v(0)).allFinite()) continue;
    const Reduction candidate = refined_reduction(stripped, {TransferFunction(u, v), exact_quotient(d, v / v(0))});
    if (!is_factorization(stripped, candidate) || !is_same_function(candidate.minimal, stripped)) continue;
    return {candidate.minimal, multiply(common, candidate.common_factor)};
  }
  return {stripped, common};
}

TransferFunction headway_policy(double headway) {
  return {Eigen::Vector2d(1.0 + headway, -headway), Eigen::Vector2d(1.0, 0.0)};
}

TransferFunction series(const TransferFunction& first, const TransferFunction& second) {
  return {multiply(first.numerator(), second.numerator()), multiply(first.denominator(), second.denominator())};
}

TransferFunction feedback(const TransferFunction& forward, const TransferFunction& return_path) {
  const Polynomial numerator = multiply(forward.numerator(), return_path.denominator());
  const Polynomial denominator = add(multiply(forward.denominator(), return_path.denominator()),
                                     multiply(forward.numerator(), return_path.numerator()));
  return {numerator, denominator};
}

}  // namespace platoon
