#include "stochastic_platoon/math/model/exact_transfer.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "stochastic_platoon/math/model/loop_design.hpp"
#include "stochastic_platoon/math/numerics/exact_resolvent.hpp"

namespace platoon {

namespace {

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
    term = product(term, m) / Exact(k);
    sum += term;
  }
  for (; halvings > 0; --halvings) sum = product(sum, sum);
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

  const SplitDelay delay = split_delay(input_delay, sample_period);
  const bool whole = delay.fraction == 0.0;
  const Exact period = sample_period;
  const Exact fraction = whole ? Exact(0) : Exact(input_delay) - Exact(delay.steps) * period;  // [s]
  const Held late = held_for(a, b, period - fraction);
  const Held early = held_for(a, b, fraction);
  const auto ascending = [](ExactPolynomial p) {
    std::reverse(p.begin(), p.end());
    return p;
  };
  const ExactResolvent resolvent =
      exact_resolvent(product(late.phi, early.phi) - ExactMatrix::Identity(n, n), c);  // in s
  ExactTransfer transfer{ascending(resolvent.numerator(late.gamma)), ascending(resolvent.denominator),
                         static_cast<std::ptrdiff_t>(delay.steps)};
  // Each pole at s = 0 of the continuous plant is one at z = 1 of the sampled plant, but for the 100th digit.
  for (Eigen::Index i = 0; i < n && denominator(n - i) == 0.0; ++i)
    transfer.denominator[static_cast<std::size_t>(i)] = 0;
  if (!whole) {  // Gamma_0 + Gamma_1 / z, see Plant
    transfer.numerator = add(multiply(transfer.numerator, {Exact(1), Exact(1)}),
                             ascending(resolvent.numerator(product(late.phi, early.gamma))));
    ++transfer.delay;
  }
  return transfer;
}

}  // namespace platoon
