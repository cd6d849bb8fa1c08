#include "stochastic_platoon/math/response/loop_response.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "stochastic_platoon/math/numerics/exact.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

constexpr long double kWellConditioned = 100.0L;  // two of the nineteen digits

/// A polynomial in Newton's basis with the first nodes at 1 and the others at 0.
struct NewtonForm {
  ExactPolynomial at_one;   ///< coefficients of 1, s, s^2, ...
  ExactPolynomial at_zero;  ///< coefficients of the cofactor of s^at_one.size(), by ascending powers of z

  void move_node_to_one() {
    // Synthetic division by z - 1.
    for (std::size_t i = at_zero.size(); i-- > 1;) at_zero[i - 1] += at_zero[i];
    at_one.push_back(at_zero.front());
    at_zero.erase(at_zero.begin());
  }

  LoopResponse::Sequence coefficients() const {
    LoopResponse::Sequence result;
    for (const ExactPolynomial* part : {&at_one, &at_zero}) {
      for (const Exact& c : *part) result.push_back(c.convert_to<long double>());
    }
    return result;
  }
};

/// Newton form with all nodes at 0 and `size` coefficients, of a polynomial by ascending powers of s.
NewtonForm with_nodes_at_zero(ExactPolynomial p, std::size_t size) {
  for (std::size_t j = 0; j + 1 < p.size(); ++j) {
    for (std::size_t i = p.size() - 1; i-- > j;) p[i] -= p[i + 1];
  }
  p.resize(size, Exact(0));
  return {{}, std::move(p)};
}

/// A point z of the unit circle.
struct Place {
  long double size;   ///< |z - 1|
  long double value;  ///< |D|
};

/// Points at frequencies pi, pi/2, pi/4, ...
std::vector<Place> places_of(const DeltaPolynomial& denominator) {
  constexpr int kOctaves = 40;
  std::vector<Place> places;
  for (int j = 0; j < kOctaves; ++j) {
    const long double w = std::ldexp(boost::math::long_double_constants::pi, -j), sine = std::sin(w / 2.0L);
    const std::complex<long double> s(-2.0L * sine * sine, std::sin(w));
    std::complex<long double> sum = 0.0L;
    for (auto c = denominator.rbegin(); c != denominator.rend(); ++c) sum = sum * s + *c;
    places.push_back({std::abs(s), std::max(std::abs(sum), std::numeric_limits<long double>::min())});
  }
  return places;
}

/// The largest sum of the moduli of the terms of N and D, divided by |D|.
long double condition(const LoopResponse::Sequence& numerator, const LoopResponse::Sequence& denominator,
                      std::size_t at_one, const std::vector<Place>& places) {
  long double worst = 0.0L;
  for (const Place& place : places) {
    long double sum = 0.0L, power = 1.0L;
    for (std::size_t j = 0; j < denominator.size(); ++j) {
      sum += power * (std::abs(denominator[j]) + (j < numerator.size() ? std::abs(numerator[j]) : 0.0L));
      if (j < at_one) power *= place.size;
    }
    worst = std::max(worst, sum / place.value);
  }
  return worst;
}

}  // namespace

LoopResponse::LoopResponse(const ClosedLoop& loop) {
  const ExactFraction t = exact_fraction(loop);
  const std::size_t n = t.denominator.size() - 1;
  NewtonForm numerator = with_nodes_at_zero(t.numerator, n), denominator = with_nodes_at_zero(t.denominator, n + 1);
  const std::vector<Place> places = places_of(rounded_delta(t.denominator));
  long double least = std::numeric_limits<long double>::infinity();
  for (std::size_t at_one = 0; at_one <= n; ++at_one) {
    if (at_one > 0) {
      numerator.move_node_to_one();
      denominator.move_node_to_one();
    }
    Sequence c = numerator.coefficients(), d = denominator.coefficients();
    const long double found = condition(c, d, at_one, places);
    const bool powers_of_s_do = at_one == n && found <= kWellConditioned;
    if (found >= least && !powers_of_s_do) continue;
    least = found;
    at_zero_ = n - at_one;
    numerator_.swap(c);
    denominator_.swap(d);
  }
  const long double gain = rounded_delta(t.numerator).front() / rounded_delta(t.denominator).front();
  denominator_.pop_back();  // the leading 1
  std::reverse(numerator_.begin(), numerator_.end());
  std::reverse(denominator_.begin(), denominator_.end());
  // (1 - lambda) v_j = v_{j+1} - d y + c u
  equilibrium_.push_back(gain);
  for (std::size_t j = 0; j + 1 < n; ++j)
    equilibrium_.push_back((j < at_zero_ ? equilibrium_[j] : 0.0L) + denominator_[j] * gain - numerator_[j]);
  for (long double& value : equilibrium_) value /= gain;
}

void LoopResponse::advance(Sequence& state, long double input) const {
  const long double output = state.front();
  const std::size_t n = state.size();
  for (std::size_t j = 0; j < n; ++j) {
    const long double own = j < at_zero_ ? 0.0L : state[j], next = j + 1 < n ? state[j + 1] : 0.0L;
    state[j] = own + (next - denominator_[j] * output + numerator_[j] * input);
    if (std::abs(state[j]) < kNegligibleState) state[j] = 0.0L;
  }
}

LoopResponse::Sequence LoopResponse::operator()(const Sequence& input) const {
  Sequence state(numerator_.size(), 0.0L);
  Sequence response(input.size());
  for (std::size_t k = 0; k < input.size(); ++k) {
    check_interruption();
    response[k] = state.front();
    advance(state, input[k]);
  }
  return response;
}

LoopResponse::Sequence LoopResponse::free_response(std::size_t count) const {
  Sequence state = equilibrium_;
  Sequence response(count);
  for (std::size_t k = 0; k < count; ++k) {
    check_interruption();
    response[k] = state.front();
    advance(state, 0.0L);
  }
  return response;
}

}  // namespace platoon
