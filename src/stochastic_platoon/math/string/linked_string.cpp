#include "stochastic_platoon/math/string/linked_string.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/refinement.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/burst_string.hpp"
#include "stochastic_platoon/math/string/pattern_gain.hpp"
#include "stochastic_platoon/math/string/pattern_means.hpp"
#include "stochastic_platoon/math/string/pattern_spectra.hpp"

namespace platoon {

namespace {

constexpr double kQuadratureDoubt = 1e-12;  // accuracy of the quadrature

/// Whether 1 - |prod T^|^2 vanishes faster at w = 0 than the numerators it divides in a variance: the noises, times |1
/// - H T^|^2 for the errors and |1 - L|^2 for the losses.
bool grows_at_zero(const LinkedPattern& pattern, const PatternGain& gain) {
  int noise = any_losses(pattern) ? 0 : ZerosAtZero::kNone, passed = ZerosAtZero::kNone;
  for (const LinkedVehicle& vehicle : pattern.types) {
    const ZerosAtZero zeros = vehicle.zeros_at_zero();
    noise = std::min(noise, zeros.noise);
    passed = std::min(passed, zeros.complement);
    passed = std::min(passed, zeros.innovation);
  }
  if (noise == ZerosAtZero::kNone) noise = 0;  // as for any noise, however small
  return gain.zeros() > passed + noise;
}

double loss_gain_of(const LinkedPattern& pattern, const PatternGain& gain) {
  if (!any_losses(pattern)) return 0.0;
  return refined([&](int refinement) {
           return std::vector<double>{loss_gain_by(PatternSpectra(pattern, gain, true, refinement), pattern)};
         })
      .front();
}

struct MeanSquare {
  double spectral_radius = 0.0, loss_feedback = 0.0;
  bool stable() const { return spectral_radius < 1.0 && loss_feedback < 1.0; }
  double margin() const { return 1.0 - std::max(spectral_radius, loss_feedback); }
};

MeanSquare mean_square(const LinkedPattern& pattern) {
  MeanSquare worst;
  for (const LinkedVehicle& vehicle : pattern.types) {
    worst.spectral_radius = std::max(worst.spectral_radius, vehicle.spectral_radius());
    worst.loss_feedback = std::max(worst.loss_feedback, vehicle.loss_feedback());
  }
  return worst;
}

void judge(const LinkedPattern& pattern, double speed, StringStability& verdict) {
  const VehicleModel& first = pattern.types.front().vehicle();
  const bool plain = first.link.is_white_noise_only() && !first.feed_forward;
  const char* const gain_name = pattern.size() > 1   ? "|T^| of one pattern"
                                : first.feed_forward ? "|Gamma|"
                                : plain              ? "|T|"
                                                     : "|T^|";
  const PatternGain gain = pattern.gain();
  if (!judge_gain(gain, gain_name, verdict)) return;
  if (grows_at_zero(pattern, gain)) {
    verdict.reason = reason_of_growth_at_zero(gain_name);
    return;
  }
  const double loss_gain = loss_gain_of(pattern, gain);
  const bool has_stage = std::any_of(pattern.types.begin(), pattern.types.end(), [](const LinkedVehicle& v) {
    return v.vehicle().link.loss || varied_link(v.vehicle()).loss;
  });
  if (has_stage) verdict.loss_gain = loss_gain;
  if (!judge_losses(loss_gain, kQuadratureDoubt, "losses", verdict)) return;
  verdict.string_stable = true;
  const std::vector<double> limits = refined(
      [&](int refinement) { return limits_by(PatternSpectra(pattern, gain, true, refinement), pattern, speed); });
  verdict.limit_variance = *std::max_element(limits.begin(), limits.end());
  verdict.reason = reason_of_stability(verdict.spectral_radius, gain_name,
                                       any_losses(pattern) ? std::optional<double>(loss_gain) : std::nullopt);
}

}  // namespace

double metres_per_step(const PlatoonModel& model) {
  if (!model.recorded_leader.empty()) {
    const std::size_t n = model.recorded_leader.size();
    return n < 2 ? 0.0 : model.recorded_leader[n - 1] - model.recorded_leader[n - 2];
  }
  return model.leader.changes().empty() ? 0.0 : model.sample_period * model.leader.changes().back().value;
}

std::vector<double> linked_stationary_variances(const PlatoonModel& model, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const LinkedPattern pattern = linked_pattern(model);
  if (!mean_square(pattern).stable()) return std::vector<double>(followers, kNaN);
  const PatternGain gain = pattern.gain();
  return refined([&](int refinement) {
    return variances_by(PatternSpectra(pattern, gain, false, refinement), pattern, metres_per_step(model), followers);
  });
}

std::vector<std::array<double, 2>> stationary_variances_by_input(const PlatoonModel& model, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const LinkedPattern pattern = linked_pattern(model);
  std::vector<std::array<double, 2>> result(followers, {kNaN, kNaN});
  if (!mean_square(pattern).stable()) return result;
  const PatternGain gain = pattern.gain();
  const std::vector<double> shares = refined([&](int refinement) {
    return shares_by(PatternSpectra(pattern, gain, false, refinement), pattern, metres_per_step(model), followers);
  });
  for (std::size_t i = 0; i < followers; ++i) result[i] = {shares[2 * i], shares[2 * i + 1]};
  return result;
}

std::vector<double> stationary_means(const PlatoonModel& model, std::size_t followers) {
  if (has_bursts(model)) return burst_stationary_means(model, followers);
  const LinkedPattern pattern = linked_pattern(model);
  if (!mean_square(pattern).stable()) return std::vector<double>(followers, kNaN);
  std::vector<double> means;
  for (std::size_t i = 0; i < followers; ++i) means.push_back(metres_per_step(model) * pattern[i].lag());
  return means;
}

StringStability linked_string_stability(const PlatoonModel& model) {
  const LinkedPattern pattern = linked_pattern(model);
  const MeanSquare worst = mean_square(pattern);
  StringStability verdict;
  verdict.spectral_radius = worst.spectral_radius;
  verdict.mean_square_stable = worst.stable();
  if (worst.stable()) {
    judge(pattern, metres_per_step(model), verdict);
  } else if (worst.spectral_radius >= 1.0) {
    verdict.reason =
        formatted("not mean square stable: rho(A) = %s is not below 1", beside_one(worst.spectral_radius).c_str());
  } else {
    verdict.reason = formatted(
        "not mean square stable: p q ||L F||^2 = %s is not below 1, so that predictions from predictions grow",
        beside_one(worst.loss_feedback).c_str());
  }
  return verdict;
}

double linked_gain_margin(const LinkedPattern& pattern) {
  const MeanSquare worst = mean_square(pattern);
  if (!worst.stable()) return std::max(-1.0, worst.margin());
  const PatternGain gain = pattern.gain();
  const double least = gain.least(PatternGain::kSignAccuracy).value;
  return least > 0.0 && grows_at_zero(pattern, gain) ? 0.0 : least;
}

double linked_loss_margin(const LinkedPattern& pattern) {
  if (!any_losses(pattern)) return kInfinity;
  const PatternGain gain = pattern.gain();
  double loss_gain = coarse_loss_gain(PatternSpectra(pattern, gain, true, 0), pattern);
  if (std::abs(loss_gain - 1.0) < 1e-9) loss_gain = loss_gain_of(pattern, gain);  // with refined panels
  return 1.0 / loss_gain - 1.0;
}

}  // namespace platoon
