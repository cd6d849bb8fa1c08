#include "stochastic_platoon/math/links/linked_vehicle.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/model/input.hpp"
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

std::vector<LinkFilter> filters_of(const VehicleModel& vehicle, const LinkedVehicle* known) {
  const auto same = [known](std::size_t link) {
    return known != nullptr && link < known->links().size() ? &known->links()[link] : nullptr;
  };
  std::vector<LinkFilter> links;
  for (const Input& input : vehicle.inputs) links.emplace_back(input.link, input.noise_variance, same(links.size()));
  return links;
}

InputValue input_value(const LinkFilter& link, const CirclePoint& point, Complex transfer, Complex passed) {
  return {static_cast<double>(std::norm(transfer)), static_cast<double>(std::norm(passed)), link.noise(point)};
}

}  // namespace

LinkedVehicle::LinkedVehicle(const VehicleModel& vehicle, const LinkedVehicle* known, const VehicleModel* before)
    : vehicle_(vehicle), links_(filters_of(vehicle, known)), spectral_radius_(platoon::spectral_radius(vehicle.loop)) {
  if (vehicle.radio() != nullptr && !vehicle.loop.parts)
    throw std::invalid_argument("inputs: a radio: must be absent for a vehicle without plant and controller");
  if (vehicle.loop.parts)
    designed_.emplace(*vehicle.design, vehicle.headway, vehicle.radio() != nullptr ? vehicle.radio()->gain : 0.0,
                      before != nullptr ? before->design->plant : vehicle.design->plant);
  factor_ = designed_ ? designed_factor(known, before != nullptr) : rated_factor(vehicle.loop);
  loop_zeros_ = static_cast<std::ptrdiff_t>(factor_.factor.zeros.size());
  for (const LinkFilter& link : links_) {
    if (!link.has_losses()) continue;
    const GainFactor& losses = link.losses().factor();
    if (links_.size() == 1) {
      factor_.exact = losses;
    } else {
      std::vector<std::complex<long double>>& poles = factor_.factor.poles;
      poles.insert(poles.end(), losses.poles.begin(), losses.poles.end());
    }
    if (!designed_ && !link.has_memory()) factor_.rounded.push_back(z_form(link.losses().registers()));
  }
  if (designed_) return;
  const DeltaFraction t = delta_fraction(vehicle.loop);
  near_ = {t.numerator, t.denominator};
  far_ = {recentred(t.numerator), recentred(t.denominator)};
  margin_ = without_zero_at_origin(
      subtract(squared_modulus(near_.denominator, Centre::kOne), squared_modulus(near_.numerator, Centre::kOne)));
}

// The factor without losses, apart from the zeros of a vehicle with a radio, which depend on those of both links. The
// poles are those of T. The zeros do not depend on the headway unless the controller does.
RatedFactor LinkedVehicle::designed_factor(const LinkedVehicle* known, bool behind_other) const {
  const bool has_radio = vehicle_.radio() != nullptr;
  if (known != nullptr && !vehicle_.design->divide_by_one_plus_headway &&
      (has_radio ? known->vehicle_.inputs == vehicle_.inputs : known->vehicle_.radio() == nullptr)) {
    const auto zeros = known->factor_.factor.zeros.begin();
    return {{poles_of(vehicle_.loop), {zeros, zeros + known->loop_zeros_}}, {}};
  }
  if (!has_radio && !behind_other) return rated_factor(vehicle_.loop);
  const auto transfer = [this](std::size_t link) {
    const bool loses = link < links_.size() && links_[link].has_losses();
    return loses ? links_[link].losses().transfer() : ExactTransfer{{Exact(1)}, {Exact(1)}};
  };
  const DesignedGain::Links links{0.0L, 0.0L, links_.front().delay(), links_.back().delay()};
  return {{poles_of(vehicle_.loop), designed_->zeros(transfer(0), transfer(1), links)}, {}};
}

LinkedVehicleValue LinkedVehicle::at(const CirclePoint& point) const {
  MeanEffects effects;
  for (std::size_t j = 0; j < links_.size(); ++j) effects[j] = links_[j].losses().at(point);
  return at(point, effects);
}

LinkedVehicleValue LinkedVehicle::at(const CirclePoint& point, const MeanEffects& effects) const {
  const bool near = point.centre == Centre::kOne;
  const Complex s = point.offset, z = s + (near ? 1.0L : -1.0L);
  const long double t = std::abs(s.real()), x = near ? t : 2.0L - t, h = vehicle_.headway;
  LinkedVehicleValue value{};
  value.spacing_gain = static_cast<double>(1.0L + 2.0L * h * (1.0L + h) * x);
  const Complex response =  // T^ z^m
      designed_ ? designed_response(point, effects, value) : given_response(point, effects[0], value);
  const Complex policy = Complex(1.0L + h) - h * std::conj(z), undelayed = policy * response;
  const Complex delay = power(std::conj(z), vehicle_.position().link.delay), mean = delay * undelayed;
  value.gain = static_cast<double>(std::norm(response));
  value.complement = static_cast<double>(std::norm(1.0L - mean));
  value.of_gap = static_cast<double>(std::norm(1.0L - delay * response));
  value.undelayed = static_cast<std::complex<double>>(undelayed);
  value.response = static_cast<std::complex<double>>(response);
  return value;
}

// Sets all fields that depend on how the vehicle is built, and returns T^ without the delay of the position.
Complex LinkedVehicle::designed_response(const CirclePoint& point, const MeanEffects& effects,
                                         LinkedVehicleValue& value) const {
  const bool has_radio = links_.size() > 1;
  const DesignedGain::Links links{effects[0].excess, effects[1].excess, links_.front().delay(), links_.back().delay()};
  const DesignedGain::Value loop = designed_->at(point, links);
  Complex response = effects[0].passed * loop.position;
  value.input[0] = input_value(links_[0], point, loop.position, response);
  if (has_radio) {
    value.input[1] = input_value(links_[1], point, loop.input, effects[1].passed * loop.input);
    response += effects[1].passed * loop.through_input;
  }
  value.sent = static_cast<double>(loop.sent);
  value.margin = std::isinf(loop.excess) ? 1.0 : static_cast<double>(loop.excess / (1.0L + loop.excess));
  return response;
}

Complex LinkedVehicle::given_response(const CirclePoint& point, const LossFilter::Value& effect,
                                      LinkedVehicleValue& value) const {
  const bool near = point.centre == Centre::kOne;
  const Half& part = near ? near_ : far_;
  const Complex s = point.offset;
  const Complex numerator = evaluate(part.numerator, s), denominator = evaluate(part.denominator, s);
  const long double over = std::norm(denominator), t = std::abs(s.real());
  const Complex transfer = numerator * std::conj(denominator) / over, response = effect.passed * transfer;
  value.input[0] = input_value(links_[0], point, transfer, response);
  const long double gain = std::norm(transfer);
  long double margin = 1.0L - gain;
  if (near && gain > 0.25L) {
    // Uses the polynomial if the difference 1 - |T|^2 cancels, and the difference if the polynomial cancels.
    const long double size = std::sqrt(2.0L * t);
    const auto share = [size](const CirclePolynomial& b, long double squared) {
      return magnitude(b, size) / std::sqrt(squared);
    };
    const long double doubt = share(part.denominator, over) + gain * share(part.numerator, std::norm(numerator));
    if (magnitude(margin_, t) * t <= 2.0L * doubt * over) margin = evaluate(margin_, t) * t / over;
  }
  const long double of_losses = effect.squared_excess();
  value.margin = static_cast<double>(margin + gain * of_losses / (1.0L + of_losses));
  return response;
}

ZerosAtZero LinkedVehicle::zeros_at_zero() const {
  ZerosAtZero zeros{1, ZerosAtZero::kNone, ZerosAtZero::kNone};
  const LinkFilter& position = links_.front();
  if (lag() == 0.0) {
    zeros.complement = complement_zeros();
    if (position.has_losses()) zeros.complement = std::min(zeros.complement, position.losses().surprise_zeros());
  }
  if (position.has_losses()) zeros.innovation = position.losses().surprise_zeros();
  zeros.noise = position.noise_zeros();
  if (vehicle_.radio() == nullptr) return zeros;
  // At w = 0 u = y / G vanishes like the double integrator of the plant, and N_input like the integrators of K.
  const LinkFilter& input = links_.back();
  const LoopDesign& design = *vehicle_.design;
  if (input.has_losses())
    zeros.innovation = std::min(zeros.innovation, input.losses().surprise_zeros() + design.plant.integrators());
  zeros.noise = std::min(zeros.noise, input.noise_zeros() + design.controller.exact().integrators());
  return zeros;
}

// Multiplicity of z = 1 as a zero of 1 - H T^ without lag and without losses of the position.
int LinkedVehicle::complement_zeros() const {
  if (vehicle_.radio() != nullptr) return *vehicle_.loop.integrators + feed_forward_zeros();
  if (designed_) return *vehicle_.loop.integrators;
  // 1 - H T = (z D - ((1 + h) z - h) N) / (z D), with two zeros at s = 0, as there is no lag.
  const DeltaFraction t = delta_fraction(vehicle_.loop);
  const long double h = vehicle_.headway;
  const CirclePolynomial open = multiply({1.0L, 1.0L}, t.denominator), closed = multiply({1.0L, 1.0L + h}, t.numerator);
  return leading_zeros(subtract(open, closed), subtract(moduli(open), scaled(moduli(closed), -1.0L)), 2);
}

// Multiplicity of z = 1 as a zero of 1 - F z^-m T_L G / G_before, the part of the predecessor's input that feed-forward
// leaves.
int LinkedVehicle::feed_forward_zeros() const {
  const LinkFilter& input = links_.back();
  const bool is_held = !input.has_losses() || !input.losses().loss().predictor.empty();
  return is_held ? designed_->zeros_of_difference() : 0;
}

std::vector<std::complex<double>> LinkedVehicle::pole_frequencies() const {
  std::vector<std::complex<double>> found = frequencies_of(factor_.factor.poles);
  const std::vector<std::complex<double>> of_losses = frequencies_of(factor_.exact.poles);
  found.insert(found.end(), of_losses.begin(), of_losses.end());
  for (const LinkFilter& link : links_) {
    for (const std::complex<double>& w : link.noise_frequencies()) found.push_back(w);
  }
  if (vehicle_.radio() == nullptr) return found;
  // The difference of the delays rotates T^; a panel may cover two radians.
  const auto turns = static_cast<double>(std::max(links_[0].delay(), links_[1].delay()) + designed_->plant_turns());
  for (int k = 0; k <= boost::math::double_constants::pi * turns; ++k) found.emplace_back(k / turns, 1.0 / turns);
  return found;
}

bool LinkedVehicle::is_of(const VehicleModel& vehicle) const {
  return vehicle.headway == vehicle_.headway && vehicle.inputs == vehicle_.inputs;
}

double LinkedVehicle::loss_feedback() const {
  double largest = 0.0;
  for (const LinkFilter& link : links_) largest = std::max(largest, link.losses().feedback());
  return largest;
}

bool LinkedVehicle::has_memory() const {
  return std::any_of(links_.begin(), links_.end(), [](const LinkFilter& link) { return link.has_memory(); });
}

bool LinkedVehicle::has_losses() const {
  return std::any_of(links_.begin(), links_.end(), [](const LinkFilter& link) { return link.has_losses(); });
}

}  // namespace platoon
