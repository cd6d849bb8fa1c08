#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/links/string_spectra.hpp"

namespace platoon {

/// The operator of loss gains (see loss_gain()) on the drives of all lossy links (see LossScatter). Drives of links
/// with the same losses are adjacent.
class LossOperator {
public:
  /// `spectra` must outlive the object.
  explicit LossOperator(const StringSpectra& spectra);

  Eigen::Index dimensions() const { return dimensions_; }
  const Eigen::ArrayXd& margin() const { return margin_; }

  /// Adds to each vehicle's spectrum the part of these drives that its losses scatter.
  void add(const Eigen::VectorXd& drives, std::vector<Eigen::ArrayXd>& added) const;

  /// The drives in an endless string in which vehicle l adds added[l] to the spectrum.
  Eigen::VectorXd drives(const std::vector<Eigen::ArrayXd>& added) const;

  /// The drives of each link whose losses have a memory: one value per node.
  std::vector<Eigen::VectorXd> spectra_of(const Eigen::VectorXd& drives) const;

  Eigen::VectorXd operator()(const Eigen::VectorXd& given) const;

private:
  /// The lossy links with the same losses.
  struct Alike {
    const LossScatter* losses;
    Eigen::Index first;                                      ///< of their drives
    std::vector<std::pair<std::size_t, std::size_t>> links;  ///< place in the pattern, and in its inputs
  };

  const StringSpectra& spectra_;
  Eigen::ArrayXd margin_;
  std::vector<Alike> alike_;
  std::vector<std::vector<Eigen::Index>> first_;  ///< of the drives of each link of each place, -1 without losses
  Eigen::Index dimensions_ = 0;
};

}  // namespace platoon
