#include "stochastic_platoon/theory/linked_vehicle.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "stochastic_platoon/theory/loop_spectrum.hpp"

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

Complex evaluate_at(const CirclePolynomial& p, Complex s) {
  Complex sum = 0.0L;
  for (auto c = p.rbegin(); c != p.rend(); ++c) sum = sum * s + *c;
  return sum;
}

CirclePolynomial scaled(CirclePolynomial p, long double factor) {
  for (long double& c : p) c *= factor;
  return p;
}

// z - c on the circle, without cancellation.
Complex offset(double frequency, Centre centre) {
  const long double half = static_cast<long double>(frequency) / 2.0L;
  const long double sine = std::sin(half), cosine = std::cos(half);
  return {centre == Centre::kOne ? -2.0L * sine * sine : 2.0L * cosine * cosine, 2.0L * sine * cosine};
}

// z^n of a z on the circle.
Complex power(Complex z, std::size_t n) {
  constexpr std::size_t kFew = 8;
  if (n > kFew) return std::polar(1.0L, static_cast<long double>(n) * std::arg(z));
  Complex product = 1.0L;
  for (std::size_t j = 0; j < n; ++j) product *= z;
  return product;
}

}  // namespace

LinkedVehicle::Half LinkedVehicle::half(const CirclePolynomial& numerator,
                                        const CirclePolynomial& denominator,
                                        const CirclePolynomial& registers, const CirclePolynomial& surprise,
                                        Centre centre) const {
  const long double p = 1.0L - static_cast<long double>(loss_.probability);
  Half result{numerator, denominator, registers, surprise, {}, {}, {}};
  result.gain_numerator = scaled(squared_modulus(numerator, centre), p * p);
  result.gain_denominator =
      multiply(squared_modulus(denominator, centre), squared_modulus(registers, centre));
  result.margin = subtract(result.gain_denominator, result.gain_numerator);
  if (centre == Centre::kOne) result.margin = without_zero_at_origin(result.margin);
  return result;
}

LinkedVehicle::LinkedVehicle(const VehicleModel& vehicle)
    : vehicle_(vehicle), loss_(vehicle.link.loss.value_or(LossModel())) {
  if (!loss_.is_independent())
    throw std::invalid_argument("mean_burst: given: must be absent for this theory");
  spectral_radius_ = platoon::spectral_radius(vehicle.loop);
  loss_feedback_ = platoon::loss_feedback(loss_);
  const DeltaFraction t = delta_fraction(vehicle.loop);
  const CirclePolynomial registers = register_polynomial(loss_.predictor, loss_.probability);
  const CirclePolynomial surprise = register_polynomial(loss_.predictor, 1.0);
  near_ = half(t.numerator, t.denominator, registers, surprise, Centre::kOne);
  far_ = half(recentred(t.numerator), recentred(t.denominator), recentred(registers), recentred(surprise),
              Centre::kMinusOne);
}

const CirclePolynomial& LinkedVehicle::gain_numerator(Centre centre) const {
  return (centre == Centre::kOne ? near_ : far_).gain_numerator;
}

const CirclePolynomial& LinkedVehicle::gain_denominator(Centre centre) const {
  return (centre == Centre::kOne ? near_ : far_).gain_denominator;
}

LinkedVehicleValue LinkedVehicle::at(double frequency) const {
  const Centre centre = nearest(frequency);
  const bool near = centre == Centre::kOne;
  const Half& part = near ? near_ : far_;
  const Complex s = offset(frequency, centre), z = s + (near ? 1.0L : -1.0L);
  const long double t = std::abs(s.real()), x = near ? t : 2.0L - t, h = vehicle_.headway;
  const Complex numerator = evaluate_at(part.numerator, s);
  const Complex denominator = evaluate_at(part.denominator, s), registers = evaluate_at(part.registers, s);
  const long double of_loop = std::norm(denominator), of_link = std::norm(registers);
  // F T and T^, by one division.
  const Complex passed =
      power(z, loss_.predictor.size()) * numerator * std::conj(denominator * registers) / (of_loop * of_link);
  const long double p = 1.0L - static_cast<long double>(loss_.probability);
  const Complex mean = p * power(std::conj(z), vehicle_.link.delay) * passed;
  const Complex policy = Complex(1.0L + h) - h * std::conj(z);
  const long double margin = evaluate(part.margin, t) * (near ? t : 1.0L) / (of_loop * of_link);
  const double coloured = vehicle_.link.has_white_noise()
                              ? 1.0
                              : std::norm(vehicle_.link.noise_filter(static_cast<std::complex<double>>(z)));
  const double quantisation = vehicle_.link.quantisation_step;
  return {static_cast<double>(std::norm(mean)),
          static_cast<double>(margin),
          static_cast<double>(std::norm(passed)),
          static_cast<double>(std::norm(evaluate_at(part.surprise, s)) / of_link),
          coloured * vehicle_.noise_variance + quantisation * quantisation / 12.0,
          static_cast<double>(std::norm(1.0L - policy * mean)),
          static_cast<double>(1.0L + 2.0L * h * (1.0L + h) * x)};
}

std::vector<std::complex<double>> LinkedVehicle::pole_frequencies() const {
  std::vector<std::complex<double>> found = singular_frequencies(near_.denominator);
  for (const CirclePolynomial& p : {near_.registers, delta_form(vehicle_.link.noise_filter.denominator())}) {
    if (p.size() < 2) continue;
    for (const std::complex<double>& w : singular_frequencies(p)) found.push_back(w);
  }
  return found;
}

double LinkedVehicle::loss_factor() const {
  const double q = loss_.probability;
  return q * (1.0 - q) / (1.0 - loss_feedback_);
}

double LinkedVehicle::mean_innovation() const {
  if (!has_losses()) return 0.0;
  double sum = 0.0;
  for (std::size_t j = 0; j < loss_.predictor.size(); ++j)
    sum += static_cast<double>(j + 1) * loss_.predictor[j];
  return sum / (1.0 - loss_.probability);
}

double LinkedVehicle::lag() const {
  return static_cast<double>(vehicle_.link.delay) + loss_.probability * mean_innovation();
}

std::vector<LinkedVehicle> linked_pattern(const PlatoonModel& model) {
  std::vector<LinkedVehicle> vehicles;
  for (const VehicleModel& vehicle : pattern(model)) vehicles.emplace_back(vehicle);
  return vehicles;
}

}  // namespace platoon
