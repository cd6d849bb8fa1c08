#include "stochastic_platoon/math/string/burst_string.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/model/special_values.hpp"
#include "stochastic_platoon/math/numerics/krylov.hpp"
#include "stochastic_platoon/math/numerics/refinement.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/burst_spectra.hpp"
#include "stochastic_platoon/math/string/linked_string.hpp"
#include "stochastic_platoon/math/string/loop_spectrum.hpp"

namespace platoon {

namespace {

constexpr double kLossGainDoubt = 1e-11;  // accuracy of the means and of the root
constexpr double kMarginAccuracy = 1e-4;  // of a margin whose sign decides
constexpr std::size_t kFewestNodes = 128, kMostNodes = std::size_t{1} << 18;

void require_theory(const PlatoonModel& model) {
  if (const std::optional<std::string> reason = no_burst_theory(model))
    throw std::invalid_argument(std::string("mean_burst: no theory, as ") + *reason);
}

// Enough nodes for the oscillation of the longest delay.
std::size_t first_nodes(const BurstPattern& pattern) {
  std::int64_t delay = 0;
  for (const BurstVehicle& vehicle : pattern.types) delay = std::max(delay, vehicle.vehicle().link.delay);
  std::size_t nodes = kFewestNodes;
  while (nodes < kMostNodes / 4 && static_cast<std::int64_t>(nodes) < 4 * delay) nodes *= 2;
  return nodes;
}

constexpr std::size_t kCheapNodes = 512, kMostKernelNodes = 1500;
constexpr double kKernelDoubt = 1e-9;  // of a quadrature without refinement

/// A quadrature that resolves the vehicles, the margin of the pattern and the memory of the chains.
Quadrature resolving_quadrature(const BurstPattern& pattern) {
  constexpr double kHalfTurn = 3.14159265358979323846;
  std::vector<std::complex<double>> singular = pattern.gain().margin_frequencies();
  for (const BurstVehicle& vehicle : pattern.types) {
    for (const std::complex<double>& w : vehicle.plain().pole_frequencies()) singular.push_back(w);
    if (!vehicle.losses()) continue;
    for (const std::complex<double>& w : frequencies_of(vehicle.losses()->factor().poles)) singular.push_back(w);
    const double memory = std::abs(vehicle.losses()->memory());
    const double width = memory > 0.0 ? -std::log(memory) : kHalfTurn;
    for (double w = 0.0; w <= kHalfTurn; w += width) singular.emplace_back(w, width);
  }
  return half_circle_quadrature(singular, {});
}

/// Number of equally spaced nodes that resolve every vehicle, chain and peak to the last digit.
double resolving_nodes(const BurstPattern& pattern) {
  constexpr double kDigits = 40.0;  // -ln of the last one
  double width = kInfinity;
  for (const std::complex<double>& w : pattern.gain().margin_frequencies()) width = std::min(width, std::abs(w.imag()));
  for (const BurstVehicle& vehicle : pattern.types) {
    double radius = std::max(vehicle.plain().spectral_radius(), std::sqrt(vehicle.second_moment_radius()));
    if (vehicle.losses()) radius = std::max(radius, std::abs(vehicle.losses()->memory()));
    width = std::min(width, 1.0 - radius);
  }
  return kDigits / width;
}

/// Whether twice as many nodes gain nothing. Beyond the resolving nodes a change is rounding, which near the border of
/// stability is magnified.
bool has_settled(double change, double before, bool resolved) {
  return change <= 1e-12 || is_converged(change, before) || (resolved && change <= 1e-6 && change >= 0.1 * before);
}

/// values(spectra) with ever more nodes, until they settle.
template <class Values>
std::vector<double> settled(const BurstPattern& pattern, const Values& values) {
  std::size_t nodes = first_nodes(pattern);
  const double resolving = resolving_nodes(pattern);
  std::vector<double> coarse = values(BurstSpectra(pattern, nodes));
  for (double before = kInfinity; nodes < kMostNodes;) {
    nodes *= 2;
    std::vector<double> fine = values(BurstSpectra(pattern, nodes));
    const double change = largest_change(coarse, fine);
    if (has_settled(change, before, static_cast<double>(nodes) > resolving)) return fine;
    coarse.swap(fine);
    before = change;
  }
  return coarse;
}

std::vector<double> variances_by(const BurstSpectra& spectra, double speed, std::size_t followers) {
  std::vector<double> variances;
  Eigen::ArrayXd spectrum = Eigen::ArrayXd::Zero(spectra.size());
  for (std::size_t i = 0; i < followers; ++i) {
    const BurstSpectra::Type& type = spectra.of(i);
    const Eigen::ArrayXd added = spectra.added(i, speed) + type.own * spectra.scattered(i, type.surprise * spectrum);
    const double variance = spectra.mean(type.complement * spectrum + type.headway * added);
    variances.push_back(std::isnan(variance) ? kInfinity : variance);
    if (std::isinf(variances.back())) break;
    spectrum = type.gain * spectrum + added;
  }
  variances.resize(followers, kInfinity);
  return variances;
}

/// The operator of loss gains on the drives of all lossy places, one after the other.
class LossOperator {
public:
  explicit LossOperator(const BurstSpectra& spectra) : spectra_(spectra), margin_(spectra.pattern_margin()) {
    for (std::size_t j = 0; j < spectra.pattern().size(); ++j) {
      if (spectra.pattern()[j].losses()) lossy_.push_back(j);
    }
  }

  Eigen::Index dimensions() const { return static_cast<Eigen::Index>(lossy_.size()) * spectra_.size(); }
  const Eigen::ArrayXd& margin() const { return margin_; }

  /// Adds to each vehicle's spectrum what its losses scatter of these drives.
  void add(const Eigen::VectorXd& drives, std::vector<Eigen::ArrayXd>& added) const {
    for (std::size_t l = 0; l < lossy_.size(); ++l) {
      const std::size_t j = lossy_[l];
      added[j] += spectra_.of(j).own *
                  spectra_.scattered(
                      j, drives.segment(static_cast<Eigen::Index>(l) * spectra_.size(), spectra_.size()).array());
    }
  }

  /// The drives in an endless string in which vehicle l adds added[l] to the spectrum.
  Eigen::VectorXd drives(const std::vector<Eigen::ArrayXd>& added) const {
    Eigen::VectorXd result(dimensions());
    Eigen::ArrayXd spectrum = spectra_.in_front(added, margin_);
    std::size_t l = 0;
    for (std::size_t j = 0; j < added.size(); ++j) {
      const BurstSpectra::Type& type = spectra_.of(j);
      if (l < lossy_.size() && lossy_[l] == j)
        result.segment(static_cast<Eigen::Index>(l++) * spectra_.size(), spectra_.size()) = type.surprise * spectrum;
      spectrum = type.gain * spectrum + added[j];
    }
    return result;
  }

  Eigen::VectorXd operator()(const Eigen::VectorXd& given) const {
    std::vector<Eigen::ArrayXd> added(spectra_.pattern().size(), Eigen::ArrayXd::Zero(spectra_.size()));
    add(given, added);
    return drives(added);
  }

private:
  const BurstSpectra& spectra_;
  Eigen::ArrayXd margin_;
  std::vector<std::size_t> lossy_;
};

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
    verdict.reason = formatted(
        "not string stable: 1 - %s^2 vanishes so fast at w = 0 that the variances grow without bound", gain_name);
    return;
  }
  const double loss_gain = burst_loss_gain(pattern);
  verdict.loss_gain = loss_gain;
  if (std::abs(loss_gain - 1.0) <= kLossGainDoubt) {
    verdict.undecided = true;
    verdict.reason = formatted(
        "undecided: the loss gain is 1 to %.0e, so that rounding decides whether the variance that losses add grows along the string",
        kLossGainDoubt);
    return;
  }
  if (!(loss_gain < 1.0)) {
    verdict.reason = formatted(
        "not string stable: the loss gain is %s, above 1: the variance that losses in bursts add grows along the string",
        beside_one(loss_gain).c_str());
    return;
  }
  verdict.string_stable = true;
  const std::vector<double> limits =
      settled(pattern, [speed](const BurstSpectra& spectra) { return limits_by(spectra, speed); });
  verdict.limit_variance = *std::max_element(limits.begin(), limits.end());
  verdict.reason = formatted("string stable: rho(A) = %s is below 1, %s is below 1 for all w > 0",
                             beside_one(verdict.spectral_radius).c_str(), gain_name);
  if (pattern.has_losses())
    verdict.reason += formatted(", and the loss gain is %s, below 1", beside_one(loss_gain).c_str());
}

}  // namespace

std::vector<double> burst_stationary_variances(const PlatoonModel& model, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  require_theory(model);
  const BurstPattern pattern = burst_pattern(model);
  if (!pattern.mean_square_stable()) return std::vector<double>(followers, kNaN);
  return settled(pattern,
                 [&](const BurstSpectra& spectra) { return variances_by(spectra, metres_per_step(model), followers); });
}

std::vector<double> burst_stationary_means(const PlatoonModel& model, std::size_t followers) {
  require_theory(model);
  const BurstPattern pattern = burst_pattern(model);
  if (!pattern.mean_square_stable()) return std::vector<double>(followers, kNaN);
  std::vector<double> means;
  for (std::size_t i = 0; i < followers; ++i) means.push_back(metres_per_step(model) * pattern[i].lag());
  return means;
}

double burst_loss_gain(const BurstPattern& pattern, bool sign_only) {
  if (!pattern.has_losses()) return 0.0;
  const auto root = [sign_only](const BurstSpectra& spectra) {
    constexpr double kFar = 2.0;
    const LossOperator losses(spectra);
    if (sign_only) {
      const RootBounds bounds = perron_bounds(losses, losses.dimensions());
      if (bounds.most < 1.0 / kFar || bounds.least > kFar) return std::sqrt(bounds.least * bounds.most);
    }
    return perron_root(losses, losses.dimensions());
  };
  std::size_t nodes = first_nodes(pattern);
  const double resolving = resolving_nodes(pattern);
  double coarse = root(BurstSpectra(pattern, nodes));
  for (double before = kInfinity; nodes < kMostNodes;) {
    if (sign_only && nodes == kCheapNodes) {
      const Quadrature rule = resolving_quadrature(pattern);
      if (rule.node.size() <= kMostKernelNodes) {
        const double found = root(BurstSpectra(pattern, rule));
        if (std::abs(found - 1.0) > kKernelDoubt) return found;
      }
    }
    nodes *= 2;
    const double fine = root(BurstSpectra(pattern, nodes)), change = std::abs(fine - coarse) / fine;
    if (has_settled(change, before, static_cast<double>(nodes) > resolving)) return fine;
    if (sign_only && std::abs(fine - coarse) < 0.01 * std::abs(fine - 1.0)) return fine;
    coarse = fine;
    before = change;
  }
  return coarse;
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
  const double least = gain.least(kMarginAccuracy).value;
  return least > 0.0 && grows_at_zero(pattern, gain) ? 0.0 : least;
}

double burst_loss_margin(const BurstPattern& pattern) {
  return pattern.has_losses() ? 1.0 / burst_loss_gain(pattern, true) - 1.0 : kInfinity;
}

}  // namespace platoon
