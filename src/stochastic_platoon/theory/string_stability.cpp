#include "stochastic_platoon/theory/string_stability.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "stochastic_platoon/theory/loop_spectrum.hpp"
#include "stochastic_platoon/theory/quadrature.hpp"

namespace platoon {

namespace {

enum class Margin { kPositive, kTouches, kNegative };

struct MarginVerdict {
  Margin margin;
  double frequency;  ///< where |T| touches or exceeds 1
};

std::string text(const char* format, double first, double second) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, first, second);
  return buffer;
}

/// The frequencies where 1 - |T|^2 may be smallest, relative to its zero at w = 0.
std::vector<double> margin_minima(const LoopSpectrum& spectrum) {
  std::vector<double> frequencies{0.0, frequency_at(0.0L, Centre::kMinusOne)};
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    const CirclePolynomial slope = derivative(spectrum.about(centre).stripped_margin);
    for (const long double t : sign_changes(slope, 0.0L, 1.0L)) frequencies.push_back(frequency_at(t, centre));
    frequencies.push_back(frequency_at(1.0L, centre));
  }
  return frequencies;
}

/// Sign of the polynomial |D|^2 - |N|^2 over w in [0, pi], its zero at w = 0 divided out.
MarginVerdict margin_verdict(const LoopSpectrum& spectrum) {
  MarginVerdict verdict{Margin::kPositive, 0.0};
  for (const double w : margin_minima(spectrum)) {
    const double value = spectrum.stripped_margin(w);
    const double uncertainty = spectrum.margin_uncertainty(w);
    if (value < -uncertainty) return {Margin::kNegative, w};
    if (value <= uncertainty) verdict = {Margin::kTouches, w};
  }
  return verdict;
}

/// Mean over the circle of |HT|^2 + |T|^2 |S|^2 / (1 - |T|^2).
double mean_limit_spectrum(const LoopSpectrum& spectrum) {
  std::vector<std::complex<double>> singular = spectrum.pole_frequencies();
  for (const std::complex<double>& w : spectrum.margin_frequencies()) singular.push_back(w);
  double coarse = std::numeric_limits<double>::quiet_NaN();
  for (int refinement = 0; refinement <= 5; ++refinement) {
    const Quadrature rule = half_circle_quadrature(singular, {}, refinement);
    long double sum = 0.0L;
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      const LoopSpectrumValue value = spectrum.at(rule.node[k]);
      sum += rule.weight[k] * (value.complement + value.gain * value.ratio);
    }
    const auto fine = static_cast<double>(sum);
    if (std::abs(fine - coarse) <= 1e-13 * fine) return fine;
    coarse = fine;
  }
  return coarse;
}

/// Sets the peak of |T| where it exceeds 1, and returns |T|^2 - 1 there, which may be below the digits of |T|.
double find_peak(const LoopSpectrum& spectrum, StringStability& verdict) {
  double excess = 0.0;
  for (const double w : spectrum.critical_frequencies()) {
    const LoopSpectrumValue value = spectrum.at(w);
    if (-value.known_margin <= excess) continue;
    excess = -value.known_margin;
    verdict.peak_gain = std::sqrt(1.0 + excess);
    verdict.peak_frequency = w;
  }
  return excess;
}

}  // namespace

StringStability string_stability(const PlatoonModel& model) {
  const LoopSpectrum spectrum(model.loop, model.headway);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  StringStability result{spectral_radius(model.loop.realization), nan, nan, false, false, false, {}, {}};
  if (!(result.spectral_radius < 1.0)) {
    result.reason = text("not mean square stable: rho(A) = %.6g is not below 1", result.spectral_radius, 0.0);
    return result;
  }
  result.mean_square_stable = true;
  result.peak_gain = 1.0;  // T(1) = 1
  result.peak_frequency = 0.0;
  const MarginVerdict verdict = margin_verdict(spectrum);
  if (verdict.margin == Margin::kNegative) {
    const double excess = find_peak(spectrum, result);
    result.reason = text("not string stable: |T| exceeds 1 by %.6g at %.6g rad/sample",
                         excess / (1.0 + result.peak_gain), result.peak_frequency);
    return result;
  }
  result.mean_bounded = true;
  if (verdict.margin == Margin::kTouches) {
    result.peak_frequency = verdict.frequency;
    result.reason = text("not string stable: |T| = 1 at %.6g rad/sample, where the variances grow without bound, "
                         "though the means stay bounded",
                         verdict.frequency, 0.0);
    return result;
  }
  if (spectrum.margin_zeros() > spectrum.sensitivity_zeros()) {
    result.reason = "not string stable: |T| < 1 for all w > 0, but 1 - |T|^2 vanishes so fast at w = 0 that the "
                    "variances grow without bound";
    return result;
  }
  result.string_stable = true;
  result.limit_variance = mean_limit_spectrum(spectrum) * model.noise_variance;
  result.reason = text("string stable: rho(A) = %.6g is below 1 and |T| is below 1 for all w > 0",
                       result.spectral_radius, 0.0);
  return result;
}

}  // namespace platoon
