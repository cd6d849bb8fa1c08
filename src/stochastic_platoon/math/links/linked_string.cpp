#include "stochastic_platoon/math/links/linked_string.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stochastic_platoon/math/links/pattern_spectra.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/krylov.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

/// A lossy link of the pattern.
struct LossyLink {
  std::size_t vehicle, link;  ///< place in the pattern, and in LinkedVehicle::links()
};

std::vector<LossyLink> lossy_links(const LinkedPattern& pattern) {
  std::vector<LossyLink> found;
  for (std::size_t j = 0; j < pattern.size(); ++j) {
    for (std::size_t link = 0; link < pattern[j].links().size(); ++link) {
      if (pattern[j].links()[link].has_losses()) found.push_back({j, link});
    }
  }
  return found;
}

/// ebar^2: the squared mean of e at constant speed, in metres per step; inputs are 0 there.
double squared_mean_innovation(const LinkFilter& link, std::size_t index, double speed) {
  const double ebar = index == 0 ? speed * link.mean_innovation() : 0.0;
  return ebar * ebar;
}

/// sigma^2 of one link, given the spectrum of the predecessor's position.
double loss_variance(const PatternSpectra& spectra, const LinkedPattern& pattern, std::size_t follower,
                     std::size_t link, const Eigen::ArrayXd& spectrum, double speed) {
  const LinkFilter& filter = pattern[follower].links()[link];
  if (!filter.has_losses()) return 0.0;
  const PatternSpectra::Input& of = spectra.input[pattern.type(follower)][link];
  const std::size_t before = pattern.type(follower + pattern.size() - 1);
  return filter.loss_factor() * (spectra.mean(of.innovation * (spectra.at_link(link, before, spectrum) + of.noise)) +
                                 squared_mean_innovation(filter, link, speed));
}

/// Visits the followers one after the other with (i, spectrum of the position in front, spectrum that each link adds),
/// until a visit returns false.
template <class Visit>
void pass_along(const PatternSpectra& spectra, const LinkedPattern& pattern, double speed, std::size_t followers,
                const Visit& visit) {
  std::vector<std::vector<Eigen::ArrayXd>> added;  // per type; noise alone if no link of it loses
  for (const std::vector<PatternSpectra::Input>& inputs : spectra.input) {
    added.emplace_back();
    for (const PatternSpectra::Input& of : inputs) added.back().emplace_back(of.passed * of.noise);
  }
  Eigen::ArrayXd spectrum = Eigen::ArrayXd::Zero(spectra.weight.size());
  for (std::size_t i = 0; i < followers; ++i) {
    check_interruption();
    const std::size_t type = pattern.type(i);
    for (std::size_t link = 0; link < added[type].size() && pattern[i].has_losses(); ++link) {
      const PatternSpectra::Input& of = spectra.input[type][link];
      added[type][link] =
          of.passed * of.noise + of.loss_gain * loss_variance(spectra, pattern, i, link, spectrum, speed);
    }
    if (!visit(i, spectrum, added[type])) return;
    spectrum *= spectra.gain[type];
    for (const Eigen::ArrayXd& of_link : added[type]) spectrum += of_link;
  }
}

std::vector<double> variances_by(const PatternSpectra& spectra, const LinkedPattern& pattern, double speed,
                                 std::size_t followers) {
  std::vector<double> variances;
  pass_along(spectra, pattern, speed, followers, [&](std::size_t i, const auto& spectrum, const auto& added) {
    const std::size_t type = pattern.type(i);
    double variance = spectra.error_variance(type, spectrum, added.front());
    if (added.size() > 1) variance += spectra.mean(spectra.spacing_gain[type] * added.back());
    variances.push_back(std::isnan(variance) ? kInfinity : variance);
    return !std::isinf(variances.back());
  });
  variances.resize(followers, kInfinity);
  return variances;
}

std::vector<double> shares_by(const PatternSpectra& spectra, const LinkedPattern& pattern, double speed,
                              std::size_t followers) {
  std::vector<double> shares(2 * followers, 0.0);
  std::array<Eigen::ArrayXd, 2> part;
  for (Eigen::ArrayXd& of : part) of = Eigen::ArrayXd::Zero(spectra.weight.size());
  pass_along(spectra, pattern, speed, followers, [&](std::size_t i, const auto&, const auto& added) {
    const std::size_t type = pattern.type(i);
    for (std::size_t link = 0; link < part.size(); ++link) {
      const Eigen::ArrayXd own = link < added.size() ? added[link] : Eigen::ArrayXd::Zero(spectra.weight.size());
      shares[2 * i + link] = spectra.error_variance(type, part[link], own);
      part[link] = spectra.gain[type] * part[link] + own;
    }
    return true;
  });
  return shares;
}

/// The matrix of loss gains as a linear map of the variances of w: see loss_gain(). Applied by following the
/// spectra around the pattern, in O(nodes) per vehicle.
class LossGains {
public:
  LossGains(const PatternSpectra& spectra, const LinkedPattern& pattern)
      : spectra_(spectra), pattern_(pattern), divisor_(spectra.pattern_margin()), lossy_(lossy_links(pattern)) {}

  /// The pattern_margin() of the spectra.
  const Eigen::ArrayXd& divisor() const { return divisor_; }
  const std::vector<LossyLink>& lossy() const { return lossy_; }
  Eigen::Index dimensions() const { return static_cast<Eigen::Index>(lossy_.size()); }

  /// kappa < |(1-L) F|^2 Phi > for each lossy link, Phi the spectrum sent over it, if vehicle l adds added[l] to the
  /// spectrum.
  Eigen::VectorXd arriving(const std::vector<Eigen::ArrayXd>& added) const {
    Eigen::VectorXd result(static_cast<Eigen::Index>(lossy_.size()));
    Eigen::ArrayXd spectrum = spectra_.in_front(added, divisor_);
    std::size_t row = 0;
    for (std::size_t j = 0; j < pattern_.size(); ++j) {
      const std::size_t type = pattern_.type(j), before = pattern_.type(j + pattern_.size() - 1);
      for (; row < lossy_.size() && lossy_[row].vehicle == j; ++row) {
        const std::size_t link = lossy_[row].link;
        result(static_cast<Eigen::Index>(row)) =
            pattern_[j].links()[link].loss_factor() *
            spectra_.mean(spectra_.input[type][link].innovation * spectra_.at_link(link, before, spectrum));
      }
      spectrum = spectra_.gain[type] * spectrum + added[j];
    }
    return result;
  }

  /// Adds to the spectrum of each vehicle the part due to losses of these variances.
  void add(const Eigen::VectorXd& sigma, std::vector<Eigen::ArrayXd>& added) const {
    for (std::size_t row = 0; row < lossy_.size(); ++row) {
      const LossyLink& of = lossy_[row];
      added[of.vehicle] +=
          spectra_.input[pattern_.type(of.vehicle)][of.link].loss_gain * sigma(static_cast<Eigen::Index>(row));
    }
  }

  Eigen::VectorXd operator()(const Eigen::VectorXd& sigma) const {
    std::vector<Eigen::ArrayXd> added(pattern_.size(), Eigen::ArrayXd::Zero(spectra_.weight.size()));
    add(sigma, added);
    return arriving(added);
  }

private:
  const PatternSpectra& spectra_;
  const LinkedPattern& pattern_;
  Eigen::ArrayXd divisor_;
  std::vector<LossyLink> lossy_;
};

std::vector<double> limits_by(const PatternSpectra& spectra, const LinkedPattern& pattern, double speed) {
  const std::size_t m = pattern.size();
  std::vector<Eigen::ArrayXd> added;
  for (std::size_t j = 0; j < m; ++j) added.push_back(spectra.added_by_noise(pattern.type(j)));
  const LossGains gains(spectra, pattern);
  if (!gains.lossy().empty()) {
    Eigen::VectorXd given = gains.arriving(added);
    const Eigen::ArrayXd nothing = Eigen::ArrayXd::Zero(spectra.weight.size());
    for (std::size_t row = 0; row < gains.lossy().size(); ++row) {
      const LossyLink& of = gains.lossy()[row];
      given(static_cast<Eigen::Index>(row)) += loss_variance(spectra, pattern, of.vehicle, of.link, nothing, speed);
    }
    gains.add(solve_one_minus(gains, given), added);
  }
  std::vector<double> limits;
  Eigen::ArrayXd spectrum = spectra.in_front(added, gains.divisor());
  for (std::size_t j = 0; j < m; ++j) {
    limits.push_back(spectra.error_variance(pattern.type(j), spectrum, added[j]));
    spectrum = spectra.gain[pattern.type(j)] * spectrum + added[j];
  }
  return limits;
}

/// values(spectra) on quadratures that are refined until they settle; `endless`: values of an endless string.
template <class Values>
std::vector<double> settled(const LinkedPattern& pattern, bool endless, const Values& values) {
  const PatternGain gain = pattern.gain();
  return refined([&](int refinement) { return values(PatternSpectra(pattern, gain, endless, refinement)); });
}

}  // namespace

std::vector<double> stationary_variances(const LinkedPattern& pattern, double speed, std::size_t followers) {
  return settled(pattern, false,
                 [&](const PatternSpectra& spectra) { return variances_by(spectra, pattern, speed, followers); });
}

std::vector<std::array<double, 2>> variances_by_input(const LinkedPattern& pattern, double speed,
                                                      std::size_t followers) {
  const std::vector<double> shares = settled(
      pattern, false, [&](const PatternSpectra& spectra) { return shares_by(spectra, pattern, speed, followers); });
  std::vector<std::array<double, 2>> result;
  for (std::size_t i = 0; i < followers; ++i) result.push_back({shares[2 * i], shares[2 * i + 1]});
  return result;
}

std::vector<double> limit_variances(const LinkedPattern& pattern, double speed) {
  return settled(pattern, true, [&](const PatternSpectra& spectra) { return limits_by(spectra, pattern, speed); });
}

double loss_gain(const LinkedPattern& pattern) {
  if (!pattern.has_losses()) return 0.0;
  const auto root = [&](const PatternSpectra& spectra) {
    const LossGains gains(spectra, pattern);
    return std::vector<double>{perron_root(gains, gains.dimensions())};
  };
  return settled(pattern, true, root).front();
}

double loss_margin(const LinkedPattern& pattern) {
  if (!pattern.has_losses()) return kInfinity;
  const PatternSpectra spectra(pattern, pattern.gain(), true, 0);
  const LossGains gains(spectra, pattern);
  double found = perron_root_beside_one(gains, gains.dimensions());
  if (std::abs(found - 1.0) < 1e-9) found = loss_gain(pattern);  // with refined panels
  return 1.0 / found - 1.0;
}

}  // namespace platoon
