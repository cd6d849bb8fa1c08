#include "stochastic_platoon/math/channel/awgn_channel.hpp"

#include <algorithm>

#include "stochastic_platoon/math/numerics/aligned_values.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace detail {

// out = in + value out
PLATOON_VECTOR_CLONES
void scale_and_add(double value, const double* in, std::size_t size, double* out) {
  for (std::size_t r = 0; r < size; ++r) out[r] = in[r] + value * out[r];
}

}  // namespace detail

AwgnChannel::AwgnChannel(double noise_variance, const WhiteNoise& noise, std::uint32_t receiver)
    : noise_(noise), deviation_(standard_deviation("noise variance", noise_variance)), receiver_(receiver) {}

void AwgnChannel::transmit(std::int64_t step, std::uint64_t first_realization, const double* sent, std::size_t count,
                           double* received) const {
  if (step < 0 || deviation_ == 0.0) {
    std::copy_n(sent, count, received);
    return;
  }
  for (std::size_t r = 0; r < count; r += kTile) {
    const std::size_t size = std::min(kTile, count - r);
    noise_.fill({receiver_, step}, first_realization + r, size, received + r);
    detail::scale_and_add(deviation_, sent + r, size, received + r);
  }
}

}  // namespace platoon
