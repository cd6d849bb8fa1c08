#include "stochastic_platoon/math/response/designed_gain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/numerics/zeros.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

/// |1 + w|^2 - 1.
long double excess_of(Complex w) {
  return 2.0L * w.real() + std::norm(w);
}

/// 1 - z^n on the unit circle, without cancellation near z = 1.
Complex one_minus_power(double frequency, std::int64_t n) {
  const long double half = 0.5L * static_cast<long double>(n) * static_cast<long double>(frequency);
  return Complex(0.0L, -2.0L * std::sin(half)) * std::polar(1.0L, half);
}

std::size_t leading_zeros_of(const ExactPolynomial& p) {
  return static_cast<std::size_t>(
      std::find_if(p.begin(), p.end(), [](const Exact& coefficient) { return coefficient != 0; }) - p.begin());
}

}  // namespace

DesignedGain::DesignedGain(const LoopDesign& design, double headway, double feed_forward, const Plant& before)
    : delay_(design.plant.exact().delay + design.controller.exact().delay),
      controller_delay_(design.controller.exact().delay),
      filtered_(design.headway_filter),
      sends_(design.sends_input),
      headway_(headway),
      feed_forward_(feed_forward) {
  const ExactTransfer &plant = design.plant.exact(), &ahead = before.exact(), &controller = design.controller.exact();
  ExactPolynomial of_controller = controller.denominator;
  if (design.divide_by_one_plus_headway) {
    for (Exact& coefficient : of_controller) coefficient *= Exact(1) + Exact(headway);
  }
  ahead_ = std::make_shared<const ExactTransfer>(ExactTransfer{multiply(ahead.numerator, controller.numerator),
                                                               multiply(ahead.denominator, of_controller),
                                                               ahead.delay + controller.delay});
  numerator_ = rounded_delta(multiply(plant.numerator, controller.numerator));
  denominator_ = rounded_delta(multiply(plant.denominator, of_controller));
  plant_numerator_ = rounded_delta(plant.numerator);
  plant_denominator_ = rounded_delta(plant.denominator);
  controller_denominator_ = rounded_delta(of_controller);
  if (before == design.plant) return;
  ExactPolynomial numerator = multiply(plant.numerator, ahead.denominator),
                  denominator = multiply(plant.denominator, ahead.numerator);
  const auto shared = static_cast<std::ptrdiff_t>(std::min(leading_zeros_of(numerator), leading_zeros_of(denominator)));
  numerator.erase(numerator.begin(), numerator.begin() + shared);
  denominator.erase(denominator.begin(), denominator.begin() + shared);
  quotient_numerator_ = rounded_delta(numerator);
  quotient_denominator_ = rounded_delta(denominator);
  for (Exact& coefficient : numerator) coefficient = -coefficient;
  quotient_difference_ = rounded_delta(add(denominator, numerator));
}

DesignedGain::Value DesignedGain::at(const CirclePoint& point, const Links& links) const {
  const Complex s = point.from_one(), z = 1.0L + s;
  const long double from_one = -s.real();  // 1 - cos w
  const Complex n = evaluate(numerator_, s), d = evaluate(denominator_, s) * turned(z, delay_);
  const Complex policy = Complex(1.0L + headway_) - headway_ * std::conj(z);
  const Complex closed = filtered_ ? policy * (d + n) : d + policy * n;
  Value value{n / closed, 0.0L, 0.0L, 0.0L, std::numeric_limits<long double>::infinity()};
  // T^ is its position part times 1 + ratio W.
  Complex ratio = 0.0L, one_minus_ratio = 1.0L;
  if (feed_forward_ != 0.0L) {
    const Complex plant = evaluate(plant_numerator_, s);
    value.input = feed_forward_ * plant * evaluate(controller_denominator_, s) * turned(z, controller_delay_) / closed;
    const std::int64_t turns = links.position_delay - links.input_delay - (delay_ - ahead_->delay);
    Complex quotient = 1.0L, one_minus_quotient = 0.0L;
    if (!quotient_difference_.empty()) {
      const Complex over = evaluate(quotient_denominator_, s);
      quotient = evaluate(quotient_numerator_, s) / over;
      one_minus_quotient = evaluate(quotient_difference_, s) / over;
    }
    const Complex difference = one_minus_power(point.frequency, turns), turned_gain = feed_forward_ * turned(z, turns),
                  turn = turned_gain * quotient, x = links.position_excess, y = links.input_excess;
    value.through_input = turn * d / closed;
    ratio = turn * (1.0L + x) / (1.0L + y);
    one_minus_ratio =
        (y - turn * x + (1.0L - feed_forward_) + feed_forward_ * difference + turned_gain * one_minus_quotient) /
        (1.0L + y);
  }
  if (sends_) value.sent = std::norm(evaluate(plant_denominator_, s)) / std::norm(evaluate(plant_numerator_, s));
  if (std::norm(n) == 0.0L) return value;
  const Complex w = d / n;
  const long double of_policy = 2.0L * headway_ * (1.0L + headway_) * from_one;
  const long double of_ratio = excess_of(ratio * w), of_link = excess_of(links.position_excess);
  if (of_ratio == -1.0L) return value;  // T^ = 0
  const Complex compared = filtered_ ? one_minus_ratio : one_minus_ratio - headway_ * s;
  const long double of_square = 2.0L * one_minus_ratio.real() - std::norm(one_minus_ratio);  // 1 - |ratio|^2
  long double excess = 2.0L * (compared * w).real() + std::norm(w) * of_square;
  if (!filtered_) excess += of_policy;
  excess /= 1.0L + of_ratio;
  if (filtered_) excess += of_policy * (1.0L + excess);
  value.excess = excess + of_link * (1.0L + excess);
  return value;
}

std::vector<std::complex<long double>> DesignedGain::zeros(const ExactTransfer& position, const ExactTransfer& input,
                                                           const Links& links) const {
  // T^ G_before / G = (T_L z^-m G_before K + T_L' z^-m' F) / (H (1 + G K)): with G_before K = n / d z^-q, T_L = z^a N /
  // D and T_L' = z^b N' / D' the numerator N D' n z^(a - q - m) + N' D F d z^(b - m'), without the powers of z that
  // both terms share.
  if (feed_forward_ == 0.0L) return platoon::zeros(ahead_->numerator);
  const ExactPolynomial of_position = multiply(multiply(ahead_->numerator, input.denominator), position.numerator),
                        of_input = multiply(multiply(ahead_->denominator, position.denominator),
                                            multiply(input.numerator, {Exact(feed_forward_)}));
  const std::ptrdiff_t behind = static_cast<std::ptrdiff_t>(links.position_delay - links.input_delay) + ahead_->delay +
                                position.delay - input.delay;
  return behind >= 0 ? zeros_behind_delay(of_input, static_cast<std::size_t>(behind), of_position)
                     : zeros_behind_delay(of_position, static_cast<std::size_t>(-behind), of_input);
}

std::int64_t DesignedGain::plant_turns() const {
  return std::abs(delay_ - ahead_->delay);
}

int DesignedGain::zeros_of_difference() const {
  constexpr long double kRounding = 1e-15L;  // of plants that are given in double
  if (quotient_difference_.empty()) return feed_forward_ == 1.0L ? 1 : 0;
  if (quotient_denominator_.front() == 0.0L) {
    const auto first = std::find_if(quotient_denominator_.begin(), quotient_denominator_.end(),
                                    [](long double coefficient) { return coefficient != 0.0L; });
    return -static_cast<int>(first - quotient_denominator_.begin());
  }
  const long double gain = feed_forward_ * quotient_numerator_.front() / quotient_denominator_.front();
  return std::abs(1.0L - gain) <= kRounding ? 1 : 0;
}

}  // namespace platoon
