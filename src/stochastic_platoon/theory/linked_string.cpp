#include "stochastic_platoon/theory/linked_string.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "stochastic_platoon/model/eigenvalues.hpp"
#include "stochastic_platoon/model/special_values.hpp"
#include "stochastic_platoon/theory/least_margin.hpp"
#include "stochastic_platoon/theory/pattern_gain.hpp"
#include "stochastic_platoon/theory/pattern_spectra.hpp"
#include "stochastic_platoon/theory/refinement.hpp"

namespace platoon {

namespace {

template <class... Values>
std::string sentence(const char* format, Values... values) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

// [m] a step: the leader's speed in the end.
double metres_per_step(const PlatoonModel& model) {
  if (!model.recorded_leader.empty()) {
    const std::size_t n = model.recorded_leader.size();
    return n < 2 ? 0.0 : model.recorded_leader[n - 1] - model.recorded_leader[n - 2];
  }
  return model.leader.changes().empty() ? 0.0 : model.sample_period * model.leader.changes().back().value;
}

/// sigma^2 and P of one follower behind a predecessor of this spectrum, and its own spectrum.
double pass(const PatternSpectra& spectra, const LinkedVehicle& vehicle, std::size_t j, double speed,
            Eigen::ArrayXd& spectrum) {
  const double ebar = speed * vehicle.mean_innovation();
  const double sigma =
      !vehicle.has_losses()
          ? 0.0
          : vehicle.loss_factor() *
                (spectra.mean(spectra.innovation[j] * (spectrum + spectra.noise[j])) + ebar * ebar);
  const Eigen::ArrayXd added = spectra.gain[j] * spectra.noise[j] + spectra.loss_gain[j] * sigma;
  return spectra.mean(spectra.pass(j, added, spectrum));
}

std::vector<double> variances_by(const PatternSpectra& spectra, const std::vector<LinkedVehicle>& vehicles,
                                 double speed, std::size_t followers) {
  Eigen::ArrayXd spectrum = Eigen::ArrayXd::Zero(spectra.weight.size());
  std::vector<double> variances;
  for (std::size_t i = 0; i < followers; ++i) {
    const std::size_t j = i % vehicles.size();
    const double variance = pass(spectra, vehicles[j], j, speed, spectrum);
    variances.push_back(std::isnan(variance) ? kInfinity : variance);
    if (std::isinf(variances.back())) break;
  }
  variances.resize(followers, kInfinity);
  return variances;
}

Eigen::MatrixXd loss_gains(const PatternSpectra& spectra, const std::vector<LinkedVehicle>& vehicles) {
  const auto m = static_cast<Eigen::Index>(vehicles.size());
  const Eigen::ArrayXd divisor = spectra.pattern_margin();
  Eigen::MatrixXd gains = Eigen::MatrixXd::Zero(m, m);
  for (std::size_t j = 0; j < vehicles.size(); ++j) {
    for (std::size_t l = 0; l < vehicles.size(); ++l) {
      if (!vehicles[j].has_losses() || !vehicles[l].has_losses()) continue;
      gains(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(l)) =
          vehicles[j].loss_factor() *
          spectra.mean(spectra.innovation[j] * spectra.between(l, j) * spectra.loss_gain[l] / divisor);
    }
  }
  return gains;
}

std::vector<double> limits_by(const PatternSpectra& spectra, const std::vector<LinkedVehicle>& vehicles,
                              double speed) {
  const std::size_t m = vehicles.size();
  std::vector<Eigen::ArrayXd> added;
  for (std::size_t j = 0; j < m; ++j) added.push_back(spectra.gain[j] * spectra.noise[j]);
  Eigen::VectorXd given(static_cast<Eigen::Index>(m));
  for (std::size_t j = 0; j < m; ++j) {
    const double ebar = speed * vehicles[j].mean_innovation();
    given(static_cast<Eigen::Index>(j)) =
        !vehicles[j].has_losses()
            ? 0.0
            : vehicles[j].loss_factor() *
                  (spectra.mean(spectra.innovation[j] * (spectra.noise[j] + spectra.before(j, added))) +
                   ebar * ebar);
  }
  const Eigen::MatrixXd gains = loss_gains(spectra, vehicles);
  const Eigen::VectorXd sigma =
      (Eigen::MatrixXd::Identity(gains.rows(), gains.cols()) - gains).partialPivLu().solve(given);
  for (std::size_t j = 0; j < m; ++j) added[j] += spectra.loss_gain[j] * sigma(static_cast<Eigen::Index>(j));
  std::vector<double> limits;
  for (std::size_t j = 0; j < m; ++j)
    limits.push_back(
        spectra.mean(spectra.complement[j] * spectra.before(j, added) + spectra.headway[j] * added[j]));
  return limits;
}

bool any_losses(const std::vector<LinkedVehicle>& vehicles) {
  return std::any_of(vehicles.begin(), vehicles.end(), [](const LinkedVehicle& v) { return v.has_losses(); });
}

/// Whether 1 - |prod T^|^2 vanishes faster at w = 0 than what it divides: |1 - H T^|^2 w^2, or |1 - L|^2 where
/// there are losses.
bool grows_at_zero(const std::vector<LinkedVehicle>& vehicles, const PatternGain& gain) {
  int zeros = any_losses(vehicles) ? 1 : 2;
  for (const LinkedVehicle& vehicle : vehicles) {
    if (vehicle.lag() != 0.0) zeros = 1;
  }
  return gain.zeros() > zeros;
}

double loss_gain_of(const std::vector<LinkedVehicle>& vehicles, const PatternGain& gain) {
  if (!any_losses(vehicles)) return 0.0;
  return refined([&](int refinement) {
           return std::vector<double>{
               spectral_radius(loss_gains(PatternSpectra(vehicles, gain, true, refinement), vehicles))};
         })
      .front();
}

struct MeanSquare {
  double spectral_radius = 0.0, loss_feedback = 0.0;
  bool stable() const { return spectral_radius < 1.0 && loss_feedback < 1.0; }
};

MeanSquare mean_square(const std::vector<LinkedVehicle>& vehicles) {
  MeanSquare worst;
  for (const LinkedVehicle& vehicle : vehicles) {
    worst.spectral_radius = std::max(worst.spectral_radius, vehicle.spectral_radius());
    worst.loss_feedback = std::max(worst.loss_feedback, vehicle.loss_feedback());
  }
  return worst;
}

double peak_of(const std::vector<LinkedVehicle>& vehicles, const PatternGain& gain, double* frequency) {
  double largest = 1.0;
  *frequency = 0.0;
  for (const double w : gain.critical_frequencies()) {
    double product = 1.0;
    for (const LinkedVehicle& vehicle : vehicles) product *= vehicle.at(w).gain;
    if (product <= largest) continue;
    largest = product;
    *frequency = w;
  }
  return std::sqrt(largest);
}

void judge(const std::vector<LinkedVehicle>& vehicles, double speed, StringStability& verdict) {
  const char* const gain_name = vehicles.size() > 1 ? "|T^| of one pattern" : "|T^|";
  const PatternGain gain(vehicles);
  const LeastMargin least = gain.least();
  verdict.peak_gain = peak_of(vehicles, gain, &verdict.peak_frequency);
  if (least.sign == Sign::kNegative) {
    verdict.reason = sentence("not string stable: %s exceeds 1 by %.6g at %.6g rad/sample", gain_name,
                              verdict.peak_gain - 1.0, verdict.peak_frequency);
    return;
  }
  verdict.mean_bounded = true;
  if (least.sign == Sign::kZero) {
    verdict.reason =
        sentence("not string stable: %s = 1 at %.6g rad/sample, where the variances grow without bound",
                 gain_name, least.frequency);
    return;
  }
  if (grows_at_zero(vehicles, gain)) {
    verdict.reason = sentence(
        "not string stable: 1 - %s^2 vanishes so fast at w = 0 that the variances grow without bound",
        gain_name);
    return;
  }
  const double loss_gain = loss_gain_of(vehicles, gain);
  const bool has_stage = std::any_of(vehicles.begin(), vehicles.end(), [](const LinkedVehicle& v) {
    return v.vehicle().link.loss.has_value();
  });
  if (has_stage) verdict.loss_gain = loss_gain;
  if (!(loss_gain < 1.0)) {
    verdict.reason = sentence(
        "not string stable: the loss gain is %.6g, not below 1: the variance that losses add grows along the "
        "string",
        loss_gain);
    return;
  }
  verdict.string_stable = true;
  const std::vector<double> limits = refined([&](int refinement) {
    return limits_by(PatternSpectra(vehicles, gain, true, refinement), vehicles, speed);
  });
  verdict.limit_variance = *std::max_element(limits.begin(), limits.end());
  verdict.reason = sentence("string stable: rho(A) = %.6g is below 1, %s is below 1 for all w > 0",
                            verdict.spectral_radius, gain_name);
  if (any_losses(vehicles)) verdict.reason += sentence(", and the loss gain is %.6g, below 1", loss_gain);
}

}  // namespace

std::vector<double> linked_stationary_variances(const PlatoonModel& model, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const std::vector<LinkedVehicle> vehicles = linked_pattern(model);
  if (!mean_square(vehicles).stable()) return std::vector<double>(followers, kNaN);
  const PatternGain gain(vehicles);
  return refined([&](int refinement) {
    return variances_by(PatternSpectra(vehicles, gain, false, refinement), vehicles, metres_per_step(model),
                        followers);
  });
}

std::vector<double> stationary_means(const PlatoonModel& model, std::size_t followers) {
  const std::vector<LinkedVehicle> vehicles = linked_pattern(model);
  if (!mean_square(vehicles).stable()) return std::vector<double>(followers, kNaN);
  std::vector<double> means;
  for (std::size_t i = 0; i < followers; ++i)
    means.push_back(metres_per_step(model) * vehicles[i % vehicles.size()].lag());
  return means;
}

StringStability linked_string_stability(const PlatoonModel& model) {
  const std::vector<LinkedVehicle> vehicles = linked_pattern(model);
  const MeanSquare worst = mean_square(vehicles);
  StringStability verdict{worst.spectral_radius, kNaN, kNaN, worst.stable(), false, false, {}, {}};
  if (worst.stable()) {
    judge(vehicles, metres_per_step(model), verdict);
  } else if (worst.spectral_radius >= 1.0) {
    verdict.reason = sentence("not mean square stable: rho(A) = %.6g is not below 1", worst.spectral_radius);
  } else {
    verdict.reason = sentence(
        "not mean square stable: p q ||L F||^2 = %.6g is not below 1, so that predictions from predictions "
        "grow",
        worst.loss_feedback);
  }
  return verdict;
}

double linked_string_margin(const PlatoonModel& model) {
  const std::vector<LinkedVehicle> vehicles = linked_pattern(model);
  const MeanSquare worst = mean_square(vehicles);
  if (!worst.stable()) return std::max(-1.0, 1.0 - std::max(worst.spectral_radius, worst.loss_feedback));
  const PatternGain gain(vehicles);
  const double least = gain.least().value;
  if (!(least > 0.0) || grows_at_zero(vehicles, gain)) return std::min(least, 0.0);
  // Panels resolve the integrand: far from the border their first cut says enough.
  double loss_gain = any_losses(vehicles)
                         ? spectral_radius(loss_gains(PatternSpectra(vehicles, gain, true, 0), vehicles))
                         : 0.0;
  if (std::abs(loss_gain - 1.0) < 1e-3) loss_gain = loss_gain_of(vehicles, gain);
  return std::min(
      {1.0 - worst.spectral_radius, 1.0 - worst.loss_feedback, least, 1.0 / std::max(loss_gain, 1e-3) - 1.0});
}

}  // namespace platoon
