#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/numerics/exp_minus_one.hpp"

namespace platoon {

/// Gains of one pattern's vehicles at the nodes of a quadrature over the circle. Spectra have one row per node.
struct PatternFactors {
  std::vector<std::size_t> order;      ///< index of the type at each place of the pattern
  Eigen::ArrayXd weight;               ///< of the nodes; their sum is 1
  std::vector<Eigen::ArrayXd> gain;    ///< |T^|^2, per type
  std::vector<Eigen::ArrayXd> margin;  ///< 1 - |T^|^2, per type

  explicit PatternFactors(std::vector<std::size_t> types) : order(std::move(types)) {}

  std::size_t size() const { return order.size(); }                          ///< number of vehicles in the pattern
  std::size_t type(std::size_t j) const { return order[j % order.size()]; }  ///< of vehicle j
  Eigen::Index nodes() const { return weight.size(); }

  /// Mean over the circle of values at the nodes.
  double mean(const Eigen::ArrayXd& values) const { return (weight * values).sum(); }

  /// 1 - prod |T^|^2 over the pattern, as accurate as each vehicle's own margin. Uses logarithms: at a resonance one
  /// vehicle's gain may be 1e9 and that of the product 1e-9.
  Eigen::ArrayXd pattern_margin() const {
    Eigen::ArrayXd log = Eigen::ArrayXd::Zero(nodes());
    for (std::size_t t = 0; t < gain.size(); ++t) {
      const auto count = static_cast<double>(std::count(order.begin(), order.end(), t));
      log += count * (margin[t] < 0.5).select((-margin[t]).log1p(), gain[t].log());
    }
    return -exp_minus_one(log);
  }

  /// The spectrum in front of vehicle 0 of an endless string in which vehicle l adds added[l] to the spectrum. The
  /// spectrum in front of vehicle j + 1 is gain times the one in front of vehicle j, plus added[j]. `whole`: the
  /// pattern_margin().
  Eigen::ArrayXd in_front(const std::vector<Eigen::ArrayXd>& added, const Eigen::ArrayXd& whole) const {
    Eigen::ArrayXd once = Eigen::ArrayXd::Zero(nodes());
    for (std::size_t j = 0; j < size(); ++j) once = gain[order[j]] * once + added[j];
    return once / whole;
  }
};

}  // namespace platoon
