#include "stochastic_platoon/math/links/linked_string.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/links/loss_operator.hpp"
#include "stochastic_platoon/math/links/settled_spectra.hpp"
#include "stochastic_platoon/math/model/input.hpp"
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

/// What the places of an endless string add, and the spectrum in front of the first of them.
struct EndlessPlaces {
  std::vector<Eigen::ArrayXd> added;
  Eigen::ArrayXd in_front;
};

EndlessPlaces endless_places(const StringSpectra& spectra, double speed) {
  EndlessPlaces string;
  for (std::size_t j = 0; j < spectra.size(); ++j) string.added.push_back(sum_of(constant_parts(spectra[j], speed)));
  const LossOperator losses(spectra);
  if (losses.dimensions() > 0) losses.add(solve_one_minus(losses, losses.drives(string.added)), string.added);
  string.in_front = spectra.in_front(string.added, losses.margin());
  return string;
}

std::vector<double> limits_by(const StringSpectra& spectra, double speed) {
  EndlessPlaces string = endless_places(spectra, speed);
  std::vector<double> limits;
  LinkedWalk walk(spectra, speed, std::move(string.in_front));
  for (Eigen::ArrayXd& of_place : string.added) {
    walk.pass(std::move(of_place));
    limits.push_back(walk.error_variance());
  }
  return limits;
}

}  // namespace

LinkedWalk::LinkedWalk(const StringSpectra& spectra, double speed)
    : spectra_(&spectra), speed_(speed), behind_leader_(true), spectrum_(Eigen::ArrayXd::Zero(spectra.nodes())) {}

LinkedWalk::LinkedWalk(const StringSpectra& spectra, double speed, Eigen::ArrayXd ahead)
    : spectra_(&spectra), speed_(speed), behind_leader_(false), spectrum_(std::move(ahead)) {}

LinkedWalk LinkedWalk::behind_endless(const StringSpectra& spectra, double speed) {
  return LinkedWalk(spectra, speed, endless_places(spectra, speed).in_front);
}

std::vector<Eigen::ArrayXd> LinkedWalk::added() {
  const StringSpectra& spectra = *spectra_;
  const StringSpectra::Type& type = spectra[next_];
  const std::size_t index = spectra.type(next_);
  if (index >= constant_.size()) constant_.resize(index + 1);
  if (constant_[index].empty()) constant_[index] = constant_parts(type, speed_);
  std::vector<Eigen::ArrayXd> added = constant_[index];
  for (std::size_t link = 0; link < added.size() && !behind_leader_; ++link) {
    const StringSpectra::Input& input = type.inputs[link];
    if (input.losses) added[link] += input.own * scattered(*input.losses, spectra.at_link(next_, link, spectrum_));
  }
  return added;
}

void LinkedWalk::pass(Eigen::ArrayXd added) {
  check_interruption();
  before_.swap(spectrum_);
  spectrum_ = (*spectra_)[next_].gain * before_ + added;
  added_ = std::move(added);
  behind_leader_ = false;
  ++next_;
}

std::array<double, 2> LinkedWalk::moments(const Signal& signal) const {
  if (signal.is_relative() && signal.own.order > 0) throw std::logic_error("two terms: need cross spectra");
  Eigen::ArrayXd spectrum = spectrum_;
  if (signal.is_relative()) spectrum = (*spectra_)[next_ - 1].of_gap * before_ + added_;
  const Signal::Term& term = signal.is_relative() ? signal.apart : signal.own;
  for (int n = 0; n < term.order; ++n) spectrum *= 2.0 * spectra_->from_one();
  spectrum *= term.factor * term.factor;
  return {spectra_->mean(spectrum), 2.0 * spectra_->mean(spectra_->from_one() * spectrum)};
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
