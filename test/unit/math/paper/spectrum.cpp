#include "unit/math/paper/spectrum.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/paper/lemma_one.hpp"
#include "stochastic_platoon/math/string/loop_spectrum.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"

namespace platoon {

namespace {

/// The real polynomial with these zeros, which come in conjugate pairs.
Polynomial from_zeros(const std::vector<std::complex<double>>& zeros) {
  Eigen::VectorXcd p = Eigen::VectorXcd::Ones(1);
  for (const std::complex<double>& zero : zeros) {
    Eigen::VectorXcd next = Eigen::VectorXcd::Zero(p.size() + 1);
    next.head(p.size()) = p;
    next.tail(p.size()) -= zero * p;
    p = next;
  }
  return p.real();
}

}  // namespace

std::vector<double> error_spectra(const PlatoonModel& model, std::size_t followers, double frequency) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (!(frequency >= 0.0 && frequency <= 3.141592653589794)) {
    throw std::invalid_argument("frequency: " + std::to_string(frequency) + ": must be in [0, pi]");
  }
  std::vector<double> spectra(followers, std::numeric_limits<double>::quiet_NaN());
  const LoopSpectrum spectrum(model.default_vehicle().loop, model.default_vehicle().headway);
  if (spectral_radius(model.default_vehicle().loop) >= 1.0) return spectra;
  const LoopSpectrumValue value = spectrum.at(frequency);
  const double input = value.gain * value.sensitivity + value.margin * value.complement;  // 1 - S = HT
  spectra[0] = value.complement * model.default_vehicle().noise_variance;
  for (std::size_t i = 1; i < followers; ++i) {
    spectra[i] = value.gain * spectra[i - 1] + input * model.default_vehicle().noise_variance;
  }
  return spectra;
}

double noise_to_error_norm(const PlatoonModel& model, std::size_t followers) {
  PlatoonModel unit = model;
  unit.default_vehicle().noise_variance = 1.0;
  return std::sqrt(stationary_variances(unit, followers).back());
}

TransferFunction spectral_factor(const PlatoonModel& model) {
  const StringStability stability = string_stability(model);
  if (!stability.string_stable) {
    throw std::invalid_argument("T(z): has no spectral factor M of 1 - T T~: " + stability.reason);
  }
  const LoopSpectrum spectrum(model.default_vehicle().loop, model.default_vehicle().headway);
  std::vector<std::complex<double>> zeros;
  for (const std::complex<double>& t : spectrum.margin_roots()) {
    // 1 - cos w = t in z = e^{jw}: z^2 - 2 (1 - t) z + 1 = 0, a pair z, 1/z.
    const std::complex<double> offset = std::sqrt(t * (t - 2.0));
    const std::complex<double> outer =
        std::abs(1.0 - t + offset) > std::abs(1.0 - t - offset) ? 1.0 - t + offset : 1.0 - t - offset;
    zeros.push_back(1.0 / outer);
  }
  const Polynomial inner = from_zeros(zeros);
  const auto at_one = static_cast<double>(spectrum.about(Centre::kOne).stripped_margin.front());
  const double scale = std::sqrt(at_one / std::pow(2.0, spectrum.margin_zeros())) / inner.sum();
  Polynomial factor = scale * inner;
  for (int i = 0; i < spectrum.margin_zeros(); ++i) factor = multiply(factor, Eigen::Vector2d(1.0, -1.0));
  const Polynomial& denominator = model.default_vehicle().loop.transfer.denominator();
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
