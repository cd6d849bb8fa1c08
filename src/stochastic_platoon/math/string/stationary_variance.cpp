#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/burst_string.hpp"
#include "stochastic_platoon/math/string/linked_string.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/quadrature.hpp"
#include "stochastic_platoon/math/string/loop_spectrum.hpp"
#include "stochastic_platoon/math/string/pattern_gain.hpp"

namespace platoon {

namespace {

constexpr std::size_t kBlock = 256;  // followers between two exact restarts of the powers of |T|^2

/// Contribution of one frequency: it adds energy |T|^{2i} to P_{i+1} - P_i.
struct Mode {
  double energy;    ///< |S|^2 times its weight
  double margin;    ///< 1 - |T|^2
  double gain;      ///< |T|^2, accurate if the margin is not
  double log_gain;  ///< its logarithm

  Mode(double weighted, const LoopSpectrumValue& value)
      : energy(weighted),
        margin(value.margin),
        gain(margin < 0.5 ? 1.0 - margin : value.gain),
        log_gain(margin < 0.5 ? std::log1p(-margin) : std::log(value.gain)) {}

  double after(double links) const { return energy * std::exp(links * log_gain); }

  /// Sum over m = 1 .. links of energy |T|^{2m}.
  double sum(double links) const {
    if (links == 0.0) return 0.0;
    if (margin == 0.0) return energy * links;
    return energy * gain * -std::expm1(links * log_gain) / margin;
  }
};

struct Modes {
  double first;  ///< P_1 / P_d
  std::vector<Mode> modes;

  double variance(double follower) const {
    long double sum = first;
    for (const Mode& mode : modes) sum += mode.sum(follower - 1.0);
    return static_cast<double>(sum);
  }
};

Modes modes_of(const LoopSpectrum& spectrum, const std::vector<double>& peaks, int refinement) {
  const Quadrature rule = half_circle_quadrature(spectrum.pole_frequencies(), peaks, refinement);
  Modes result{0.0, {}};
  for (std::size_t k = 0; k < rule.node.size(); ++k) {
    const LoopSpectrumValue value = spectrum.at(rule.node[k]);
    result.first += rule.weight[k] * value.complement;
    result.modes.emplace_back(rule.weight[k] * value.sensitivity, value);
  }
  return result;
}

/// The largest relative difference of the finite variances of followers 1, 2, 4, ...
double difference(const Modes& a, const Modes& b, std::size_t followers) {
  double largest = 0.0;
  for (double i = 1.0;; i *= 2.0) {
    const double follower = std::min(i, static_cast<double>(followers));
    const double p = a.variance(follower);
    const double q = b.variance(follower);
    if (!std::isfinite(q)) return largest;
    const double change = std::abs(p - q) / q;
    largest = std::isnan(change) ? std::numeric_limits<double>::infinity() : std::max(largest, change);
    if (follower < i) return largest;
  }
}

Modes converged_modes(const LoopSpectrum& spectrum, const std::vector<double>& peaks, std::size_t followers) {
  Modes coarse = modes_of(spectrum, peaks, 0);
  double before = std::numeric_limits<double>::infinity();
  for (int refinement = 1; refinement <= 4; ++refinement) {
    const Modes fine = modes_of(spectrum, peaks, refinement);
    const double change = difference(coarse, fine, followers);
    if (is_converged(change, before)) break;
    coarse = fine;
    before = change;
  }
  return coarse;
}

/// Drops the modes that no longer contribute to `variance`: decaying modes with too little left, and modes that grow
/// more slowly than a mode far above them.
void drop_spent(std::vector<Mode>& modes, double links, double variance) {
  const double floor = 1e-17 * variance / static_cast<double>(modes.size() + 1);
  double leading = 0.0;
  double least_margin = 1.0;
  for (const Mode& mode : modes) {
    if (mode.after(links) <= leading) continue;
    leading = mode.after(links);
    least_margin = mode.margin;
  }
  const auto spent = [&](const Mode& mode) {
    const double left = mode.after(links);
    if (mode.margin > 0.0 && left <= floor * mode.margin) return true;
    return mode.margin > least_margin && left < 1e-20 * leading;
  };
  modes.erase(std::remove_if(modes.begin(), modes.end(), spent), modes.end());
}

}  // namespace

std::vector<double> stationary_variances(const PlatoonModel& model, std::size_t followers) {
  if (has_bursts(model)) return burst_stationary_variances(model, followers);
  if (!is_papers(model) || model.default_vehicle().loop.parts) return linked_stationary_variances(model, followers);
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  std::vector<double> variances(followers, std::numeric_limits<double>::quiet_NaN());
  if (spectral_radius(model.default_vehicle().loop) >= 1.0) return variances;
  if (model.default_vehicle().noise_variance == 0.0) return std::vector<double>(followers, 0.0);
  std::vector<double> peaks = PatternGain({rated_factor(model.default_vehicle().loop)}).maxima();
  peaks.push_back(0.0);
  const Modes converged =
      converged_modes(LoopSpectrum(model.default_vehicle().loop, model.default_vehicle().headway), peaks, followers);
  std::vector<Mode> modes = converged.modes;
  long double variance = converged.first;
  variances[0] = static_cast<double>(variance) * model.default_vehicle().noise_variance;
  for (std::size_t start = 1; start < followers; start += kBlock) {
    const auto links = static_cast<double>(start);
    if (!std::isfinite(static_cast<double>(variance))) {
      std::fill(variances.begin() + static_cast<std::ptrdiff_t>(start), variances.end(),
                std::numeric_limits<double>::infinity());
      break;
    }
    drop_spent(modes, links, static_cast<double>(variance));
    const auto count = static_cast<Eigen::Index>(modes.size());
    Eigen::ArrayXd power(count);
    Eigen::ArrayXd gain(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Mode& mode = modes[static_cast<std::size_t>(k)];
      power(k) = mode.after(links);
      gain(k) = mode.gain;
    }
    for (std::size_t i = start; i < std::min(start + kBlock, followers); ++i) {
      variance += power.sum();
      power *= gain;
      variances[i] = static_cast<double>(variance) * model.default_vehicle().noise_variance;
    }
  }
  return variances;
}

}  // namespace platoon
