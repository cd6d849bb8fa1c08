#pragma once

#include <cstddef>
#include <cstdint>

#include "stochastic_platoon/math/noise/white_noise.hpp"

namespace platoon {

/// The paper's channel into vehicle i: received = sent + d_i(k), with d_i(k) = sqrt(P_d) g(seed, i, k, r) for k >= 0
/// and 0 for k = -1 (paper, assumption d and e). Stateless.
class AwgnChannel {
public:
  /// noise_variance is P_d [m^2], receiver is i >= 1. Throws std::invalid_argument unless P_d is finite and >= 0.
  AwgnChannel(double noise_variance, const WhiteNoise& noise, std::uint32_t receiver);

  /// sent and received: one position per realization first_realization .. first_realization + count - 1 [m].
  void transmit(std::int64_t step, std::uint64_t first_realization, const double* sent, std::size_t count,
                double* received) const;

private:
  WhiteNoise noise_;
  double deviation_;  ///< sqrt(P_d) [m]
  std::uint32_t receiver_;
};

}  // namespace platoon
