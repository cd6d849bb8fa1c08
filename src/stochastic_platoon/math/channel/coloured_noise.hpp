#pragma once

#include <vector>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/model/transfer_function.hpp"
#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"

namespace platoon {

/// Coloured noise: position + sqrt(P_d) W(z) g, with g the standard normal white noise of AwgnChannel from k = 0 on and
/// W initially at rest. W runs in transposed direct form II,
/// \f[ d = b_0 g + v_1, \qquad v_j \gets b_j g - a_j d + v_{j+1}, \qquad v_{n+1} = 0. \f]
class ColouredNoise : public LinkStage {
public:
  /// noise_variance is P_d [m^2], receiver i >= 1. Throws std::invalid_argument unless P_d is finite and >= 0 and W is
  /// proper.
  ColouredNoise(double noise_variance, const TransferFunction& filter, const WhiteNoise& noise, std::uint32_t receiver);

  bool keeps_state() const override { return !registers_.empty(); }
  void start(std::uint64_t first_realization, std::size_t count, double* positions, double slope) override;
  void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) override;

private:
  double deviation_;                             ///< [m]
  double gain_ = 0.0;                            ///< b_0
  std::vector<double> numerator_, denominator_;  ///< b_1 .. b_n, a_1 .. a_n
  WhiteNoise draws_;
  std::uint32_t receiver_;
  std::vector<AlignedValues> registers_;  ///< v_1 .. v_n, one value per realization
};

}  // namespace platoon
