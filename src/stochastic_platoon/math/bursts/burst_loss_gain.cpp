#include "stochastic_platoon/math/bursts/burst_loss_gain.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <optional>

#include "stochastic_platoon/math/numerics/delta_form.hpp"
#include "stochastic_platoon/math/numerics/krylov.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

constexpr std::size_t kFewestNodes = 128, kMostNodes = std::size_t{1} << 18;
constexpr std::size_t kMostKernelNodes = 3000;
constexpr double kManyNodes = 4096.0;   // equally spaced
constexpr double kMostRounding = 1e-4;  // change of a value on nodes that resolve every pole
using SpectralValues = std::function<std::vector<double>(const BurstSpectra&)>;

std::vector<std::complex<double>> memories_of(const BurstVehicle& vehicle) {
  return vehicle.losses() == nullptr ? std::vector<std::complex<double>>() : vehicle.losses()->memories();
}

// Enough nodes for the oscillation of the longest delay.
std::size_t first_nodes(const BurstPattern& pattern) {
  std::int64_t delay = 0;
  for (const BurstVehicle& vehicle : pattern.types) delay = std::max(delay, vehicle.vehicle().link.delay);
  std::size_t nodes = kFewestNodes;
  while (nodes < kMostNodes / 4 && static_cast<std::int64_t>(nodes) < 4 * delay) nodes *= 2;
  return nodes;
}

/// A quadrature that resolves the vehicles and either the margin of the pattern or the peaks of the gain, which narrow
/// along the string, of this number of followers.
Quadrature resolving_quadrature(const BurstPattern& pattern, std::optional<std::size_t> followers, int refinement) {
  const PatternGain gain = pattern.gain();
  std::vector<std::complex<double>> singular;
  std::vector<double> peaks;
  if (followers) {
    peaks = gain.maxima();
    peaks.push_back(0.0);
  } else {
    singular = gain.margin_frequencies();
  }
  for (const BurstVehicle& vehicle : pattern.types) {
    for (const std::complex<double>& w : vehicle.plain().pole_frequencies()) singular.push_back(w);
    if (!vehicle.losses()) continue;
    for (const std::complex<double>& w : frequencies_of(vehicle.losses()->factor().poles)) singular.push_back(w);
    // A chain that nearly returns to its modes scatters a constant motion into a line at the argument of its memory,
    // and that line back to 0.
    for (const std::complex<double>& memory : memories_of(vehicle)) {
      for (const double line : {0.0, std::abs(std::arg(memory))})
        singular.emplace_back(line, -std::log(std::abs(memory)));
    }
  }
  return half_circle_quadrature(singular, peaks, refinement, followers);
}

/// Distance of the vehicles' and chains' poles from the unit circle.
double least_decay(const BurstPattern& pattern) {
  double width = 1.0;
  for (const BurstVehicle& vehicle : pattern.types) {
    double radius = std::max(vehicle.spectral_radius(), std::sqrt(vehicle.loss_feedback()));
    for (const std::complex<double>& memory : memories_of(vehicle)) radius = std::max(radius, std::abs(memory));
    width = std::min(width, 1.0 - radius);
  }
  return width;
}

/// Number of equally spaced nodes that resolve every vehicle and chain to the last digit, and the margin of an endless
/// string.
double resolving_nodes(const BurstPattern& pattern, bool endless) {
  constexpr double kDigits = 40.0;  // -ln of the last digit
  double width = least_decay(pattern);
  if (!endless) return kDigits / width;
  for (const std::complex<double>& w : pattern.gain().margin_frequencies()) width = std::min(width, std::abs(w.imag()));
  return kDigits / width;
}

/// Whether twice as many nodes gain nothing. On resolving nodes a change is rounding, which long bursts and the border
/// of stability magnify.
bool has_settled(double change, double before, bool resolved) {
  return change <= 1e-12 || is_converged(change, before) ||
         (resolved && change <= kMostRounding && change >= 0.1 * before);
}

/// The loss gain, on the correct side of 1; near 1 to kShare of its distance from 1.
double near_root(const BurstSpectra& spectra) {
  constexpr double kShare = 1e-4;
  const LossOperator losses(spectra);
  return perron_root_beside_one(losses, losses.dimensions(), kShare);
}

/// The loss gain by near_root(), with the number of equally spaced nodes doubled until they resolve the poles to two
/// digits and decide its side of 1; none if `most` nodes do not suffice.
std::optional<double> by_equal_nodes(const BurstPattern& pattern, std::size_t most) {
  constexpr double kDigits = 5.0;  // -ln of the second digit
  std::size_t nodes = first_nodes(pattern);
  while (nodes < most && static_cast<double>(2 * nodes) * least_decay(pattern) <= kDigits) nodes *= 2;
  if (nodes >= most) return std::nullopt;
  for (double coarse = near_root(BurstSpectra(pattern, nodes)); nodes < most;) {
    nodes *= 2;
    const double fine = near_root(BurstSpectra(pattern, nodes)), change = std::abs(fine - coarse);
    if (change < std::max(0.01 * std::abs(fine - 1.0), 1e-12)) return fine;
    coarse = fine;
  }
  return std::nullopt;
}

/// The loss gain by few equally spaced nodes if they suffice, else by a quadrature, refined near 1, else by many
/// equally spaced nodes.
double loss_gain_for_sign(const BurstPattern& pattern) {
  constexpr double kDoubt = 1e-7;  // of a quadrature without refinement, mostly below 1e-11
  if (const std::optional<double> found = by_equal_nodes(pattern, 2 * first_nodes(pattern))) return *found;
  for (const int refinement : {0, 1}) {
    const Quadrature rule = resolving_quadrature(pattern, std::nullopt, refinement);
    if (rule.node.size() > kMostKernelNodes) break;
    const double found = near_root(BurstSpectra(pattern, rule));
    if (refinement > 0 || std::abs(found - 1.0) > kDoubt) return found;
  }
  return by_equal_nodes(pattern, kMostNodes).value_or(1.0);
}

/// values(spectra) on the nodes of a quadrature, refined until they settle; none if that takes too many nodes.
std::optional<std::vector<double>> settled_on_few(const BurstPattern& pattern, std::optional<std::size_t> followers,
                                                  const SpectralValues& values) {
  std::vector<double> coarse;
  double before = kInfinity;
  for (int refinement = 0;; ++refinement) {
    const Quadrature rule = resolving_quadrature(pattern, followers, refinement);
    if (rule.node.size() > kMostKernelNodes && before <= kMostRounding) return coarse;
    if (rule.node.size() > kMostKernelNodes) return std::nullopt;
    std::vector<double> fine = values(BurstSpectra(pattern, rule));
    const double change = refinement > 0 ? largest_change(coarse, fine) : kInfinity;
    if (refinement > 0 && has_settled(change, before, true)) return fine;
    coarse.swap(fine);
    before = change;
  }
}

}  // namespace

LossOperator::LossOperator(const BurstSpectra& spectra)
    : spectra_(spectra), margin_(spectra.pattern_margin()), drive_(spectra.size(), -1) {
  for (std::size_t j = 0; j < drive_.size(); ++j) {
    const std::shared_ptr<const BurstScatter>& losses = spectra.of(j).losses;
    for (std::size_t l = j; losses && drive_[j] < 0 && l < drive_.size(); ++l) {
      if (spectra.of(l).losses != losses) continue;
      drive_[l] = static_cast<Eigen::Index>(lossy_.size());
      lossy_.push_back(l);
    }
  }
}

void LossOperator::add(const Eigen::VectorXd& drives, std::vector<Eigen::ArrayXd>& added) const {
  for (std::size_t l = 0; l < lossy_.size();) {
    const BurstScatter* const losses = spectra_.of(lossy_[l]).losses.get();
    std::size_t end = l;
    while (end < lossy_.size() && spectra_.of(lossy_[end]).losses.get() == losses) ++end;
    const Eigen::Map<const Eigen::MatrixXd> alike(drives.data() + static_cast<Eigen::Index>(l) * spectra_.nodes(),
                                                  spectra_.nodes(), static_cast<Eigen::Index>(end - l));
    const Eigen::MatrixXd scattered = (*losses)(alike);
    for (Eigen::Index k = 0; l < end; ++l, ++k)
      added[lossy_[l]] += spectra_.of(lossy_[l]).own * scattered.col(k).array();
  }
}

Eigen::VectorXd LossOperator::drives(const std::vector<Eigen::ArrayXd>& added) const {
  Eigen::VectorXd result(dimensions());
  Eigen::ArrayXd spectrum = spectra_.in_front(added, margin_);
  for (std::size_t j = 0; j < added.size(); ++j) {
    const BurstSpectra::Type& type = spectra_.of(j);
    if (drive_[j] >= 0)
      result.segment(drive_[j] * spectra_.nodes(), spectra_.nodes()) = type.losses->surprise * spectrum;
    spectrum *= spectra_.gain_of(j);  // in place: GCC 12 suspects the other form of using freed memory
    spectrum += added[j];
  }
  return result;
}

Eigen::VectorXd LossOperator::operator()(const Eigen::VectorXd& given) const {
  std::vector<Eigen::ArrayXd> added(spectra_.size(), Eigen::ArrayXd::Zero(spectra_.nodes()));
  add(given, added);
  return drives(added);
}

std::vector<double> settled_values(const BurstPattern& pattern, std::optional<std::size_t> followers,
                                   const SpectralValues& values) {
  const double resolving = resolving_nodes(pattern, !followers);
  if (resolving > kManyNodes) {
    if (const std::optional<std::vector<double>> found = settled_on_few(pattern, followers, values)) return *found;
  }
  std::size_t nodes = first_nodes(pattern);
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

double loss_gain(const BurstPattern& pattern) {
  if (!pattern.has_losses()) return 0.0;
  const auto root = [](const BurstSpectra& spectra) {
    const LossOperator losses(spectra);
    return std::vector<double>{perron_root(losses, losses.dimensions())};
  };
  return settled_values(pattern, std::nullopt, root).front();
}

double loss_margin(const BurstPattern& pattern) {
  return pattern.has_losses() ? 1.0 / loss_gain_for_sign(pattern) - 1.0 : kInfinity;
}

}  // namespace platoon
