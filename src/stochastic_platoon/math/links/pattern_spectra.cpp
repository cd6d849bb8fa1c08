#include "stochastic_platoon/math/links/pattern_spectra.hpp"

#include <algorithm>
#include <complex>
#include <cstdint>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"

namespace platoon {

namespace {

constexpr std::int64_t kResolvedDelay = 8;  // [steps], largest delay whose z^m the longest panels resolve

}  // namespace

PatternSpectra::PatternSpectra(const LinkedPattern& pattern, const PatternGain& pattern_gain, bool with_margin,
                               int refinement)
    : PatternFactors(pattern.order) {
  std::vector<std::complex<double>> singular;
  for (const LinkedVehicle& vehicle : pattern.types) {
    for (const std::complex<double>& w : vehicle.pole_frequencies()) singular.push_back(w);
  }
  if (with_margin) {
    for (const std::complex<double>& w : pattern_gain.margin_frequencies()) singular.push_back(w);
  }
  // Towards w = 0 the spectra narrow along the string; the panels must narrow too if delays oscillate.
  const bool delayed_much = std::any_of(pattern.types.begin(), pattern.types.end(), [](const LinkedVehicle& vehicle) {
    return vehicle.vehicle().link.delay > kResolvedDelay;
  });
  std::vector<double> peaks = with_margin ? std::vector<double>() : pattern_gain.maxima();
  if (!with_margin || delayed_much) peaks.push_back(0.0);
  const Quadrature rule = half_circle_quadrature(singular, peaks, refinement);
  const auto count = static_cast<Eigen::Index>(rule.node.size());
  weight = Eigen::Map<const Eigen::ArrayXd>(rule.weight.data(), count);
  std::vector<CirclePoint> points;
  for (const double w : rule.node) points.emplace_back(w);
  from_one.resize(count);
  for (Eigen::Index k = 0; k < count; ++k)
    from_one(k) = static_cast<double>(circle_coordinate(rule.node[static_cast<std::size_t>(k)], Centre::kOne));
  for (const LinkedVehicle& vehicle : pattern.types) {
    for (auto* values : {&gain, &margin, &complement, &spacing_gain, &delayed, &of_gap, &sent})
      values->emplace_back(Eigen::ArrayXd::Zero(count));
    input.emplace_back(vehicle.links().size());
    for (Input& of : input.back()) {
      for (auto* values : {&of.loss_gain, &of.passed, &of.innovation, &of.noise}) values->resize(count);
    }
    const auto delay = static_cast<double>(vehicle.vehicle().link.delay);
    const OscillatingWeights oscillating(rule, delay);
    for (Eigen::Index k = 0; k < count; ++k) {
      check_interruption();
      const auto node = static_cast<std::size_t>(k);
      const LinkedVehicleValue value = vehicle.at(points[node]);
      gain.back()(k) = value.gain;
      margin.back()(k) = value.margin;
      for (std::size_t j = 0; j < input.back().size(); ++j) {
        Input& of = input.back()[j];
        of.loss_gain(k) = value.input[j].loss_gain;
        of.passed(k) = value.input[j].passed;
        of.innovation(k) = value.input[j].innovation;
        of.noise(k) = value.input[j].noise;
      }
      sent.back()(k) = value.sent;
      complement.back()(k) = value.complement;
      spacing_gain.back()(k) = value.spacing_gain;
      of_gap.back()(k) = value.of_gap;
      if (!oscillating.applies_to(node)) continue;
      complement.back()(k) = 1.0 + std::norm(value.undelayed);
      delayed.back()(k) = -2.0 * (oscillating[node] * value.undelayed).real() / rule.weight[node];
      of_gap.back()(k) =
          1.0 + std::norm(value.response) - 2.0 * (oscillating[node] * value.response).real() / rule.weight[node];
    }
  }
}

double PatternSpectra::error_variance(std::size_t type, const Eigen::ArrayXd& spectrum,
                                      const Eigen::ArrayXd& added) const {
  return mean((complement[type] + delayed[type]) * spectrum + spacing_gain[type] * added);
}

Eigen::ArrayXd PatternSpectra::added_by_noise(std::size_t type) const {
  Eigen::ArrayXd added = Eigen::ArrayXd::Zero(weight.size());
  for (const Input& of : input[type]) added += of.passed * of.noise;
  return added;
}

}  // namespace platoon
