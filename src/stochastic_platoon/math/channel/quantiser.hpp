#pragma once

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/noise/white_noise.hpp"

namespace platoon {

/// Quantisation with subtractive dither: s = D floor((y + nu) / D + 1/2) - nu, with nu uniform in [-D/2, D/2) and known
/// at both ends of the link. The error s - y is white, uniform, independent of y and of variance D^2 / 12 (L.
/// Schuchman, IEEE Trans. Communication Technology 12, 1964).
class Quantiser : public LinkStage {
public:
  /// step_size is D [m], receiver i >= 1. Throws std::invalid_argument unless D is finite and > 0.
  Quantiser(double step_size, const WhiteNoise& noise, std::uint32_t receiver);

  bool keeps_state() const override { return false; }
  void start(std::uint64_t, std::size_t, double*, double) override {}
  void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) override;

private:
  double step_size_;
  WhiteNoise draws_;
  std::uint32_t receiver_;
};

}  // namespace platoon
