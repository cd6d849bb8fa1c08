#include "stochastic_platoon/math/string/string_stability.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "stochastic_platoon/math/links/linked_string.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/hearing_gain.hpp"
#include "stochastic_platoon/math/string/hearing_string.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"

namespace platoon {

namespace {

/// What differs in verdicts with a memory of losses.
struct Wording {
  const char* losses;
  std::string growth;  ///< of predictions from predictions
  double doubt;        ///< accuracy of the loss gain
};

Wording wording(const LinkedPattern& pattern) {
  const std::string growth = beside_one(pattern.loss_feedback());
  if (!pattern.has_memory())
    return {"losses", "p q ||L F||^2 = " + growth + " is not below 1, so that predictions from predictions grow",
            1e-12};
  return {"losses in bursts",
          "the second moments of predictions from predictions grow by " + growth + " a step, which is not below 1",
          1e-11};
}

const char* name_of_gain(const VehicleModel& first, std::size_t vehicles) {
  if (vehicles > 1) return "|T^| of one pattern";
  if (first.radio() != nullptr) return "|Gamma|";
  return first.position().link.is_white_noise_only() ? "|T|" : "|T^|";
}

/// Judges |prod T^| alone: sets the peak, mean_bounded and, for a negative verdict, the reason. True if |prod T^| < 1
/// for all w > 0.
bool judge_gain(const PatternGain& gain, const std::string& name, double sample_period, StringStability& verdict) {
  verdict.peak_gain = 1.0;
  verdict.peak_frequency = 0.0;
  const LeastMargin least = gain.least();
  if (least.sign == Sign::kBelow) {
    const PatternGain::Peak peak = gain.peak();
    verdict.peak_gain = 1.0 + peak.excess;
    verdict.peak_frequency = peak.frequency;
    verdict.reason = formatted("not string stable: %s exceeds 1 by %.6g at %s", name.c_str(), peak.excess,
                               frequency_text(peak.frequency, sample_period).c_str());
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
      "undecided: %s is 1 at %s to the rounding of the model's numbers, so that they do not determine whether it stays below 1",
      name.c_str(), frequency_text(least.frequency, sample_period).c_str());
  return false;
}

/// Judges the loss gain of a string that judge_gain() accepts: sets the reason of a negative verdict. True if it is
/// below 1.
bool judge_losses(double loss_gain, const Wording& words, StringStability& verdict) {
  verdict.undecided = std::abs(loss_gain - 1.0) <= words.doubt;
  if (verdict.undecided) {
    verdict.reason = formatted(
        "undecided: the loss gain is 1 to %.0e, so that rounding decides whether the variance that losses add grows along the string",
        words.doubt);
    return false;
  }
  if (loss_gain < 1.0) return true;
  verdict.reason = "not string stable: the loss gain is " + beside_one(loss_gain) + ", above 1: the variance that " +
                   words.losses + " add grows along the string";
  return false;
}

/// Judges a mean square stable string.
void judge(const LinkedPattern& pattern, const PlatoonModel& model, StringStability& verdict) {
  const std::string name = name_of_gain(pattern.types.front().vehicle(), pattern.size());
  const PatternGain gain = pattern.gain();
  if (!judge_gain(gain, name, model.sample_period, verdict)) return;
  if (pattern.grows_at_zero(gain)) {
    verdict.reason = "not string stable: " + name + " < 1 for all w > 0, but 1 - " + name +
                     "^2 vanishes so fast at w = 0 that the variances grow without bound";
    return;
  }
  const double losses = loss_gain(pattern);
  const bool has_stage = std::any_of(pattern.types.begin(), pattern.types.end(), [](const auto& v) {
    return v.vehicle().position().link.loss || v.vehicle().varied_link().loss;
  });
  if (has_stage) verdict.loss_gain = losses;
  if (!judge_losses(losses, wording(pattern), verdict)) return;
  verdict.string_stable = true;
  const std::vector<double> limits = limit_variances(pattern, metres_per_step(model));
  verdict.limit_variance = *std::max_element(limits.begin(), limits.end());
  const std::string radius = beside_one(verdict.spectral_radius);
  verdict.reason = pattern.has_losses()
                       ? "string stable: rho(A) = " + radius + " is below 1, " + name +
                             " is below 1 for all w > 0, and the loss gain is " + beside_one(losses) + ", below 1"
                       : "string stable: rho(A) = " + radius + " is below 1 and " + name + " is below 1 for all w > 0";
}

}  // namespace

std::string gain_name(const PlatoonModel& model) {
  const std::vector<VehicleModel> vehicles = pattern(model);
  return name_of_gain(vehicles.front(), vehicles.size());
}

std::vector<double> gain_along_string(const PlatoonModel& model, const std::vector<double>& frequencies) {
  std::vector<double> gains;
  if (!hears_predecessors_only(model)) {
    const HearingGain gain(model);
    for (const double w : frequencies) gains.push_back(gain(w));
    return gains;
  }
  const LinkedPattern pattern(model);
  for (const double w : frequencies) {
    double product = 1.0;
    for (std::size_t i = 0; i < pattern.size(); ++i) product *= pattern[i].at(w).gain;
    gains.push_back(std::sqrt(product));
  }
  return gains;
}

StringStability string_stability(const PlatoonModel& model) {
  if (!hears_predecessors_only(model)) return hearing_stability(model);
  const LinkedPattern pattern(model);
  StringStability verdict;
  verdict.spectral_radius = pattern.spectral_radius();
  verdict.mean_square_stable = pattern.mean_square_stable();
  if (verdict.mean_square_stable) {
    judge(pattern, model, verdict);
  } else if (verdict.spectral_radius >= 1.0) {
    verdict.reason = "not mean square stable: rho(A) = " + beside_one(verdict.spectral_radius) + " is not below 1";
  } else {
    verdict.reason = "not mean square stable: " + wording(pattern).growth;
  }
  return verdict;
}

}  // namespace platoon
