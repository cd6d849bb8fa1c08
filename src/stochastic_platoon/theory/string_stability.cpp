#include "stochastic_platoon/theory/string_stability.hpp"
#include "stochastic_platoon/theory/linked_string.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "stochastic_platoon/theory/least_margin.hpp"
#include "stochastic_platoon/theory/loop_spectrum.hpp"
#include "stochastic_platoon/theory/quadrature.hpp"

namespace platoon {

namespace {

std::string text(const char* format, double first, double second = 0.0) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, first, second);
  return buffer;
}

/// Mean over the circle of |HT|^2 + |T|^2 |S|^2 / (1 - |T|^2).
double mean_limit_spectrum(const LoopSpectrum& spectrum) {
  std::vector<std::complex<double>> singular = spectrum.pole_frequencies();
  for (const std::complex<double>& w : spectrum.margin_frequencies()) singular.push_back(w);
  double coarse = std::numeric_limits<double>::quiet_NaN();
  double before = std::numeric_limits<double>::infinity();
  for (int refinement = 0; refinement <= 5; ++refinement) {
    const Quadrature rule = half_circle_quadrature(singular, {}, refinement);
    long double sum = 0.0L;
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      const LoopSpectrumValue value = spectrum.at(rule.node[k]);
      sum += rule.weight[k] * (value.complement + value.gain * value.ratio);
    }
    const auto fine = static_cast<double>(sum);
    const double change = std::abs(fine - coarse) / fine;
    if (is_converged(change, before)) return fine;
    coarse = fine;
    before = change;
  }
  return coarse;
}

/// Sets the peak of |T|, which exceeds 1 somewhere, and returns |T|^2 - 1 there, which may be below the
/// digits of |T|.
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

/// The verdict for a stable vehicle, which T(1) = 1 gives a peak of 1 at w = 0 to begin with.
void judge(const LoopSpectrum& spectrum, double noise_variance, StringStability& verdict) {
  const LeastMargin least = least_margin(spectrum);
  if (least.sign == Sign::kNegative) {
    const double excess = find_peak(spectrum, verdict);
    verdict.reason = excess > 0.0 ? text("not string stable: |T| exceeds 1 by %.6g at %.6g rad/sample",
                                         excess / (1.0 + verdict.peak_gain), verdict.peak_frequency)
                                  : "not string stable: |T| exceeds 1 close to w = 0";
    return;
  }
  verdict.mean_bounded = true;
  if (least.sign == Sign::kZero) {
    verdict.peak_frequency = least.frequency;
    verdict.reason = text(
        "not string stable: |T| = 1 at %.6g rad/sample, where the variances grow without bound, "
        "though the means stay bounded",
        least.frequency);
  } else if (spectrum.margin_zeros() > spectrum.sensitivity_zeros()) {
    verdict.reason =
        "not string stable: |T| < 1 for all w > 0, but 1 - |T|^2 vanishes so fast at w = 0 that the "
        "variances grow "
        "without bound";
  } else {
    verdict.string_stable = true;
    verdict.limit_variance = mean_limit_spectrum(spectrum) * noise_variance;
    verdict.reason = text("string stable: rho(A) = %.6g is below 1 and |T| is below 1 for all w > 0",
                          verdict.spectral_radius);
  }
}

}  // namespace

StringStability string_stability(const PlatoonModel& model) {
  if (!is_papers(model)) return linked_string_stability(model);
  const LoopSpectrum spectrum(model.loop, model.headway);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  StringStability verdict{spectral_radius(model.loop), nan, nan, false, false, false, {}, {}};
  verdict.mean_square_stable = verdict.spectral_radius < 1.0;
  if (verdict.mean_square_stable) {
    verdict.peak_gain = 1.0;
    verdict.peak_frequency = 0.0;
    judge(spectrum, model.noise_variance, verdict);
    if (model.link.loss && verdict.string_stable) verdict.loss_gain = 0.0;  // nothing is lost
  } else {
    verdict.reason = text("not mean square stable: rho(A) = %.6g is not below 1", verdict.spectral_radius);
  }
  return verdict;
}

}  // namespace platoon
