#include "stochastic_platoon/theory/resolvent.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/theory/circle_polynomial.hpp"
#include "stochastic_platoon/theory/quadrature.hpp"

namespace platoon {

namespace {

void require_stable(const StateSpace& system) {
  const double radius = spectral_radius(system);
  if (!(radius < 1.0)) throw std::invalid_argument("rho(A): " + std::to_string(radius) + ": must be < 1");
}

CirclePolynomial add(const CirclePolynomial& p, const CirclePolynomial& q) {
  return subtract(p, subtract(CirclePolynomial{0.0L}, q));
}

double squared_norm(const Resolvent& r, std::complex<double> z) {
  double sum = 0.0;
  for (const Polynomial& numerator : r.numerators) sum += std::norm(evaluate(numerator, z));
  return sum / std::norm(evaluate(r.denominator, z));
}

/// Sum over m = 0 .. count-1 of gain^m.
double geometric_sum(double gain, double count) {
  if (gain <= 0.0) return 1.0;
  if (gain == 1.0) return count;
  return std::expm1(count * std::log(gain)) / (gain - 1.0);
}

}  // namespace

Resolvent resolvent(const StateSpace& system) {
  const Eigen::Index n = system.order();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  Resolvent result{std::vector<Polynomial>(static_cast<std::size_t>(n), Polynomial::Zero(n)),
                   Polynomial::Zero(n + 1)};
  result.denominator(0) = 1.0;
  Eigen::MatrixXd adjugate_term = identity;
  for (Eigen::Index k = 1; k <= n; ++k) {
    const Eigen::RowVectorXd row = system.c() * adjugate_term;
    for (Eigen::Index a = 0; a < n; ++a) result.numerators[static_cast<std::size_t>(a)](k - 1) = row(a);
    const Eigen::MatrixXd product = system.a() * adjugate_term;
    result.denominator(k) = -product.trace() / static_cast<double>(k);
    adjugate_term = product + result.denominator(k) * identity;
  }
  return result;
}

double resolvent_peak(const StateSpace& system) {
  require_stable(system);
  const Resolvent r = resolvent(system);
  long double peak = 0.0L;
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    CirclePolynomial n{0.0L};
    for (const Polynomial& p : r.numerators) n = add(n, squared_modulus(taylor(p, centre), centre));
    const CirclePolynomial d = squared_modulus(taylor(r.denominator, centre), centre);
    std::vector<long double> candidates =
        sign_changes(subtract(multiply(derivative(n), d), multiply(n, derivative(d))), 0.0L, 1.0L);
    candidates.push_back(0.0L);
    candidates.push_back(1.0L);
    for (const long double t : candidates) peak = std::max(peak, evaluate(n, t) / evaluate(d, t));
  }
  return static_cast<double>(std::sqrt(peak));
}

double resolvent_energy(const StateSpace& system, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  require_stable(system);
  const Resolvent r = resolvent(system);
  const TransferFunction transfer = transfer_function(system);
  std::vector<std::complex<double>> singular;
  for (const std::complex<double>& pole : roots(r.denominator)) {
    if (std::abs(pole) > 0.0) singular.push_back(std::complex<double>(0.0, -1.0) * std::log(pole));
  }
  const Quadrature rule = half_circle_quadrature(singular, {0.0});
  double energy = 0.0;
  for (std::size_t k = 0; k < rule.node.size(); ++k) {
    const std::complex<double> z = std::polar(1.0, rule.node[k]);
    energy += rule.weight[k] * squared_norm(r, z) *
              geometric_sum(std::norm(transfer(z)), static_cast<double>(followers));
  }
  return energy;
}

}  // namespace platoon
