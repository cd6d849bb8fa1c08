#include "stochastic_platoon/math/string/linked_vehicle.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/string/loop_spectrum.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

// z^n - factor (c_1 z^(n-1) + ... + c_n), by powers of z - 1; exactly 1 - factor at z = 1, as the c have sum 1.
CirclePolynomial register_polynomial(const std::vector<double>& c, double factor) {
  Polynomial p(static_cast<Eigen::Index>(c.size()) + 1);
  p(0) = 1.0;
  for (std::size_t j = 0; j < c.size(); ++j) p(static_cast<Eigen::Index>(j) + 1) = -factor * c[j];
  CirclePolynomial shifted = delta_form(p);
  shifted.front() = 1.0L - static_cast<long double>(factor);
  return shifted;
}

CirclePolynomial scaled(CirclePolynomial p, long double factor) {
  for (long double& c : p) c *= factor;
  return p;
}

CirclePolynomial moduli(CirclePolynomial p) {
  for (long double& c : p) c = std::abs(c);
  return p;
}

// Number of lowest coefficients that are zero to the rounding of the sums they result from, at least `known`.
int leading_zeros(const CirclePolynomial& p, const CirclePolynomial& sizes, int known) {
  auto j = static_cast<std::size_t>(known);
  while (j < p.size() && std::abs(p[j]) <= kCoefficientRounding * sizes[j]) ++j;
  return static_cast<int>(j);
}

}  // namespace

LinkedVehicle::LinkedVehicle(const VehicleModel& vehicle)
    : vehicle_(vehicle), loss_(vehicle.link.loss.value_or(LossModel())) {
  if (!loss_.is_independent()) throw std::invalid_argument("mean_burst: given: must be absent for this theory");
  spectral_radius_ = platoon::spectral_radius(vehicle.loop);
  loss_feedback_ = platoon::loss_feedback(loss_);
  const DeltaFraction t = delta_fraction(vehicle.loop);
  near_ = {t.numerator, t.denominator, register_polynomial(loss_.predictor, loss_.probability),
           register_polynomial(loss_.predictor, 1.0)};
  far_ = {recentred(t.numerator), recentred(t.denominator), recentred(near_.registers), recentred(near_.surprise)};
  const long double p = 1.0L - static_cast<long double>(loss_.probability);
  const CirclePolynomial arriving =
      multiply(squared_modulus(near_.denominator, Centre::kOne), squared_modulus(near_.registers, Centre::kOne));
  margin_ = without_zero_at_origin(subtract(arriving, scaled(squared_modulus(near_.numerator, Centre::kOne), p * p)));
  factor_ = rated_factor(vehicle.loop);
  if (vehicle.loop.parts) designed_.emplace(*vehicle.design, vehicle.headway);
  if (has_losses()) {
    for (const std::complex<long double>& s : zeros(near_.registers)) factor_.factor.poles.push_back(s);
    factor_.rounded.push_back(z_form(near_.registers));
  }
}

LinkedVehicleValue LinkedVehicle::at(const CirclePoint& point) const {
  const bool near = point.centre == Centre::kOne;
  const Half& part = near ? near_ : far_;
  const Complex s = point.offset, z = s + (near ? 1.0L : -1.0L);
  const long double t = std::abs(s.real()), x = near ? t : 2.0L - t, h = vehicle_.headway;
  const Complex registers = evaluate(part.registers, s), powers = power(z, loss_.predictor.size());
  const long double of_link = std::norm(registers), p = 1.0L - static_cast<long double>(loss_.probability);
  const Complex surprise = evaluate(part.surprise, s);
  Complex passed;  // F T
  long double margin;
  if (designed_) {
    const DesignedGain::Value loop = designed_->at(point);
    passed = loop.transfer * powers * std::conj(registers) / of_link;
    const Complex predicted = (1.0L - p) / p * surprise / powers;  // 1 / (p F) = 1 + q / p (1 - L)
    const long double of_prediction = 2.0L * predicted.real() + std::norm(predicted);
    const long double excess = loop.excess + of_prediction + loop.excess * of_prediction;
    margin = std::isinf(excess) ? 1.0L : excess / (1.0L + excess);
  } else {
    const Complex numerator = evaluate(part.numerator, s), denominator = evaluate(part.denominator, s);
    const long double of_loop = std::norm(denominator), over = of_loop * of_link;
    passed = powers * numerator * std::conj(denominator * registers) / over;
    const long double gain = p * p * std::norm(passed);
    margin = 1.0L - gain;
    if (near && gain > 0.25L) {
      // Uses the polynomial if the difference 1 - |T^|^2 cancels, and the difference if the polynomial cancels.
      const long double size = std::sqrt(2.0L * t);
      const auto share = [size](const CirclePolynomial& b, long double squared) {
        return magnitude(b, size) / std::sqrt(squared);
      };
      const long double doubt = share(part.denominator, of_loop) + share(part.registers, of_link) +
                                gain * share(part.numerator, std::norm(numerator));
      if (magnitude(margin_, t) * t <= 2.0L * doubt * over) margin = evaluate(margin_, t) * t / over;
    }
  }
  const Complex policy = Complex(1.0L + h) - h * std::conj(z);
  const Complex undelayed = p * policy * passed;
  const Complex mean = power(std::conj(z), vehicle_.link.delay) * undelayed;
  const double coloured = vehicle_.link.has_white_noise()
                              ? 1.0
                              : std::norm(vehicle_.link.noise_filter(static_cast<std::complex<double>>(z)));
  const double quantisation = vehicle_.link.quantisation_step;
  return {static_cast<double>(p * p * std::norm(passed)),
          static_cast<double>(margin),
          static_cast<double>(std::norm(passed)),
          static_cast<double>(std::norm(surprise) / of_link),
          coloured * vehicle_.noise_variance + quantisation * quantisation / 12.0,
          static_cast<double>(std::norm(1.0L - mean)),
          static_cast<double>(1.0L + 2.0L * h * (1.0L + h) * x),
          static_cast<std::complex<double>>(undelayed)};
}

ZerosAtZero LinkedVehicle::zeros_at_zero() const {
  ZerosAtZero zeros{1, 1, 0};
  if (lag() == 0.0 && designed_ && !has_losses()) {
    zeros.complement = *vehicle_.loop.integrators;
  } else if (lag() == 0.0) {
    // 1 - H T^ = (z D R - ((1 + h) z - h) p z^n N) / (z D R), with two zeros at s = 0 as nothing lags.
    const long double h = vehicle_.headway, p = 1.0L - static_cast<long double>(loss_.probability);
    CirclePolynomial open = multiply({1.0L, 1.0L}, multiply(near_.denominator, near_.registers));
    CirclePolynomial closed = scaled(multiply({1.0L, 1.0L + h}, near_.numerator), p);
    for (std::size_t j = 0; j < loss_.predictor.size(); ++j) closed = multiply({1.0L, 1.0L}, closed);
    zeros.complement = leading_zeros(subtract(open, closed), subtract(moduli(open), scaled(moduli(closed), -1.0L)), 2);
  }
  if (has_losses()) {
    const Polynomial surprise = z_form(near_.surprise);
    zeros.innovation = leading_zeros(near_.surprise, delta_form(surprise.cwiseAbs()), 1);
  }
  if (vehicle_.link.quantisation_step == 0.0) {
    const Polynomial& filter = vehicle_.link.noise_filter.numerator();
    zeros.noise = vehicle_.noise_variance == 0.0 ? ZerosAtZero::kNone
                                                 : leading_zeros(delta_form(filter), delta_form(filter.cwiseAbs()), 0);
  }
  return zeros;
}

std::vector<std::complex<double>> LinkedVehicle::pole_frequencies() const {
  std::vector<std::complex<double>> found = frequencies_of(factor_.factor.poles);
  const CirclePolynomial filter = delta_form(vehicle_.link.noise_filter.denominator());
  if (filter.size() < 2) return found;
  for (const std::complex<double>& w : singular_frequencies(filter)) found.push_back(w);
  return found;
}

bool LinkedVehicle::is_of(const VehicleModel& vehicle) const {
  return vehicle.headway == vehicle_.headway && vehicle.link == vehicle_.link;
}

double LinkedVehicle::loss_factor() const {
  const double q = loss_.probability;
  return q * (1.0 - q) / (1.0 - loss_feedback_);
}

double LinkedVehicle::mean_innovation() const {
  if (!has_losses()) return 0.0;
  double sum = 0.0;
  for (std::size_t j = 0; j < loss_.predictor.size(); ++j) sum += static_cast<double>(j + 1) * loss_.predictor[j];
  return sum / (1.0 - loss_.probability);
}

double LinkedVehicle::lag() const {
  return static_cast<double>(vehicle_.link.delay) + loss_.probability * mean_innovation();
}

PatternGain LinkedPattern::gain() const {
  std::vector<RatedFactor> factors;
  for (std::size_t type = 0; type < types.size(); ++type) {
    factors.push_back(types[type].factor());
    factors.back().factor.count = static_cast<long double>(std::count(order.begin(), order.end(), type));
  }
  return PatternGain(std::move(factors));
}

LinkedPattern linked_pattern(const PlatoonModel& model, const LinkedPattern& known) {
  LinkedPattern found;
  std::map<std::size_t, std::size_t> place;  // model type -> index in found.types
  for (const std::size_t type : type_order(model)) {
    const auto inserted = place.emplace(type, found.types.size());
    if (inserted.second) {
      const VehicleModel& vehicle = model.types[type].vehicle;
      const bool is_known = found.types.size() < known.types.size() && known.types[found.types.size()].is_of(vehicle);
      found.types.push_back(is_known ? known.types[found.types.size()] : LinkedVehicle(vehicle));
    }
    found.order.push_back(inserted.first->second);
  }
  return found;
}

}  // namespace platoon
