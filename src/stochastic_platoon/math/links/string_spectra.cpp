#include "stochastic_platoon/math/links/string_spectra.hpp"

#include <algorithm>
#include <complex>
#include <utility>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/exp_minus_one.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"

namespace platoon {

StringSpectra::StringSpectra(const LinkedPattern& pattern, SpectralNodes nodes)
    : nodes_(std::move(nodes)), order_(pattern.order), from_one_(nodes_.count()) {
  for (Eigen::Index k = 0; k < nodes_.count(); ++k)
    from_one_(k) = static_cast<double>(circle_coordinate(nodes_.rule.node[static_cast<std::size_t>(k)], Centre::kOne));
  std::vector<std::pair<LossModel, std::shared_ptr<const LossScatter>>> known;
  for (const LinkedVehicle& vehicle : pattern.types) {
    std::vector<std::shared_ptr<const LossScatter>> losses;
    for (const LinkFilter& link : vehicle.links()) {
      losses.emplace_back();
      if (!link.has_losses()) continue;
      const LossModel& loss = link.losses().loss();
      auto same = std::find_if(known.begin(), known.end(), [&loss](const auto& of) { return of.first == loss; });
      if (same == known.end())
        same = known.insert(known.end(), {loss, std::make_shared<LossScatter>(link.losses(), nodes_)});
      losses.back() = same->second;
    }
    add(vehicle, std::move(losses));
  }
}

void StringSpectra::add(const LinkedVehicle& vehicle, std::vector<std::shared_ptr<const LossScatter>> losses) {
  Type type;
  for (auto* values : {&type.gain, &type.margin, &type.complement, &type.spacing_gain, &type.of_gap, &type.sent})
    values->resize(nodes());
  type.inputs.resize(losses.size());
  for (Input& of : type.inputs) {
    for (auto* values : {&of.own, &of.passed, &of.noise}) values->resize(nodes());
  }
  const OscillatingWeights oscillating(nodes_.rule, static_cast<double>(vehicle.vehicle().position().link.delay));
  LinkedVehicle::MeanEffects effects;
  for (Eigen::Index k = 0; k < nodes(); ++k) {
    check_interruption();
    const auto node = static_cast<std::size_t>(k);
    for (std::size_t j = 0; j < losses.size(); ++j) {
      if (losses[j]) effects[j] = losses[j]->effects()[node];
    }
    const LinkedVehicleValue value = vehicle.at(nodes_.points[node], effects);
    type.gain(k) = value.gain;
    type.margin(k) = value.margin;
    type.spacing_gain(k) = value.spacing_gain;
    type.sent(k) = value.sent;
    for (std::size_t j = 0; j < losses.size(); ++j) {
      type.inputs[j].own(k) = value.input[j].own;
      type.inputs[j].passed(k) = value.input[j].passed;
      type.inputs[j].noise(k) = value.input[j].noise;
    }
    type.complement(k) = value.complement;
    type.of_gap(k) = value.of_gap;
    if (!oscillating.applies_to(node)) continue;
    const std::complex<double> turn = -2.0 / nodes_.rule.weight[node] * oscillating[node];
    type.complement(k) = 1.0 + std::norm(value.undelayed) + (turn * value.undelayed).real();
    type.of_gap(k) = 1.0 + std::norm(value.response) + (turn * value.response).real();
  }
  for (std::size_t j = 0; j < losses.size(); ++j) type.inputs[j].losses = std::move(losses[j]);
  types_.push_back(std::move(type));
}

Eigen::ArrayXd StringSpectra::at_link(std::size_t follower, std::size_t link, const Eigen::ArrayXd& spectrum) const {
  return link == 0 ? spectrum : Eigen::ArrayXd((*this)[follower + size() - 1].sent * spectrum);
}

Eigen::ArrayXd StringSpectra::pattern_margin() const {
  Eigen::ArrayXd log = Eigen::ArrayXd::Zero(nodes());
  for (std::size_t t = 0; t < types_.size(); ++t) {
    const auto count = static_cast<double>(std::count(order_.begin(), order_.end(), t));
    const Eigen::ArrayXd &margin = types_[t].margin, &gain = types_[t].gain;
    log += count * (margin < 0.5).select((-margin).log1p(), gain.log());
  }
  return -exp_minus_one(log);
}

Eigen::ArrayXd StringSpectra::in_front(const std::vector<Eigen::ArrayXd>& added, const Eigen::ArrayXd& whole) const {
  Eigen::ArrayXd once = Eigen::ArrayXd::Zero(nodes());
  for (std::size_t j = 0; j < size(); ++j) once = (*this)[j].gain * once + added[j];
  return once / whole;
}

double StringSpectra::error_variance(std::size_t follower, const Eigen::ArrayXd& spectrum,
                                     const Eigen::ArrayXd& added) const {
  const Type& type = (*this)[follower];
  return mean(type.complement * spectrum + type.spacing_gain * added);
}

}  // namespace platoon
