#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <vector>

#include "stochastic_platoon/math/string/burst_spectra.hpp"

namespace platoon {

/// The operator of loss gains (see loss_gain()) on the drives of all lossy places. Drives of places with
/// the same losses are adjacent.
class LossOperator {
public:
  explicit LossOperator(const BurstSpectra& spectra);

  Eigen::Index dimensions() const { return static_cast<Eigen::Index>(lossy_.size()) * spectra_.size(); }
  const Eigen::ArrayXd& margin() const { return margin_; }

  /// Adds to each vehicle's spectrum the part of these drives that its losses scatter.
  void add(const Eigen::VectorXd& drives, std::vector<Eigen::ArrayXd>& added) const;

  /// The drives in an endless string in which vehicle l adds added[l] to the spectrum.
  Eigen::VectorXd drives(const std::vector<Eigen::ArrayXd>& added) const;

  Eigen::VectorXd operator()(const Eigen::VectorXd& given) const;

private:
  const BurstSpectra& spectra_;
  Eigen::ArrayXd margin_;
  std::vector<std::size_t> lossy_;   ///< places in the pattern, in the order of their drives
  std::vector<Eigen::Index> drive_;  ///< of each place in the pattern, -1 without losses
};

/// values(spectra), with the number of nodes increased until they settle.
std::vector<double> settled_values(const BurstPattern& pattern,
                                   const std::function<std::vector<double>(const BurstSpectra&)>& values);

/// The same for values of an endless string (limits, loss gain): few nodes resolve them near the border of stability,
/// too.
std::vector<double> settled_values_of_endless(const BurstPattern& pattern,
                                              const std::function<std::vector<double>(const BurstSpectra&)>& values);

}  // namespace platoon
