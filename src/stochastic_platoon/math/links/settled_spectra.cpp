#include "stochastic_platoon/math/links/settled_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <utility>

#include "stochastic_platoon/math/links/loss_operator.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"
#include "stochastic_platoon/math/numerics/krylov.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

constexpr std::size_t kFewestNodes = 128, kMostNodes = std::size_t{1} << 18;
constexpr std::size_t kMostKernelNodes = 3000;
constexpr double kManyNodes = 4096.0;       // equally spaced
constexpr double kMostRounding = 1e-4;      // change of a value on nodes that resolve every pole
constexpr std::int64_t kResolvedDelay = 8;  // [steps], largest delay whose z^m the longest panels resolve

using Frequencies = std::vector<std::complex<double>>;

std::vector<std::complex<double>> memories_of(const LinkedVehicle& vehicle) {
  std::vector<std::complex<double>> found;
  for (const LinkFilter& link : vehicle.links()) {
    if (!link.has_memory()) continue;
    const std::vector<std::complex<double>>& memories = link.losses().kernel()->memories();
    found.insert(found.end(), memories.begin(), memories.end());
  }
  return found;
}

std::int64_t longest_delay(const LinkedPattern& pattern, bool of_positions) {
  std::int64_t delay = 0;
  for (const LinkedVehicle& vehicle : pattern.types) {
    for (const LinkFilter& link : vehicle.links()) {
      delay = std::max(delay, link.delay());
      if (of_positions) break;
    }
  }
  return delay;
}

// Enough nodes for the oscillation of the longest delay.
std::size_t first_nodes(const LinkedPattern& pattern) {
  const std::int64_t delay = longest_delay(pattern, false);
  std::size_t nodes = kFewestNodes;
  while (nodes < kMostNodes / 4 && static_cast<std::int64_t>(nodes) < 4 * delay) nodes *= 2;
  return nodes;
}

/// The margin_frequencies() of an endless string; none for a number of followers.
Frequencies margin_of(const LinkedPattern& pattern, std::optional<std::size_t> followers) {
  return followers ? Frequencies() : pattern.gain().margin_frequencies();
}

/// Quadratures that resolve the vehicles and either the margin of an endless string or the peaks of the gain, which
/// narrow along the string, of a number of followers.
class ResolvingQuadrature {
public:
  /// `margin`: the margin_of() the same.
  ResolvingQuadrature(const LinkedPattern& pattern, std::optional<std::size_t> followers, const Frequencies& margin)
      : singular_(margin) {
    if (followers) peaks_ = pattern.gain().maxima();
    // Towards w = 0 the spectra narrow along the string; the panels must narrow too if delays oscillate.
    if (followers || longest_delay(pattern, true) > kResolvedDelay) peaks_.push_back(0.0);
    for (const LinkedVehicle& vehicle : pattern.types) {
      for (const std::complex<double>& w : vehicle.pole_frequencies()) singular_.push_back(w);
      // A chain that nearly returns to its modes scatters a constant motion into a line at the argument of its memory,
      // and that line back to 0.
      for (const std::complex<double>& memory : memories_of(vehicle)) {
        for (const double line : {0.0, std::abs(std::arg(memory))})
          singular_.emplace_back(line, -std::log(std::abs(memory)));
      }
    }
    if (pattern.has_memory()) factors_ = followers;
  }

  Quadrature operator()(int refinement) const {
    return half_circle_quadrature(singular_, peaks_, refinement, factors_);
  }

private:
  Frequencies singular_;
  std::vector<double> peaks_;
  std::optional<std::size_t> factors_;
};

/// The rule with the panels cut on which its nodes do not interpolate the drives of the losses of an endless string.
/// The longer the bursts, the less they scatter a frequency, and the narrower the peak of the drives at the frequency
/// where losses feed on each other most: like the power -1/3 of the mean burst.
Quadrature resolving_drives(const LinkedPattern& pattern, Quadrature rule) {
  constexpr double kError = 1e-9;  // relative to the peak
  std::ptrdiff_t before = static_cast<std::ptrdiff_t>(rule.middle.size());
  while (rule.node.size() <= kMostKernelNodes / 2) {
    const StringSpectra spectra(pattern, SpectralNodes(rule));
    const LossOperator losses(spectra);
    std::vector<int> pieces(rule.middle.size(), 1);
    for (const Eigen::VectorXd& drives : losses.spectra_of(perron_vector(losses, losses.dimensions()))) {
      const std::vector<double> errors = interpolation_errors(rule, drives.data());
      const double most = kError * drives.cwiseAbs().maxCoeff();
      for (std::size_t panel = 0; panel < errors.size(); ++panel) {
        if (errors[panel] > most) pieces[panel] = 2;
      }
    }
    const std::ptrdiff_t cut = std::count(pieces.begin(), pieces.end(), 2);
    if (cut == 0 || cut > before) break;  // above: rounding, near the border of stability
    rule = with_panels_cut(rule, pieces);
    before = cut;
  }
  return rule;
}

/// Distance from the unit circle of the poles of the vehicles and chains, and of this margin.
double least_decay(const LinkedPattern& pattern, const Frequencies& margin) {
  double width = 1.0;
  for (const LinkedVehicle& vehicle : pattern.types) {
    double radius = std::max(vehicle.spectral_radius(), std::sqrt(vehicle.loss_feedback()));
    for (const std::complex<double>& memory : memories_of(vehicle)) radius = std::max(radius, std::abs(memory));
    width = std::min(width, 1.0 - radius);
  }
  for (const std::complex<double>& w : margin) width = std::min(width, std::abs(w.imag()));
  return width;
}

/// Whether twice as many nodes gain nothing. On resolving nodes a change is rounding, which long bursts and the border
/// of stability magnify.
bool has_settled(double change, double before, bool resolved) {
  return change <= 1e-12 || is_converged(change, before) ||
         (resolved && change <= kMostRounding && change >= 0.1 * before);
}

/// values(spectra) on the nodes of a quadrature, refined until they settle; none if that takes too many nodes.
std::optional<std::vector<double>> settled_on_few(const LinkedPattern& pattern, std::optional<std::size_t> followers,
                                                  const Frequencies& margin, const SpectralValues& values) {
  const ResolvingQuadrature quadrature(pattern, followers, margin);
  const Quadrature resolving = followers ? quadrature(0) : resolving_drives(pattern, quadrature(0));
  std::vector<double> coarse;
  double before = kInfinity;
  for (int refinement = 0;; ++refinement) {
    SpectralNodes nodes(with_panels_cut(resolving, std::vector<int>(resolving.middle.size(), 1 << refinement)));
    const bool too_many = static_cast<std::size_t>(nodes.count()) > kMostKernelNodes;
    if (too_many && before <= kMostRounding) return coarse;
    if (too_many) return std::nullopt;
    std::vector<double> fine = values(StringSpectra(pattern, std::move(nodes)));
    const double change = refinement > 0 ? largest_change(coarse, fine) : kInfinity;
    if (refinement > 0 && has_settled(change, before, true)) return fine;
    coarse.swap(fine);
    before = change;
  }
}

std::vector<double> settled_without_memory(const LinkedPattern& pattern, std::optional<std::size_t> followers,
                                           const SpectralValues& values) {
  const ResolvingQuadrature quadrature(pattern, followers, margin_of(pattern, followers));
  return refined([&](int refinement) { return values(StringSpectra(pattern, SpectralNodes(quadrature(refinement)))); });
}

/// The value with the number of equally spaced nodes doubled until they resolve the poles to two digits and decide its
/// side of 1; none if `most` nodes do not suffice.
std::optional<double> by_equal_nodes(const LinkedPattern& pattern, const Frequencies& margin, std::size_t most,
                                     const std::function<double(const StringSpectra&)>& value) {
  constexpr double kDigits = 5.0;  // -ln of the second digit
  const auto on = [&](std::size_t nodes) { return value(StringSpectra(pattern, SpectralNodes(nodes))); };
  std::size_t nodes = first_nodes(pattern);
  const double width = least_decay(pattern, margin);
  while (nodes < most && static_cast<double>(2 * nodes) * width <= kDigits) nodes *= 2;
  if (nodes >= most) return std::nullopt;
  for (double coarse = on(nodes); nodes < most;) {
    nodes *= 2;
    const double fine = on(nodes), change = std::abs(fine - coarse);
    if (change < std::max(0.01 * std::abs(fine - 1.0), 1e-12)) return fine;
    coarse = fine;
  }
  return std::nullopt;
}

}  // namespace

std::vector<double> settled_values(const LinkedPattern& pattern, std::optional<std::size_t> followers,
                                   const SpectralValues& values) {
  if (!pattern.has_memory()) return settled_without_memory(pattern, followers, values);
  constexpr double kDigits = 40.0;  // -ln of the last digit
  const Frequencies margin = margin_of(pattern, followers);
  const double resolving = kDigits / least_decay(pattern, margin);
  if (resolving > kManyNodes) {
    if (const std::optional<std::vector<double>> found = settled_on_few(pattern, followers, margin, values))
      return *found;
  }
  std::size_t nodes = first_nodes(pattern);
  std::vector<double> coarse = values(StringSpectra(pattern, SpectralNodes(nodes)));
  for (double before = kInfinity; nodes < kMostNodes;) {
    nodes *= 2;
    std::vector<double> fine = values(StringSpectra(pattern, SpectralNodes(nodes)));
    const double change = largest_change(coarse, fine);
    if (has_settled(change, before, static_cast<double>(nodes) > resolving)) return fine;
    coarse.swap(fine);
    before = change;
  }
  return coarse;
}

double settled_beside_one(const LinkedPattern& pattern, const std::function<double(const StringSpectra&)>& value) {
  constexpr double kDoubt = 1e-7;  // error allowed to a quadrature without refinement; mostly it is below 1e-11
  const bool memory = pattern.has_memory();
  const Frequencies margin = margin_of(pattern, std::nullopt);
  if (memory) {
    const std::size_t most = 2 * first_nodes(pattern);
    if (const std::optional<double> found = by_equal_nodes(pattern, margin, most, value)) return *found;
  }
  const ResolvingQuadrature quadrature(pattern, std::nullopt, margin);
  for (const int refinement : {0, 1}) {
    SpectralNodes nodes(quadrature(refinement));
    if (memory && static_cast<std::size_t>(nodes.count()) > kMostKernelNodes) break;
    const double found = value(StringSpectra(pattern, std::move(nodes)));
    if (refinement > 0 || std::abs(found - 1.0) > kDoubt) return found;
  }
  return by_equal_nodes(pattern, margin, kMostNodes, value).value_or(1.0);
}

}  // namespace platoon
