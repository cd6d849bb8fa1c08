#include "stochastic_platoon/math/string/string_stability.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/settled_hearing.hpp"

namespace platoon {

namespace {

/// Why predictions from predictions grow.
std::string growth_reason(const PlatoonModel& model, double growth) {
  if (!has_bursts(model))
    return "p q ||L F||^2 = " + beside_one(growth) + " is not below 1, so that predictions from predictions grow";
  return "the second moments of predictions from predictions grow by " + beside_one(growth) +
         " a step, which is not below 1";
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

/// Judges the loss gain of a string whose gain is below 1: sets the reason of a negative verdict. True if it is
/// below 1.
bool judge_losses(const StringEnd& end, const PlatoonModel& model, StringStability& verdict) {
  verdict.undecided = end.is_undecided();
  if (verdict.undecided) {
    verdict.reason = formatted(
        "undecided: the loss gain is 1 to %.0e, so that rounding decides whether the variance that losses add grows along the string",
        end.doubt);
    return false;
  }
  if (end.loss_gain < 1.0) return true;
  verdict.reason = "not string stable: " + loss_gain_text(verdict, "above 1") + ": the variance that " +
                   (has_bursts(model) ? "losses in bursts" : "losses") + " add grows along the string";
  return false;
}

/// Judges a mean square stable string.
void judge(const StringTheory& theory, bool with_limit, StringStability& verdict) try {
  const PlatoonModel& model = theory.model();
  if (!judge(theory.judged_gain(), model, verdict)) return;
  const StringEnd end = theory.end(with_limit);
  const bool has_stage = any_link(model, [](const LinkModel& link) { return link.loss.has_value(); });
  if (has_stage && end.has_digits) verdict.loss_gain = end.loss_gain;
  if (!judge_losses(end, model, verdict)) return;
  verdict.string_stable = true;
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

StringStability string_stability(const StringTheory& theory, bool with_limit) {
  StringStability verdict;
  verdict.spectral_radius = theory.spectral_radius();
  verdict.mean_square_stable = theory.mean_square_stable();
  if (verdict.mean_square_stable) {
    judge(theory, with_limit, verdict);
  } else if (verdict.spectral_radius >= 1.0) {
    verdict.reason = "not mean square stable: rho(A) = " + beside_one(verdict.spectral_radius) + " is not below 1";
  } else {
    verdict.reason = "not mean square stable: " + growth_reason(theory.model(), theory.growth());
  }
  return verdict;
}

double string_margin(const StringTheory& theory) try {
  const double gain = theory.gain_margin();
  if (!(gain > 0.0) || !loses(theory.model())) return gain;
  return std::min(gain, 1.0 - theory.loss_gain_beside_one());
} catch (const NarrowSpectra&) {
  return -1.0;
}

}  // namespace platoon
