#include "stochastic_platoon/math/links/linked_vehicle.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <utility>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

CirclePolynomial scaled(CirclePolynomial p, long double factor) {
  for (long double& c : p) c *= factor;
  return p;
}

CirclePolynomial moduli(CirclePolynomial p) {
  for (long double& c : p) c = std::abs(c);
  return p;
}

std::vector<LinkFilter> filters_of(const VehicleModel& vehicle) {
  std::vector<LinkFilter> links{LinkFilter(vehicle.link, vehicle.noise_variance)};
  if (vehicle.feed_forward) links.emplace_back(vehicle.feed_forward->link, vehicle.feed_forward->noise_variance);
  return links;
}

/// F N of one input.
Complex passed(const LinkFilter::Value& link, Complex transfer) {
  return link.powers * transfer * std::conj(link.registers) / std::norm(link.registers);
}

InputValue input_value(const LinkFilter& link, const LinkFilter::Value& value, Complex passed) {
  const long double loss_gain = std::norm(passed), p = link.arrival();
  return {static_cast<double>(loss_gain), static_cast<double>(p * p * loss_gain), value.innovation, value.noise};
}

}  // namespace

LinkedVehicle::LinkedVehicle(const VehicleModel& vehicle, const LinkedVehicle* known, const VehicleModel* before)
    : vehicle_(vehicle), links_(filters_of(vehicle)), spectral_radius_(platoon::spectral_radius(vehicle.loop)) {
  if (vehicle.loop.parts)
    designed_.emplace(*vehicle.design, vehicle.headway, vehicle.feed_forward ? vehicle.feed_forward->gain : 0.0,
                      before != nullptr ? before->design->plant : vehicle.design->plant);
  factor_ = designed_ ? designed_factor(known, before != nullptr) : rated_factor(vehicle.loop);
  for (const LinkFilter& link : links_) {
    if (!link.has_losses() || link.loss().predictor.empty()) continue;
    for (const std::complex<long double>& s : zeros(link.registers())) factor_.factor.poles.push_back(s);
    if (!designed_) factor_.rounded.push_back(z_form(link.registers()));
  }
  if (designed_) return;
  const DeltaFraction t = delta_fraction(vehicle.loop);
  near_ = {t.numerator, t.denominator};
  far_ = {recentred(t.numerator), recentred(t.denominator)};
  const long double p = links_.front().arrival();
  const CirclePolynomial arriving = multiply(squared_modulus(near_.denominator, Centre::kOne),
                                             squared_modulus(links_.front().registers(), Centre::kOne));
  margin_ = without_zero_at_origin(subtract(arriving, scaled(squared_modulus(near_.numerator, Centre::kOne), p * p)));
}

// The poles of T^ are those of T. The zeros do not depend on the headway unless the controller does.
RatedFactor LinkedVehicle::designed_factor(const LinkedVehicle* known, bool behind_other) const {
  const bool has_radio = vehicle_.feed_forward.has_value();
  if (known != nullptr && !vehicle_.design->divide_by_one_plus_headway &&
      known->vehicle_.feed_forward == vehicle_.feed_forward && (!has_radio || known->vehicle_.link == vehicle_.link))
    return {{poles_of(vehicle_.loop), known->factor_.factor.zeros}, {}};
  if (!has_radio && !behind_other) return rated_factor(vehicle_.loop);
  if (!has_radio) return {{poles_of(vehicle_.loop), designed_->zeros({}, {}, 1.0L, 0.0L, {})}, {}};
  const auto registers = [](const LinkFilter& link) {
    if (!link.has_losses()) return ExactPolynomial{Exact(1)};
    ExactPolynomial p;
    for (const long double c : link.registers()) p.emplace_back(c);
    return p;
  };
  const LinkFilter &position = links_[0], &input = links_[1];
  return {{poles_of(vehicle_.loop), designed_->zeros(registers(position), registers(input), position.arrival(),
                                                     input.arrival(), {0.0L, 0.0L, position.delay(), input.delay()})},
          {}};
}

LinkedVehicleValue LinkedVehicle::at(const CirclePoint& point) const {
  const bool near = point.centre == Centre::kOne;
  const Complex s = point.offset, z = s + (near ? 1.0L : -1.0L);
  const long double t = std::abs(s.real()), x = near ? t : 2.0L - t, h = vehicle_.headway;
  std::array<LinkFilter::Value, 2> of_links;
  for (std::size_t j = 0; j < links_.size(); ++j) of_links[j] = links_[j].at(point);
  LinkedVehicleValue value{};
  value.spacing_gain = static_cast<double>(1.0L + 2.0L * h * (1.0L + h) * x);
  Complex response;  // T^ z^m
  if (designed_) {
    response = designed_response(point, of_links, value);
  } else {
    const Half& part = near ? near_ : far_;
    const LinkFilter::Value& link = of_links[0];
    const Complex numerator = evaluate(part.numerator, s), denominator = evaluate(part.denominator, s);
    const long double of_loop = std::norm(denominator), of_link = std::norm(link.registers), over = of_loop * of_link,
                      p = links_.front().arrival();
    const Complex through = link.powers * numerator * std::conj(denominator * link.registers) / over;
    value.input[0] = input_value(links_[0], link, through);
    response = p * through;
    const long double gain = std::norm(response);
    long double margin = 1.0L - gain;
    if (near && gain > 0.25L) {
      // Uses the polynomial if the difference 1 - |T^|^2 cancels, and the difference if the polynomial cancels.
      const long double size = std::sqrt(2.0L * t);
      const auto share = [size](const CirclePolynomial& b, long double squared) {
        return magnitude(b, size) / std::sqrt(squared);
      };
      const long double doubt = share(part.denominator, of_loop) + share(links_[0].registers(), of_link) +
                                gain * share(part.numerator, std::norm(numerator));
      if (magnitude(margin_, t) * t <= 2.0L * doubt * over) margin = evaluate(margin_, t) * t / over;
    }
    value.margin = static_cast<double>(margin);
  }
  const Complex policy = Complex(1.0L + h) - h * std::conj(z), undelayed = policy * response;
  const Complex delay = power(std::conj(z), vehicle_.link.delay), mean = delay * undelayed;
  value.gain = static_cast<double>(std::norm(response));
  value.complement = static_cast<double>(std::norm(1.0L - mean));
  value.of_gap = static_cast<double>(std::norm(1.0L - delay * response));
  value.undelayed = static_cast<std::complex<double>>(undelayed);
  value.response = static_cast<std::complex<double>>(response);
  return value;
}

// Sets all fields that depend on how the vehicle is built, and returns T^ without the delay of the position.
Complex LinkedVehicle::designed_response(const CirclePoint& point, const std::array<LinkFilter::Value, 2>& of_links,
                                         LinkedVehicleValue& value) const {
  const bool has_radio = links_.size() > 1;
  DesignedGain::Links effect{of_links[0].excess(links_[0].arrival()), 0.0L, links_[0].delay(), 0};
  if (has_radio) {
    effect.input_excess = of_links[1].excess(links_[1].arrival());
    effect.input_delay = links_[1].delay();
  }
  const DesignedGain::Value loop = designed_->at(point, effect);
  const Complex of_position = passed(of_links[0], loop.position);
  Complex response = links_[0].arrival() * of_position;
  value.input[0] = input_value(links_[0], of_links[0], of_position);
  if (has_radio) {
    const Complex of_input = passed(of_links[1], loop.input);
    value.input[1] = input_value(links_[1], of_links[1], of_input);
    response += links_[1].arrival() * passed(of_links[1], loop.through_input);
  }
  value.sent = static_cast<double>(loop.sent);
  value.margin = std::isinf(loop.excess) ? 1.0 : static_cast<double>(loop.excess / (1.0L + loop.excess));
  return response;
}

ZerosAtZero LinkedVehicle::zeros_at_zero() const {
  ZerosAtZero zeros{1, ZerosAtZero::kNone, ZerosAtZero::kNone};
  const LinkFilter& position = links_.front();
  if (lag() == 0.0 && vehicle_.feed_forward) {
    const int of_feed_forward = *vehicle_.loop.integrators + feed_forward_zeros();
    zeros.complement = position.has_losses() ? std::min(position.surprise_zeros(), of_feed_forward) : of_feed_forward;
  } else if (lag() == 0.0 && designed_ && !position.has_losses()) {
    zeros.complement = *vehicle_.loop.integrators;
  } else if (lag() == 0.0) {
    // 1 - H T^ = (z D R - ((1 + h) z - h) p z^n N) / (z D R), with two zeros at s = 0, as there is no lag.
    const DeltaFraction t = delta_fraction(vehicle_.loop);
    const long double h = vehicle_.headway;
    CirclePolynomial open = multiply({1.0L, 1.0L}, multiply(t.denominator, position.registers()));
    CirclePolynomial closed = scaled(multiply({1.0L, 1.0L + h}, t.numerator), position.arrival());
    for (std::size_t j = 0; j < position.loss().predictor.size(); ++j) closed = multiply({1.0L, 1.0L}, closed);
    zeros.complement = leading_zeros(subtract(open, closed), subtract(moduli(open), scaled(moduli(closed), -1.0L)), 2);
  }
  if (position.has_losses()) zeros.innovation = position.surprise_zeros();
  zeros.noise = position.noise_zeros();
  if (!vehicle_.feed_forward) return zeros;
  // At w = 0 u = y / G vanishes like the double integrator of the plant, and N_input like the integrators of K.
  const LinkFilter& input = links_.back();
  const LoopDesign& design = *vehicle_.design;
  if (input.has_losses())
    zeros.innovation = std::min(zeros.innovation, input.surprise_zeros() + design.plant.exact().integrators());
  zeros.noise = std::min(zeros.noise, input.noise_zeros() + design.controller.exact().integrators());
  return zeros;
}

// Multiplicity of z = 1 as a zero of 1 - F z^-m p F_l G / G_before, the part of the predecessor's input that
// feed-forward leaves.
int LinkedVehicle::feed_forward_zeros() const {
  const LinkFilter& input = links_.back();
  const bool is_held = !input.has_losses() || !input.loss().predictor.empty();
  return is_held ? designed_->zeros_of_difference() : 0;
}

std::vector<std::complex<double>> LinkedVehicle::pole_frequencies() const {
  std::vector<std::complex<double>> found = frequencies_of(factor_.factor.poles);
  for (const LinkFilter& link : links_) {
    for (const std::complex<double>& w : link.noise_frequencies()) found.push_back(w);
  }
  if (!vehicle_.feed_forward) return found;
  // The difference of the delays rotates T^; a panel may cover two radians.
  const auto turns = static_cast<double>(std::max(links_[0].delay(), links_[1].delay()) + designed_->plant_turns());
  for (int k = 0; k <= boost::math::double_constants::pi * turns; ++k) found.emplace_back(k / turns, 1.0 / turns);
  return found;
}

bool LinkedVehicle::is_of(const VehicleModel& vehicle) const {
  return vehicle.headway == vehicle_.headway && vehicle.link == vehicle_.link &&
         vehicle.feed_forward == vehicle_.feed_forward;
}

double LinkedVehicle::loss_feedback() const {
  double largest = 0.0;
  for (const LinkFilter& link : links_) largest = std::max(largest, link.loss_feedback());
  return largest;
}

bool LinkedVehicle::has_losses() const {
  return std::any_of(links_.begin(), links_.end(), [](const LinkFilter& link) { return link.has_losses(); });
}

}  // namespace platoon
