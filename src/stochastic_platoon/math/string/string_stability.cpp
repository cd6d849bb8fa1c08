#include "stochastic_platoon/math/string/string_stability.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/links/linked_string.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/hearing_gain.hpp"
#include "stochastic_platoon/math/string/hearing_string.hpp"
#include "stochastic_platoon/math/string/settled_hearing.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/varied_pattern.hpp"

namespace platoon {

namespace {

/// Why predictions from predictions grow.
std::string growth_reason(const PlatoonModel& model, double growth) {
  if (!has_bursts(model))
    return "p q ||L F||^2 = " + beside_one(growth) + " is not below 1, so that predictions from predictions grow";
  return "the second moments of predictions from predictions grow by " + beside_one(growth) +
         " a step, which is not below 1";
}

JudgedGain judged_gain(const LinkedPattern& pattern) {
  const PatternGain gain = pattern.gain();
  const LeastMargin least = gain.least();
  if (least.sign == Sign::kBelow) {
    const PatternGain::Peak peak = gain.peak();
    return {least.sign, peak.excess, peak.frequency};
  }
  JudgedGain judged{least.sign, 0.0, 0.0, least.sign == Sign::kZero && gain.is_one()};
  if (least.sign == Sign::kZero && !judged.is_one) judged.frequency = least.frequency;
  judged.grows_at_zero = least.sign == Sign::kAbove && pattern.grows_at_zero(gain);
  return judged;
}

/// Returns whether the gain is below 1 for all w > 0 and the variances of the noise stay bounded. Sets the peak,
/// mean_bounded and, if it returns false, the reason.
bool judge(const JudgedGain& gain, const PlatoonModel& model, StringStability& verdict) {
  const std::string name = gain_name(model);
  const std::string at = frequency_text(gain.frequency, model.sample_period);
  verdict.peak_gain = 1.0 + gain.excess;
  verdict.peak_frequency = gain.frequency;
  verdict.mean_bounded = gain.margin != Sign::kBelow;
  if (gain.margin == Sign::kBelow) {
    verdict.reason = formatted("not string stable: %s exceeds 1 by %.6g at %s", name.c_str(), gain.excess, at.c_str());
  } else if (gain.is_one) {
    verdict.reason = "not string stable: " + name +
                     " = 1 at every frequency: the variances grow without bound, though the means stay bounded";
  } else if (gain.margin == Sign::kZero) {
    verdict.undecided = true;
    verdict.reason = formatted(
        "undecided: %s is 1 at %s to the rounding of the model's numbers, so that they do not determine whether it stays below 1",
        name.c_str(), at.c_str());
  } else if (gain.falls_apart) {
    verdict.reason =
        "not string stable: by whom they hear, the vehicles form strings that do not hear each other, and the variances of the distances between these grow without bound";
  } else if (gain.grows_at_zero) {
    verdict.reason = "not string stable: " + name + " < 1 for all w > 0, but 1 - " + name +
                     "^2 vanishes so fast at w = 0 that the variances grow without bound";
  } else {
    return true;
  }
  return false;
}

/// "the loss gain is 0.2, below 1", without a figure of which only the side of 1 is known.
std::string loss_gain_text(const StringStability& verdict, const std::string& side) {
  return "the loss gain is " + (verdict.loss_gain ? beside_one(*verdict.loss_gain) + ", " : std::string()) + side;
}

/// Judges the loss gain, known to `doubt`, of a string whose gain is below 1: sets the reason of a negative verdict.
/// True if it is below 1.
bool judge_losses(double loss_gain, double doubt, const PlatoonModel& model, StringStability& verdict) {
  verdict.undecided = std::abs(loss_gain - 1.0) <= doubt;
  if (verdict.undecided) {
    verdict.reason = formatted(
        "undecided: the loss gain is 1 to %.0e, so that rounding decides whether the variance that losses add grows along the string",
        doubt);
    return false;
  }
  if (loss_gain < 1.0) return true;
  verdict.reason = "not string stable: " + loss_gain_text(verdict, "above 1") + ": the variance that " +
                   (has_bursts(model) ? "losses in bursts" : "losses") + " add grows along the string";
  return false;
}

/// Judges a mean square stable string, by the theory of `pattern` or, without one, by that of hearing_string.
void judge(const LinkedPattern* pattern, const PlatoonModel& model, bool with_limit, StringStability& verdict) try {
  if (!judge(pattern != nullptr ? judged_gain(*pattern) : hearing_gain(model), model, verdict)) return;
  StringEnd end;
  double doubt = 1e-9;
  if (pattern != nullptr) {
    end.loss_gain = loss_gain(*pattern);
    doubt = pattern->has_memory() ? 1e-11 : 1e-12;
  } else {
    end = with_limit ? hearing_limit(model) : StringEnd{{}, 1.0 - hearing_loss_margin(model)};
  }
  const bool has_stage = any_link(model, [](const LinkModel& link) { return link.loss.has_value(); });
  if (has_stage && (pattern != nullptr || !end.variances.empty())) verdict.loss_gain = end.loss_gain;
  if (!judge_losses(end.loss_gain, doubt, model, verdict)) return;
  verdict.string_stable = true;
  if (pattern != nullptr && with_limit) end.variances = limit_variances(*pattern, metres_per_step(model));
  if (!end.variances.empty()) verdict.limit_variance = *std::max_element(end.variances.begin(), end.variances.end());
  verdict.reason = "string stable: rho(A) = " + beside_one(verdict.spectral_radius) + " is below 1" +
                   (loses(model) ? ", " : " and ") + gain_name(model) + " is below 1 for all w > 0";
  if (loses(model)) verdict.reason += ", and " + loss_gain_text(verdict, "below 1");
} catch (const NarrowSpectra& narrow) {
  verdict.undecided = true;
  verdict.reason = std::string("undecided: ") + narrow.what() + " along an endless string";
}

}  // namespace

std::string gain_name(const PlatoonModel& model) {
  const std::size_t vehicles = type_order(model).size();
  const VehicleModel& first = vehicle(model, 1);
  if (!hears_predecessors_only(model))
    return farthest_ahead(model) == 1 && vehicles == 1 ? "|T|" : "the spectral radius of the string's companion matrix";
  if (vehicles > 1) return "|T^| of one pattern";
  if (first.radio() != nullptr) return "|Gamma|";
  return first.position().link.is_white_noise_only() ? "|T|" : "|T^|";
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

StringStability string_stability(const PlatoonModel& model, bool cross_spectra, bool with_limit) {
  std::optional<LinkedPattern> pattern;
  if (hears_predecessors_only(model) && !cross_spectra) pattern.emplace(model);
  StringStability verdict;
  verdict.spectral_radius = pattern ? pattern->spectral_radius() : hearing_spectral_radius(model);
  const double growth = pattern ? pattern->loss_feedback() : hearing_growth(model);
  verdict.mean_square_stable = verdict.spectral_radius < 1.0 && growth < 1.0;
  if (verdict.mean_square_stable) {
    judge(pattern ? &*pattern : nullptr, model, with_limit, verdict);
  } else if (verdict.spectral_radius >= 1.0) {
    verdict.reason = "not mean square stable: rho(A) = " + beside_one(verdict.spectral_radius) + " is not below 1";
  } else {
    verdict.reason = "not mean square stable: " + growth_reason(model, growth);
  }
  return verdict;
}

double string_margin(const PlatoonModel& model) {
  const VariedMargins margins = varied_margins([&model](double) { return model; }, 0.0);
  const double gain = margins.gain(0.0);
  if (!(gain > 0.0) || !loses(model)) return gain;
  const double losses = margins.losses(0.0);  // 1 / loss gain - 1 where vehicles hear their predecessors
  return std::min(gain, hears_predecessors_only(model) ? 1.0 - 1.0 / (1.0 + losses) : losses);
}

}  // namespace platoon
