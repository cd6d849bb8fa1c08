#include "stochastic_platoon/math/model/exact_transfer.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <limits>
#include <utility>

namespace platoon {

namespace {

using ExactMatrix = Eigen::Matrix<Exact, Eigen::Dynamic, Eigen::Dynamic>;

/// p without its zeros at the origin; adds their number to `count`.
ExactPolynomial without_zeros_at_origin(const Polynomial& p, std::ptrdiff_t& count) {
  ExactPolynomial q = exact(p);
  for (; q.size() > 1 && q.back() == 0; ++count) q.pop_back();
  return q;
}

/// p by powers of s; zeros at s = 0 to the rounding of the coefficients of p are placed there exactly.
ExactPolynomial with_zeros_at_one(const ExactPolynomial& p) {
  ExactPolynomial magnitudes;
  for (const Exact& coefficient : p) magnitudes.push_back(abs(coefficient));
  const ExactPolynomial size = shifted_to_one(magnitudes);
  ExactPolynomial q = shifted_to_one(p);
  const Exact rounding = std::numeric_limits<double>::epsilon();
  for (std::size_t j = 0; j + 1 < q.size() && abs(q[j]) <= rounding * size[j]; ++j) q[j] = 0;
  return q;
}

/// e^M by its Taylor series after scaling, and repeated squaring.
ExactMatrix exponential(ExactMatrix m) {
  const Exact norm = m.cwiseAbs().rowwise().sum().maxCoeff();
  int halvings = 0;
  for (Exact scaled = norm; scaled > Exact(1) / 16; scaled /= 2) ++halvings;
  m /= pow(Exact(2), halvings);
  constexpr int kTerms = 64;  // 16^-64 / 64! is below 1e-160
  ExactMatrix sum = ExactMatrix::Identity(m.rows(), m.cols()), term = sum;
  for (int k = 1; k <= kTerms; ++k) {
    term = (term * m / Exact(k)).eval();
    sum += term;
  }
  for (; halvings > 0; --halvings) sum = (sum * sum).eval();
  return sum;
}

/// x' = A x + B u over an interval of constant u: x <- Phi x + Gamma u.
struct Held {
  ExactMatrix phi, gamma;
};

Held held_for(const ExactMatrix& a, const ExactMatrix& b, const Exact& interval) {
  const Eigen::Index n = a.rows();
  ExactMatrix augmented = ExactMatrix::Zero(n + 1, n + 1);
  augmented.topLeftCorner(n, n) = a * interval;
  augmented.topRightCorner(n, 1) = b * interval;
  const ExactMatrix moved = exponential(std::move(augmented));
  return {moved.topLeftCorner(n, n), moved.topRightCorner(n, 1)};
}

/// C adj(sI - M) B and det(sI - M) by ascending powers of s, by the Faddeev-LeVerrier recursion.
ExactTransfer transfer_of(const ExactMatrix& m, const std::vector<ExactMatrix>& inputs, const ExactMatrix& c,
                          std::vector<ExactPolynomial>& numerators) {
  const auto n = static_cast<std::size_t>(m.rows());
  ExactTransfer transfer{{}, ExactPolynomial(n + 1, Exact(0)), 0};
  transfer.denominator[n] = 1;
  numerators.assign(inputs.size(), ExactPolynomial(n, Exact(0)));
  ExactMatrix adjugate_term = ExactMatrix::Identity(m.rows(), m.cols());
  for (std::size_t k = 1; k <= n; ++k) {
    for (std::size_t i = 0; i < inputs.size(); ++i) numerators[i][n - k] = (c * adjugate_term * inputs[i])(0, 0);
    adjugate_term = (m * adjugate_term).eval();
    Exact trace = 0;
    for (Eigen::Index i = 0; i < m.rows(); ++i) trace += adjugate_term(i, i);
    const Exact coefficient = -trace / Exact(k);
    transfer.denominator[n - k] = coefficient;
    for (Eigen::Index i = 0; i < m.rows(); ++i) adjugate_term(i, i) += coefficient;
  }
  return transfer;
}

}  // namespace

int ExactTransfer::integrators() const {
  const auto zeros_at_one = [](const ExactPolynomial& p) {
    const auto other = std::find_if(p.begin(), p.end(), [](const Exact& coefficient) { return coefficient != 0; });
    return static_cast<int>(other - p.begin());
  };
  return zeros_at_one(denominator) - zeros_at_one(numerator);
}

ExactTransfer exact_transfer(const TransferFunction& fraction) {
  std::ptrdiff_t zeros = 0, poles = 0;
  ExactTransfer transfer;
  transfer.numerator = shifted_to_one(without_zeros_at_origin(fraction.numerator(), zeros));
  transfer.denominator = with_zeros_at_one(without_zeros_at_origin(fraction.denominator(), poles));
  transfer.delay = poles - zeros;
  return transfer;
}

ExactTransfer zero_order_hold(const Polynomial& numerator, const Polynomial& denominator, double input_delay,
                              double sample_period) {
  const Eigen::Index n = denominator.size() - 1;
  // Controllable companion form of the monic fraction.
  ExactMatrix a = ExactMatrix::Zero(n, n), b = ExactMatrix::Zero(n, 1), c = ExactMatrix::Zero(1, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) a(i, i + 1) = 1;
  for (Eigen::Index i = 0; i < n; ++i) a(n - 1, i) = -Exact(denominator(n - i)) / Exact(denominator(0));
  b(n - 1, 0) = 1;
  for (Eigen::Index i = 0; i < numerator.size(); ++i)
    c(0, i) = Exact(numerator(numerator.size() - 1 - i)) / Exact(denominator(0));

  const double periods = input_delay / sample_period, nearest = std::round(periods);
  const bool whole = std::abs(periods - nearest) <= 8.0 * std::numeric_limits<double>::epsilon() * periods;
  const double steps = whole ? nearest : std::floor(periods);
  const Exact period = sample_period;
  const Exact fraction = whole ? Exact(0) : Exact(input_delay) - Exact(steps) * period;  // [s]
  const Held late = held_for(a, b, period - fraction);
  std::vector<ExactMatrix> inputs{late.gamma};
  ExactMatrix moved = late.phi;
  if (!whole) {
    const Held early = held_for(a, b, fraction);
    inputs.push_back(late.phi * early.gamma);
    moved = (late.phi * early.phi).eval();
  }
  std::vector<ExactPolynomial> numerators;
  ExactTransfer transfer = transfer_of(moved - ExactMatrix::Identity(n, n), inputs, c, numerators);
  // Each pole at s = 0 of the continuous plant is one of the sampled plant; rounding in the 100th digit goes.
  for (Eigen::Index i = 0; i < n && denominator(n - i) == 0.0; ++i)
    transfer.denominator[static_cast<std::size_t>(i)] = 0;
  transfer.delay = static_cast<std::ptrdiff_t>(steps);
  transfer.numerator = numerators[0];
  if (!whole) {
    transfer.numerator = add(multiply(numerators[0], {Exact(1), Exact(1)}), numerators[1]);
    ++transfer.delay;
  }
  return transfer;
}

}  // namespace platoon
