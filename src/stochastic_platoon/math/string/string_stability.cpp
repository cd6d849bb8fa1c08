#include "stochastic_platoon/math/string/string_stability.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "stochastic_platoon/math/numerics/quadrature.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/burst_string.hpp"
#include "stochastic_platoon/math/string/linked_string.hpp"
#include "stochastic_platoon/math/string/loop_spectrum.hpp"

namespace platoon {

namespace {

/// Mean over the circle of |HT|^2 + |T|^2 |S|^2 / (1 - |T|^2).
double mean_limit_spectrum(const LoopSpectrum& spectrum, const PatternGain& gain) {
  std::vector<std::complex<double>> singular = spectrum.pole_frequencies();
  for (const std::complex<double>& w : gain.margin_frequencies()) singular.push_back(w);
  double coarse = std::numeric_limits<double>::quiet_NaN();
  double before = std::numeric_limits<double>::infinity();
  for (int refinement = 0; refinement <= 5; ++refinement) {
    const Quadrature rule = half_circle_quadrature(singular, {0.0}, refinement);
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

}  // namespace

bool judge_gain(const PatternGain& gain, const std::string& name, StringStability& verdict) {
  verdict.peak_gain = 1.0;
  verdict.peak_frequency = 0.0;
  const LeastMargin least = gain.least();
  if (least.sign == Sign::kBelow) {
    const PatternGain::Peak peak = gain.peak();
    verdict.peak_gain = 1.0 + peak.excess;
    verdict.peak_frequency = peak.frequency;
    verdict.reason = formatted("not string stable: %s exceeds 1 by %.6g at %.6g rad/sample", name.c_str(), peak.excess,
                               peak.frequency);
    return false;
  }
  verdict.mean_bounded = true;
  if (least.sign == Sign::kAbove) return true;
  if (gain.is_one()) {
    verdict.reason = "not string stable: " + name +
                     " = 1 at every frequency: the variances grow without bound, though the means stay bounded";
    return false;
  }
  verdict.peak_frequency = least.frequency;
  verdict.undecided = true;
  verdict.reason = formatted(
      "undecided: %s is 1 at %.6g rad/sample to the rounding of the model's coefficients, so that they do not determine whether it stays below 1",
      name.c_str(), least.frequency);
  return false;
}

bool judge_losses(double loss_gain, double doubt, const std::string& losses, StringStability& verdict) {
  verdict.undecided = std::abs(loss_gain - 1.0) <= doubt;
  if (verdict.undecided) {
    verdict.reason = formatted(
        "undecided: the loss gain is 1 to %.0e, so that rounding decides whether the variance that losses add grows along the string",
        doubt);
    return false;
  }
  if (loss_gain < 1.0) return true;
  verdict.reason = "not string stable: the loss gain is " + beside_one(loss_gain) + ", above 1: the variance that " +
                   losses + " add grows along the string";
  return false;
}

std::string reason_of_stability(double spectral_radius, const std::string& name, std::optional<double> loss_gain) {
  const std::string radius = beside_one(spectral_radius);
  return loss_gain ? "string stable: rho(A) = " + radius + " is below 1, " + name +
                         " is below 1 for all w > 0, and the loss gain is " + beside_one(*loss_gain) + ", below 1"
                   : "string stable: rho(A) = " + radius + " is below 1 and " + name + " is below 1 for all w > 0";
}

std::string reason_of_growth_at_zero(const std::string& name) {
  return "not string stable: " + name + " < 1 for all w > 0, but 1 - " + name +
         "^2 vanishes so fast at w = 0 that the variances grow without bound";
}

StringStability string_stability(const PlatoonModel& model) {
  if (has_bursts(model)) return burst_string_stability(model);
  if (!is_papers(model) || model.default_vehicle().loop.parts) return linked_string_stability(model);
  const LoopSpectrum spectrum(model.default_vehicle().loop, model.default_vehicle().headway);
  StringStability verdict;
  verdict.spectral_radius = spectral_radius(model.default_vehicle().loop);
  verdict.mean_square_stable = verdict.spectral_radius < 1.0;
  if (!verdict.mean_square_stable) {
    verdict.reason = "not mean square stable: rho(A) = " + beside_one(verdict.spectral_radius) + " is not below 1";
    return verdict;
  }
  const PatternGain gain({rated_factor(model.default_vehicle().loop)});
  if (!judge_gain(gain, "|T|", verdict)) return verdict;
  if (spectrum.margin_zeros() > spectrum.sensitivity_zeros()) {
    verdict.reason = reason_of_growth_at_zero("|T|");
    return verdict;
  }
  verdict.string_stable = true;
  verdict.limit_variance = mean_limit_spectrum(spectrum, gain) * model.default_vehicle().noise_variance;
  verdict.reason = reason_of_stability(verdict.spectral_radius, "|T|");
  if (model.default_vehicle().link.loss) verdict.loss_gain = 0.0;  // loss probability 0
  return verdict;
}

}  // namespace platoon
