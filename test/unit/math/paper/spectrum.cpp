#include "unit/math/paper/spectrum.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/paper/string_matrices.hpp"
#include "stochastic_platoon/math/response/pattern_gain.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/zeros.hpp"

namespace platoon {

std::vector<double> error_spectra(const PlatoonModel& model, std::size_t followers, double frequency) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (!(frequency >= 0.0 && frequency <= 3.141592653589794)) {
    throw std::invalid_argument("frequency: " + std::to_string(frequency) + ": must be in [0, pi]");
  }
  std::vector<double> spectra(followers, std::numeric_limits<double>::quiet_NaN());
  if (spectral_radius(model.default_vehicle().loop) >= 1.0) return spectra;
  const std::complex<double> z = std::polar(1.0, frequency), t = model.default_vehicle().loop.transfer(z),
                             ht = headway_policy(model.default_vehicle().headway)(z) * t;
  const double gain = std::norm(t), input = gain * std::norm(1.0 - ht) + (1.0 - gain) * std::norm(ht);
  spectra[0] = std::norm(ht) * model.default_vehicle().position().noise_variance;
  for (std::size_t i = 1; i < followers; ++i)
    spectra[i] = gain * spectra[i - 1] + input * model.default_vehicle().position().noise_variance;
  return spectra;
}

double noise_to_error_norm(const PlatoonModel& model, std::size_t followers) {
  PlatoonModel unit = model;
  unit.default_vehicle().position().noise_variance = 1.0;
  return std::sqrt(stationary_variances(unit, followers).back());
}

TransferFunction spectral_factor(const PlatoonModel& model) {
  const StringStability stability = string_stability(model);
  if (!stability.string_stable) {
    throw std::invalid_argument("T(z): has no spectral factor M of 1 - T T~: " + stability.reason);
  }
  const ClosedLoop& loop = model.default_vehicle().loop;
  const DeltaFraction transfer = delta_fraction(loop);
  const int margin_zeros = PatternGain({rated_factor(loop)}).zeros();
  CirclePolynomial margin =
      subtract(squared_modulus(transfer.denominator, Centre::kOne), squared_modulus(transfer.numerator, Centre::kOne));
  for (int i = 0; i < margin_zeros; ++i) margin = without_zero_at_origin(margin);
  std::vector<std::complex<double>> zeros;
  for (const std::complex<long double>& root : platoon::zeros(margin)) {
    const std::complex<double> t(root);
    // 1 - cos w = t in z = e^{jw}: z^2 - 2 (1 - t) z + 1 = 0, a pair z, 1/z.
    const std::complex<double> offset = std::sqrt(t * (t - 2.0));
    const std::complex<double> outer =
        std::abs(1.0 - t + offset) > std::abs(1.0 - t - offset) ? 1.0 - t + offset : 1.0 - t - offset;
    zeros.push_back(1.0 / outer);
  }
  const Polynomial inner = polynomial_with_all_zeros(zeros);
  const double scale = std::sqrt(static_cast<double>(margin.front()) / std::pow(2.0, margin_zeros)) / inner.sum();
  Polynomial factor = scale * inner;
  for (int i = 0; i < margin_zeros; ++i) factor = multiply(factor, Eigen::Vector2d(1.0, -1.0));
  const Polynomial& denominator = loop.transfer.denominator();
  Polynomial padded = Polynomial::Zero(denominator.size());
  padded.head(factor.size()) = factor;
  return {padded, denominator};
}

double h2_norm(const TransferFunction& transfer) {
  if (transfer.relative_degree() < 0) {
    throw std::invalid_argument("relative degree " + std::to_string(transfer.relative_degree()) +
                                ": must be >= 0 for a finite norm");
  }
  const Polynomial& d = transfer.denominator();
  const Polynomial& n = transfer.numerator();
  const double direct = n.size() == d.size() ? n(0) : 0.0;
  if (d.size() < 2) return std::abs(direct);
  const StateSpace system = observable_canonical({add(n, -direct * d).tail(d.size() - 1), d});
  const Eigen::MatrixXd gramian = solve_discrete_lyapunov(system.a(), system.b() * system.b().transpose());
  const double energy = system.c() * gramian * system.c().transpose();
  return std::sqrt(energy + direct * direct);
}

}  // namespace platoon
