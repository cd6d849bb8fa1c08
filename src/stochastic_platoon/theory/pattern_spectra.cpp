#include "stochastic_platoon/theory/pattern_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "stochastic_platoon/theory/quadrature.hpp"

namespace platoon {

PatternSpectra::PatternSpectra(const std::vector<LinkedVehicle>& vehicles, const PatternGain& pattern_gain,
                               bool with_margin, int refinement) {
  std::vector<std::complex<double>> singular;
  double delay = 1.0;
  for (const LinkedVehicle& vehicle : vehicles) {
    for (const std::complex<double>& w : vehicle.pole_frequencies()) singular.push_back(w);
    delay = std::max(delay, static_cast<double>(vehicle.vehicle().link.delay));
  }
  if (with_margin) {
    for (const std::complex<double>& w : pattern_gain.margin_frequencies()) singular.push_back(w);
  }
  std::vector<double> peaks = with_margin ? std::vector<double>() : pattern_gain.critical_frequencies();
  peaks.push_back(0.0);
  const int of_delay = static_cast<int>(std::ceil(std::log2(std::max(1.0, delay / 16.0))));
  const Quadrature rule = half_circle_quadrature(singular, peaks, refinement + of_delay);
  const auto count = static_cast<Eigen::Index>(rule.node.size());
  weight = Eigen::Map<const Eigen::ArrayXd>(rule.weight.data(), count);
  for (const LinkedVehicle& vehicle : vehicles) {
    for (auto* values : {&gain, &margin, &loss_gain, &innovation, &noise, &complement, &headway})
      values->emplace_back(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const LinkedVehicleValue value = vehicle.at(rule.node[static_cast<std::size_t>(k)]);
      gain.back()(k) = value.gain;
      margin.back()(k) = value.margin;
      loss_gain.back()(k) = value.loss_gain;
      innovation.back()(k) = value.innovation;
      noise.back()(k) = value.noise;
      complement.back()(k) = value.complement;
      headway.back()(k) = value.headway;
    }
  }
}

Eigen::ArrayXd PatternSpectra::pass(std::size_t j, const Eigen::ArrayXd& added,
                                    Eigen::ArrayXd& spectrum) const {
  Eigen::ArrayXd error = complement[j] * spectrum + headway[j] * added;
  spectrum = gain[j] * spectrum + added;
  return error;
}

Eigen::ArrayXd PatternSpectra::pattern_margin() const {
  Eigen::ArrayXd sum = margin.front(), product = gain.front();
  for (std::size_t j = 1; j < gain.size(); ++j) {
    sum += product * margin[j];
    product *= gain[j];
  }
  return sum;
}

Eigen::ArrayXd PatternSpectra::between(std::size_t from, std::size_t to) const {
  Eigen::ArrayXd product = Eigen::ArrayXd::Ones(weight.size());
  for (std::size_t j = (from + 1) % gain.size(); j != to; j = (j + 1) % gain.size()) product *= gain[j];
  return product;
}

Eigen::ArrayXd PatternSpectra::before(std::size_t j, const std::vector<Eigen::ArrayXd>& added) const {
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(weight.size());
  for (std::size_t l = 0; l < added.size(); ++l) sum += between(l, j) * added[l];
  return sum / pattern_margin();
}

}  // namespace platoon
