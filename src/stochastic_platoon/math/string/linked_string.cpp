#include "stochastic_platoon/math/string/linked_string.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/model/special_values.hpp"
#include "stochastic_platoon/math/numerics/krylov.hpp"
#include "stochastic_platoon/math/numerics/refinement.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/pattern_gain.hpp"
#include "stochastic_platoon/math/string/pattern_spectra.hpp"

namespace platoon {

namespace {

constexpr double kLossGainDoubt = 1e-12;  // accuracy of the quadrature

// The leader's last speed, in metres per step.
double metres_per_step(const PlatoonModel& model) {
  if (!model.recorded_leader.empty()) {
    const std::size_t n = model.recorded_leader.size();
    return n < 2 ? 0.0 : model.recorded_leader[n - 1] - model.recorded_leader[n - 2];
  }
  return model.leader.changes().empty() ? 0.0 : model.sample_period * model.leader.changes().back().value;
}

/// ebar^2 [m^2]: the squared mean of e at constant speed; speed in metres per step.
double squared_mean_innovation(const LinkedVehicle& vehicle, double speed) {
  const double ebar = speed * vehicle.mean_innovation();
  return ebar * ebar;
}

std::vector<double> variances_by(const PatternSpectra& spectra, const LinkedPattern& pattern, double speed,
                                 std::size_t followers) {
  Eigen::ArrayXd spectrum = Eigen::ArrayXd::Zero(spectra.weight.size());
  std::vector<double> variances;
  for (std::size_t i = 0; i < followers; ++i) {
    const LinkedVehicle& vehicle = pattern[i];
    const std::size_t type = pattern.type(i);
    const double sigma =
        !vehicle.has_losses()
            ? 0.0
            : vehicle.loss_factor() * (spectra.mean(spectra.innovation[type] * (spectrum + spectra.noise[type])) +
                                       squared_mean_innovation(vehicle, speed));
    const Eigen::ArrayXd added = spectra.gain[type] * spectra.noise[type] + spectra.loss_gain[type] * sigma;
    const double variance = spectra.error_variance(type, spectrum, added);
    spectrum = spectra.gain[type] * spectrum + added;
    variances.push_back(std::isnan(variance) ? kInfinity : variance);
    if (std::isinf(variances.back())) break;
  }
  variances.resize(followers, kInfinity);
  return variances;
}

/// The matrix of loss gains as a linear map of the variances of w: see linked_string_stability(). Applied by following
/// the spectra around the pattern, in O(nodes) per vehicle.
class LossGains {
public:
  LossGains(const PatternSpectra& spectra, const LinkedPattern& pattern)
      : spectra_(spectra), pattern_(pattern), divisor_(spectra.pattern_margin()) {
    for (std::size_t j = 0; j < pattern.size(); ++j) {
      if (pattern[j].has_losses()) lossy_.push_back(j);
    }
  }

  /// The pattern_margin() of the spectra.
  const Eigen::ArrayXd& divisor() const { return divisor_; }
  /// Places of the links with losses.
  const std::vector<std::size_t>& lossy() const { return lossy_; }

  /// kappa_j < |(1-L_j) F_j|^2 Phi_{j-1} > for each lossy link, with vehicle l adding added[l] to the spectrum.
  Eigen::VectorXd arriving(const std::vector<Eigen::ArrayXd>& added) const {
    Eigen::VectorXd result(static_cast<Eigen::Index>(lossy_.size()));
    Eigen::ArrayXd spectrum = spectra_.in_front(added, divisor_);
    Eigen::Index row = 0;
    for (std::size_t j = 0; j < pattern_.size(); ++j) {
      const std::size_t type = pattern_.type(j);
      if (pattern_[j].has_losses())
        result(row++) = pattern_[j].loss_factor() * spectra_.mean(spectra_.innovation[type] * spectrum);
      spectrum = spectra_.gain[type] * spectrum + added[j];
    }
    return result;
  }

  Eigen::VectorXd operator()(const Eigen::VectorXd& sigma) const {
    std::vector<Eigen::ArrayXd> added(pattern_.size(), Eigen::ArrayXd::Zero(spectra_.weight.size()));
    for (std::size_t k = 0; k < lossy_.size(); ++k)
      added[lossy_[k]] = spectra_.loss_gain[pattern_.type(lossy_[k])] * sigma(static_cast<Eigen::Index>(k));
    return arriving(added);
  }

private:
  const PatternSpectra& spectra_;
  const LinkedPattern& pattern_;
  Eigen::ArrayXd divisor_;
  std::vector<std::size_t> lossy_;
};

std::vector<double> limits_by(const PatternSpectra& spectra, const LinkedPattern& pattern, double speed) {
  const std::size_t m = pattern.size();
  std::vector<Eigen::ArrayXd> added;
  for (std::size_t j = 0; j < m; ++j) added.push_back(spectra.gain[pattern.type(j)] * spectra.noise[pattern.type(j)]);
  const LossGains gains(spectra, pattern);
  if (!gains.lossy().empty()) {
    Eigen::VectorXd given = gains.arriving(added);
    for (std::size_t k = 0; k < gains.lossy().size(); ++k) {
      const std::size_t j = gains.lossy()[k], type = pattern.type(j);
      given(static_cast<Eigen::Index>(k)) +=
          pattern[j].loss_factor() *
          (spectra.mean(spectra.innovation[type] * spectra.noise[type]) + squared_mean_innovation(pattern[j], speed));
    }
    const Eigen::VectorXd sigma = solve_one_minus(gains, given);
    for (std::size_t k = 0; k < gains.lossy().size(); ++k) {
      const std::size_t j = gains.lossy()[k];
      added[j] += spectra.loss_gain[pattern.type(j)] * sigma(static_cast<Eigen::Index>(k));
    }
  }
  std::vector<double> limits;
  Eigen::ArrayXd spectrum = spectra.in_front(added, gains.divisor());
  for (std::size_t j = 0; j < m; ++j) {
    limits.push_back(spectra.error_variance(pattern.type(j), spectrum, added[j]));
    spectrum = spectra.gain[pattern.type(j)] * spectrum + added[j];
  }
  return limits;
}

double loss_gain_by(const PatternSpectra& spectra, const LinkedPattern& pattern) {
  const LossGains gains(spectra, pattern);
  return perron_root(gains, static_cast<Eigen::Index>(gains.lossy().size()));
}

/// The loss gain, on the correct side of 1; near 1 as accurate as the quadrature.
double coarse_loss_gain(const PatternSpectra& spectra, const LinkedPattern& pattern) {
  constexpr double kFar = 2.0;
  const LossGains gains(spectra, pattern);
  const auto size = static_cast<Eigen::Index>(gains.lossy().size());
  const RootBounds bounds = perron_bounds(gains, size);
  if (bounds.most < 1.0 / kFar || bounds.least > kFar) return std::sqrt(bounds.least * bounds.most);
  return perron_root(gains, size);
}

bool any_losses(const LinkedPattern& pattern) {
  return std::any_of(pattern.types.begin(), pattern.types.end(), [](const LinkedVehicle& v) { return v.has_losses(); });
}

/// Whether 1 - |prod T^|^2 vanishes faster at w = 0 than the numerators it divides in a variance: the noises, times |1
/// - H T^|^2 for the errors and |1 - L|^2 for the losses.
bool grows_at_zero(const LinkedPattern& pattern, const PatternGain& gain) {
  int noise = any_losses(pattern) ? 0 : ZerosAtZero::kNone, passed = ZerosAtZero::kNone;
  for (const LinkedVehicle& vehicle : pattern.types) {
    const ZerosAtZero zeros = vehicle.zeros_at_zero();
    noise = std::min(noise, zeros.noise);
    passed = std::min(passed, zeros.complement);
    if (vehicle.has_losses()) passed = std::min(passed, zeros.innovation);
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
  const bool plain = pattern.types.front().vehicle().link.is_white_noise_only();
  const char* const gain_name = pattern.size() > 1 ? "|T^| of one pattern" : plain ? "|T|" : "|T^|";
  const PatternGain gain = pattern.gain();
  if (!judge_gain(gain, gain_name, verdict)) return;
  if (grows_at_zero(pattern, gain)) {
    verdict.reason = formatted(
        "not string stable: 1 - %s^2 vanishes so fast at w = 0 that the variances grow without bound", gain_name);
    return;
  }
  const double loss_gain = loss_gain_of(pattern, gain);
  const bool has_stage = std::any_of(pattern.types.begin(), pattern.types.end(),
                                     [](const LinkedVehicle& v) { return v.vehicle().link.loss.has_value(); });
  if (has_stage) verdict.loss_gain = loss_gain;
  if (std::abs(loss_gain - 1.0) <= kLossGainDoubt) {
    verdict.undecided = true;
    verdict.reason = formatted(
        "undecided: the loss gain is 1 to %.0e, so that rounding decides whether the variance that losses add grows along the string",
        kLossGainDoubt);
    return;
  }
  if (!(loss_gain < 1.0)) {
    verdict.reason = formatted(
        "not string stable: the loss gain is %s, above 1: the variance that losses add grows along the string",
        beside_one(loss_gain).c_str());
    return;
  }
  verdict.string_stable = true;
  const std::vector<double> limits = refined(
      [&](int refinement) { return limits_by(PatternSpectra(pattern, gain, true, refinement), pattern, speed); });
  verdict.limit_variance = *std::max_element(limits.begin(), limits.end());
  verdict.reason = formatted("string stable: rho(A) = %s is below 1, %s is below 1 for all w > 0",
                             beside_one(verdict.spectral_radius).c_str(), gain_name);
  if (any_losses(pattern))
    verdict.reason += formatted(", and the loss gain is %s, below 1", beside_one(loss_gain).c_str());
}

}  // namespace

std::vector<double> linked_stationary_variances(const PlatoonModel& model, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const LinkedPattern pattern = linked_pattern(model);
  if (!mean_square(pattern).stable()) return std::vector<double>(followers, kNaN);
  const PatternGain gain = pattern.gain();
  return refined([&](int refinement) {
    return variances_by(PatternSpectra(pattern, gain, false, refinement), pattern, metres_per_step(model), followers);
  });
}

std::vector<double> stationary_means(const PlatoonModel& model, std::size_t followers) {
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
  const double decay = 1.0 - std::max(worst.spectral_radius, worst.loss_feedback);
  if (!worst.stable()) return std::max(-1.0, decay);
  const PatternGain gain = pattern.gain();
  const double least = gain.least().value;
  if (!(least > 0.0) || grows_at_zero(pattern, gain)) return std::min(least, 0.0);
  return std::min(decay, least);
}

double linked_string_margin(const LinkedPattern& pattern) {
  const double of_gain = linked_gain_margin(pattern);
  if (!(of_gain > 0.0) || !any_losses(pattern)) return of_gain;
  const PatternGain gain = pattern.gain();
  double loss_gain = coarse_loss_gain(PatternSpectra(pattern, gain, true, 0), pattern);
  if (std::abs(loss_gain - 1.0) < 1e-9) loss_gain = loss_gain_of(pattern, gain);  // with refined panels
  return std::min(of_gain, 1.0 / std::max(loss_gain, 1e-3) - 1.0);
}

}  // namespace platoon
