#include "stochastic_platoon/math/paper/resolvent.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"
#include "stochastic_platoon/math/numerics/exact.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"
#include "stochastic_platoon/math/numerics/zeros.hpp"

namespace platoon {

namespace {

Resolvent stable_resolvent(const StateSpace& system) {
  Resolvent r = resolvent(system);
  for (const std::complex<long double>& s : zeros(r.delta_transfer->denominator)) {
    const long double excess = modulus_minus_one(s);
    if (!(excess < 0.0L)) {
      throw std::invalid_argument("rho(A): " + std::to_string(static_cast<double>(1.0L + excess)) + ": must be < 1");
    }
  }
  return r;
}

CirclePolynomial add(const CirclePolynomial& p, const CirclePolynomial& q) {
  return subtract(p, subtract(CirclePolynomial{0.0L}, q));
}

CirclePolynomial about(const DeltaPolynomial& p, Centre centre) {
  return centre == Centre::kOne ? p : recentred(p);
}

/// The polynomials of R and T about one centre.
struct ResolventHalf {
  Centre centre;
  std::vector<CirclePolynomial> numerators;
  CirclePolynomial transfer_numerator;
  CirclePolynomial denominator;

  ResolventHalf(const Resolvent& r, Centre of)
      : centre(of),
        transfer_numerator(about(rounded_delta(r.delta_transfer->numerator), of)),
        denominator(about(r.delta_denominator, of)) {
    for (const DeltaPolynomial& p : r.delta_numerators) numerators.push_back(about(p, of));
  }
};

/// Sum over m = 0 .. count-1 of gain^m.
long double geometric_sum(long double gain, long double count) {
  if (gain <= 0.0L) return 1.0L;
  if (gain == 1.0L) return count;
  return std::expm1(count * std::log(gain)) / (gain - 1.0L);
}

}  // namespace

double resolvent_peak(const StateSpace& system) {
  const Resolvent r = stable_resolvent(system);
  long double peak = 0.0L;
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    const ResolventHalf half(r, centre);
    CirclePolynomial n{0.0L};
    for (const CirclePolynomial& p : half.numerators) n = add(n, squared_modulus(p, centre));
    const CirclePolynomial d = squared_modulus(half.denominator, centre);
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
  const Resolvent r = stable_resolvent(system);
  const ResolventHalf near(r, Centre::kOne), far(r, Centre::kMinusOne);
  const Quadrature rule = half_circle_quadrature(frequencies_of(zeros(r.delta_transfer->denominator)), {0.0});
  long double energy = 0.0L;
  for (std::size_t k = 0; k < rule.node.size(); ++k) {
    const ResolventHalf& half = nearest(rule.node[k]) == Centre::kOne ? near : far;
    const long double t = circle_coordinate(rule.node[k], half.centre);
    const long double d = squared_modulus_at(half.denominator, half.centre, t);
    const long double gain = squared_modulus_at(half.transfer_numerator, half.centre, t) / d;
    long double sum = 0.0L;
    for (const CirclePolynomial& p : half.numerators) sum += squared_modulus_at(p, half.centre, t);
    energy += rule.weight[k] * sum / d * geometric_sum(gain, static_cast<long double>(followers));
  }
  return static_cast<double>(energy);
}

}  // namespace platoon
