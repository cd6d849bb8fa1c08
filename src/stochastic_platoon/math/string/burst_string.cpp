#include "stochastic_platoon/math/string/burst_string.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/krylov.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/burst_loss_gain.hpp"
#include "stochastic_platoon/math/string/linked_string.hpp"
#include "stochastic_platoon/math/string/loop_spectrum.hpp"

namespace platoon {

namespace {

constexpr double kLossGainDoubt = 1e-11;  // accuracy of the means and of the root

void require_theory(const PlatoonModel& model) {
  if (const std::optional<std::string> reason = no_burst_theory(model))
    throw std::invalid_argument(std::string("mean_burst: no theory, as ") + *reason);
}

std::vector<double> variances_by(const BurstSpectra& spectra, double speed, std::size_t followers) {
  std::vector<double> variances;
  Eigen::ArrayXd spectrum = Eigen::ArrayXd::Zero(spectra.size());
  for (std::size_t i = 0; i < followers; ++i) {
    const BurstSpectra::Type& type = spectra.of(i);
    const Eigen::ArrayXd added = spectra.added(i, speed) + type.own * spectra.scattered(i, spectrum);
    const double variance = spectra.mean(type.complement * spectrum + type.headway * added);
    variances.push_back(std::isnan(variance) ? kInfinity : variance);
    if (std::isinf(variances.back())) break;
    spectrum = type.gain * spectrum + added;
  }
  variances.resize(followers, kInfinity);
  return variances;
}

std::vector<double> limits_by(const BurstSpectra& spectra, double speed) {
  const std::size_t m = spectra.pattern().size();
  std::vector<Eigen::ArrayXd> added;
  for (std::size_t j = 0; j < m; ++j) added.push_back(spectra.added(j, speed));
  const LossOperator losses(spectra);
  if (losses.dimensions() > 0) losses.add(solve_one_minus(losses, losses.drives(added)), added);
  std::vector<double> limits;
  Eigen::ArrayXd spectrum = spectra.in_front(added, losses.margin());
  for (std::size_t j = 0; j < m; ++j) {
    const BurstSpectra::Type& type = spectra.of(j);
    limits.push_back(spectra.mean(type.complement * spectrum + type.headway * added[j]));
    spectrum = type.gain * spectrum + added[j];
  }
  return limits;
}

/// As in linked_string: whether 1 - |prod T^|^2 vanishes faster at w = 0 than the numerators it divides.
bool grows_at_zero(const BurstPattern& pattern, const PatternGain& gain) {
  int noise = pattern.has_losses() ? 0 : ZerosAtZero::kNone, passed = ZerosAtZero::kNone;
  for (const BurstVehicle& vehicle : pattern.types) {
    const ZerosAtZero zeros = vehicle.zeros_at_zero();
    noise = std::min(noise, zeros.noise);
    passed = std::min({passed, zeros.complement, zeros.innovation});
  }
  if (noise == ZerosAtZero::kNone) noise = 0;  // as for any noise, however small
  return gain.zeros() > passed + noise;
}

double worst_radius(const BurstPattern& pattern) {
  double worst = 0.0;
  for (const BurstVehicle& vehicle : pattern.types) worst = std::max(worst, vehicle.plain().spectral_radius());
  return worst;
}

double worst_second_moment(const BurstPattern& pattern) {
  double worst = 0.0;
  for (const BurstVehicle& vehicle : pattern.types) worst = std::max(worst, vehicle.second_moment_radius());
  return worst;
}

void judge(const BurstPattern& pattern, double speed, StringStability& verdict) {
  const char* const gain_name = pattern.size() > 1 ? "|T^| of one pattern" : "|T^|";
  const PatternGain gain = pattern.gain();
  if (!judge_gain(gain, gain_name, verdict)) return;
  if (grows_at_zero(pattern, gain)) {
    verdict.reason = reason_of_growth_at_zero(gain_name);
    return;
  }
  const double loss_gain = burst_loss_gain(pattern);
  verdict.loss_gain = loss_gain;
  if (!judge_losses(loss_gain, kLossGainDoubt, "losses in bursts", verdict)) return;
  verdict.string_stable = true;
  const std::vector<double> limits =
      settled_values_of_endless(pattern, [speed](const BurstSpectra& spectra) { return limits_by(spectra, speed); });
  verdict.limit_variance = *std::max_element(limits.begin(), limits.end());
  verdict.reason = reason_of_stability(verdict.spectral_radius, gain_name,
                                       pattern.has_losses() ? std::optional<double>(loss_gain) : std::nullopt);
}

}  // namespace

std::vector<double> burst_stationary_variances(const PlatoonModel& model, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  require_theory(model);
  const BurstPattern pattern = burst_pattern(model);
  if (!pattern.mean_square_stable()) return std::vector<double>(followers, kNaN);
  return settled_values(
      pattern, [&](const BurstSpectra& spectra) { return variances_by(spectra, metres_per_step(model), followers); });
}

std::vector<double> burst_stationary_means(const PlatoonModel& model, std::size_t followers) {
  require_theory(model);
  const BurstPattern pattern = burst_pattern(model);
  if (!pattern.mean_square_stable()) return std::vector<double>(followers, kNaN);
  std::vector<double> means;
  for (std::size_t i = 0; i < followers; ++i) means.push_back(metres_per_step(model) * pattern[i].lag());
  return means;
}

StringStability burst_string_stability(const PlatoonModel& model) {
  require_theory(model);
  const BurstPattern pattern = burst_pattern(model);
  StringStability verdict;
  verdict.spectral_radius = worst_radius(pattern);
  verdict.mean_square_stable = pattern.mean_square_stable();
  if (verdict.mean_square_stable) {
    judge(pattern, metres_per_step(model), verdict);
  } else if (verdict.spectral_radius >= 1.0) {
    verdict.reason =
        formatted("not mean square stable: rho(A) = %s is not below 1", beside_one(verdict.spectral_radius).c_str());
  } else {
    verdict.reason = formatted(
        "not mean square stable: the second moments of predictions from predictions grow by %s a step, which is not below 1",
        beside_one(worst_second_moment(pattern)).c_str());
  }
  return verdict;
}

double burst_gain_margin(const BurstPattern& pattern) {
  const double settles = 1.0 - std::max(worst_radius(pattern), worst_second_moment(pattern));
  if (!(settles > 0.0)) return std::max(-1.0, settles);
  const PatternGain gain = pattern.gain();
  const double least = gain.least(PatternGain::kSignAccuracy).value;
  return least > 0.0 && grows_at_zero(pattern, gain) ? 0.0 : least;
}

double burst_loss_margin(const BurstPattern& pattern) {
  return pattern.has_losses() ? 1.0 / burst_loss_gain(pattern, true) - 1.0 : kInfinity;
}

}  // namespace platoon
