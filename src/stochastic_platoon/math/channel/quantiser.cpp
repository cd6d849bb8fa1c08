#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace detail {

PLATOON_VECTOR_CLONES
void quantise(double step_size, const double* uniforms, std::size_t size, double* positions) {
  for (std::size_t r = 0; r < size; ++r) {
    const double dither = step_size * (uniforms[r] - 0.5);
    positions[r] = step_size * std::floor((positions[r] + dither) / step_size + 0.5) - dither;
  }
}

}  // namespace detail

namespace {

class Quantiser : public LinkStage {
public:
  Quantiser(double step_size, const WhiteNoise& noise, std::uint32_t stream)
      : step_size_(step_size), draws_(noise), stream_(stream) {
    if (step_size > 0.0 && std::isfinite(step_size)) return;
    throw std::invalid_argument("quantisation step: " + std::to_string(step_size) + ": must be finite and >= 0 [m]");
  }

  bool keeps_state() const override { return false; }
  void start(std::uint64_t, std::size_t, double*, double) override {}

  void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) override {
    std::array<double, kTile> uniforms;
    for (std::size_t r = 0; r < count; r += kTile) {
      const std::size_t size = std::min(kTile, count - r);
      draws_.fill_uniform({stream_, step, Purpose::dither}, first_realization + r, size, uniforms.data());
      detail::quantise(step_size_, uniforms.data(), size, positions + r);
    }
  }

private:
  double step_size_;
  WhiteNoise draws_;
  std::uint32_t stream_;
};

}  // namespace

std::unique_ptr<LinkStage> quantiser(const Input& input, const WhiteNoise& noise, std::uint32_t stream) {
  const double step = input.link.quantisation_step;
  return step == 0.0 ? nullptr : std::make_unique<Quantiser>(step, noise, stream);
}

}  // namespace platoon
