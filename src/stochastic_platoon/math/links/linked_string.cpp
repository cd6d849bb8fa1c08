#include "stochastic_platoon/math/links/linked_string.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "stochastic_platoon/math/links/loss_operator.hpp"
#include "stochastic_platoon/math/links/settled_spectra.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/krylov.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

/// The spectrum that the losses of a link scatter from one that is sent.
Eigen::ArrayXd scattered(const LossScatter& losses, const Eigen::ArrayXd& sent) {
  return losses(losses.drives(sent.matrix()));
}

/// What a link adds to the spectrum of its vehicle's position at this speed, without the part scattered from the
/// predecessor's.
Eigen::ArrayXd constant_part(const StringSpectra::Input& input, double speed) {
  Eigen::ArrayXd added = input.passed * input.noise;
  if (!input.losses) return added;
  Eigen::ArrayXd of_losses = scattered(*input.losses, input.noise);
  const double constant_drive = speed * input.losses->slope();
  if (speed != 0.0) of_losses += constant_drive * constant_drive * input.losses->of_constant_drive();
  return added + input.own * of_losses;
}

std::vector<Eigen::ArrayXd> constant_parts(const StringSpectra::Type& type, double speed) {
  std::vector<Eigen::ArrayXd> parts;
  for (const StringSpectra::Input& input : type.inputs)
    parts.push_back(constant_part(input, parts.empty() ? speed : 0.0));
  return parts;
}

std::vector<double> variances_by(const StringSpectra& spectra, double speed, std::size_t followers) {
  std::vector<double> variances;
  pass_along(spectra, speed, followers, [&](std::size_t i, const auto& spectrum, const auto& added) {
    double variance = spectra.error_variance(i, spectrum, added.front());
    if (added.size() > 1) variance += spectra.mean(spectra[i].spacing_gain * added.back());
    variances.push_back(std::isnan(variance) ? kInfinity : variance);
    return !std::isinf(variances.back());
  });
  variances.resize(followers, kInfinity);
  return variances;
}

std::vector<double> shares_by(const StringSpectra& spectra, double speed, std::size_t followers) {
  std::vector<double> shares(2 * followers, 0.0);
  std::array<Eigen::ArrayXd, 2> part;
  for (Eigen::ArrayXd& of : part) of = Eigen::ArrayXd::Zero(spectra.nodes());
  pass_along(spectra, speed, followers, [&](std::size_t i, const auto&, const auto& added) {
    for (std::size_t link = 0; link < part.size(); ++link) {
      const Eigen::ArrayXd own = link < added.size() ? added[link] : Eigen::ArrayXd::Zero(spectra.nodes());
      shares[2 * i + link] = spectra.error_variance(i, part[link], own);
      part[link] = spectra[i].gain * part[link] + own;
    }
    return true;
  });
  return shares;
}

std::vector<double> limits_by(const StringSpectra& spectra, double speed) {
  std::vector<Eigen::ArrayXd> added;
  for (std::size_t j = 0; j < spectra.size(); ++j) {
    added.emplace_back(Eigen::ArrayXd::Zero(spectra.nodes()));
    for (const Eigen::ArrayXd& of_link : constant_parts(spectra[j], speed)) added.back() += of_link;
  }
  const LossOperator losses(spectra);
  if (losses.dimensions() > 0) losses.add(solve_one_minus(losses, losses.drives(added)), added);
  std::vector<double> limits;
  Eigen::ArrayXd spectrum = spectra.in_front(added, losses.margin());
  for (std::size_t j = 0; j < spectra.size(); ++j) {
    limits.push_back(spectra.error_variance(j, spectrum, added[j]));
    spectrum = spectra[j].gain * spectrum + added[j];
  }
  return limits;
}

}  // namespace

void pass_along(const StringSpectra& spectra, double speed, std::size_t followers, const SpectraVisitor& visit) {
  std::vector<std::vector<Eigen::ArrayXd>> constant;  // per type
  Eigen::ArrayXd spectrum = Eigen::ArrayXd::Zero(spectra.nodes());
  for (std::size_t i = 0; i < followers; ++i) {
    check_interruption();
    const StringSpectra::Type& type = spectra[i];
    const std::size_t index = spectra.type(i);
    if (index >= constant.size()) constant.resize(index + 1);
    if (constant[index].empty()) constant[index] = constant_parts(type, speed);
    std::vector<Eigen::ArrayXd> added = constant[index];
    for (std::size_t link = 0; link < added.size() && i > 0; ++link) {
      const StringSpectra::Input& input = type.inputs[link];
      if (input.losses) added[link] += input.own * scattered(*input.losses, spectra.at_link(i, link, spectrum));
    }
    if (!visit(i, spectrum, added)) return;
    spectrum *= type.gain;
    for (const Eigen::ArrayXd& of_link : added) spectrum += of_link;
  }
}

std::vector<double> stationary_variances(const LinkedPattern& pattern, double speed, std::size_t followers) {
  return settled_values(pattern, followers,
                        [&](const StringSpectra& spectra) { return variances_by(spectra, speed, followers); });
}

std::vector<std::array<double, 2>> variances_by_input(const LinkedPattern& pattern, double speed,
                                                      std::size_t followers) {
  const std::vector<double> shares = settled_values(
      pattern, followers, [&](const StringSpectra& spectra) { return shares_by(spectra, speed, followers); });
  std::vector<std::array<double, 2>> result;
  for (std::size_t i = 0; i < followers; ++i) result.push_back({shares[2 * i], shares[2 * i + 1]});
  return result;
}

std::vector<double> limit_variances(const LinkedPattern& pattern, double speed) {
  return settled_values(pattern, std::nullopt, [&](const StringSpectra& spectra) { return limits_by(spectra, speed); });
}

double loss_gain(const LinkedPattern& pattern) {
  if (!pattern.has_losses()) return 0.0;
  const auto root = [](const StringSpectra& spectra) {
    const LossOperator losses(spectra);
    return std::vector<double>{perron_root(losses, losses.dimensions())};
  };
  return settled_values(pattern, std::nullopt, root).front();
}

double loss_margin(const LinkedPattern& pattern) {
  constexpr double kShare = 1e-4;  // accuracy of the distance from 1
  if (!pattern.has_losses()) return kInfinity;
  const auto root = [&pattern](const StringSpectra& spectra) {
    const LossOperator losses(spectra);
    return perron_root_beside_one(losses, losses.dimensions(), pattern.has_memory() ? kShare : 0.0);
  };
  return 1.0 / settled_beside_one(pattern, root) - 1.0;
}

}  // namespace platoon
