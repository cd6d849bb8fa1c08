#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/links/loss_filter.hpp"
#include "stochastic_platoon/math/model/hearing_loop.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// The spectral radius of the product over a pattern of the companion matrices of string_stability() at a frequency.
class HearingGain {
public:
  /// `model` must outlive the object.
  explicit HearingGain(const PlatoonModel& model);

  double operator()(double w) const;

  /// Whether the product has more than one eigenvalue of modulus 1 at w = 0. In the mode of the eigenvalue 1 all
  /// vehicles move alike. Another one means that the vehicles form strings that do not hear each other, and the
  /// variances of the distances between these strings grow without bound.
  bool falls_apart() const;

  struct Peak {
    double gain, frequency;
  };

  /// The largest of a dense grid of frequencies, refined between its neighbours.
  Peak peak() const;

private:
  Eigen::MatrixXcd product(double w) const;
  std::size_t first() const { return (reach_ / period_ + 1) * period_ + 1; }

  const PlatoonModel& model_;
  std::size_t reach_, period_;
  std::vector<HearingLoop> loops_;               ///< per place in the pattern
  std::vector<std::vector<LossFilter>> losses_;  ///< of each of its inputs
};

}  // namespace platoon
