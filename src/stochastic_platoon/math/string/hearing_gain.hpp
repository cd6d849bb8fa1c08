#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
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

  /// The largest of a dense grid of frequencies, from far below slowest() on and denser than the turns of the longest
  /// delay, refined between its neighbours.
  Peak peak() const;

  /// The least modulus of a frequency at which a vehicle's loop, policy or link changes [rad/sample].
  double slowest() const { return slowest_; }

private:
  std::vector<double> grid() const;
  Eigen::MatrixXcd product(double w) const;
  std::size_t first() const { return (reach_ / period_ + 1) * period_ + 1; }

  const PlatoonModel& model_;
  std::size_t reach_, period_;
  double slowest_;
  std::vector<HearingLoop> loops_;               ///< per place in the pattern
  std::vector<std::vector<LossFilter>> losses_;  ///< of each of its inputs
};

/// The longest way of a value from its source to the vehicle that hears it, with the delay of its plant [steps].
std::int64_t longest_delay(const PlatoonModel& model);

}  // namespace platoon
