#include <array>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace detail {

// d = gain g + first; first: the filter's first register, null for none.
PLATOON_VECTOR_CLONES
void filter_output(double gain, const double* normals, const double* first, std::size_t size, double* noise) {
  if (first == nullptr) {
    for (std::size_t r = 0; r < size; ++r) noise[r] = gain * normals[r];
  } else {
    for (std::size_t r = 0; r < size; ++r) noise[r] = gain * normals[r] + first[r];
  }
}

// v = b g - a d + next (null: 0)
PLATOON_VECTOR_CLONES
void filter_register(double b, const double* normals, double a, const double* noise, const double* next,
                     std::size_t size, double* v) {
  if (next == nullptr) {
    for (std::size_t r = 0; r < size; ++r) v[r] = b * normals[r] - a * noise[r];
  } else {
    for (std::size_t r = 0; r < size; ++r) v[r] = b * normals[r] - a * noise[r] + next[r];
  }
}

PLATOON_VECTOR_CLONES
void add_noise(double deviation, const double* noise, std::size_t size, double* positions) {
  for (std::size_t r = 0; r < size; ++r) positions[r] = positions[r] + deviation * noise[r];
}

}  // namespace detail

namespace {

/// W runs in transposed direct form II,
/// \f[ d = b_0 g + v_1, \qquad v_j \gets b_j g - a_j d + v_{j+1}, \qquad v_{n+1} = 0. \f]
class ColouredNoise : public LinkStage {
public:
  ColouredNoise(double noise_variance, const TransferFunction& filter, const WhiteNoise& noise, std::uint32_t stream)
      : deviation_(standard_deviation("noise variance", noise_variance)), draws_(noise), stream_(stream) {
    const Polynomial &n = filter.numerator(), &d = filter.denominator();
    if (n.size() > d.size()) throw std::invalid_argument("noise filter: must be proper: no more zeros than poles");
    const Eigen::Index order = d.size() - 1, lead = d.size() - n.size();
    const auto b = [&](Eigen::Index j) { return j < lead ? 0.0 : n(j - lead); };
    gain_ = b(0);
    for (Eigen::Index j = 1; j <= order; ++j) {
      numerator_.push_back(b(j));
      denominator_.push_back(d(j));
    }
    registers_.resize(static_cast<std::size_t>(order));
  }

  bool keeps_state() const override { return !registers_.empty(); }

  void start(std::uint64_t, std::size_t count, double*, double) override {
    for (AlignedValues& v : registers_) v.assign(count, 0.0);
  }

  void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) override {
    std::array<double, kTile> normals, noise;
    const std::size_t order = registers_.size();
    for (std::size_t r = 0; r < count; r += kTile) {
      const std::size_t size = std::min(kTile, count - r);
      draws_.fill({stream_, step}, first_realization + r, size, normals.data());
      if (order == 0) {
        detail::add_noise(deviation_ * gain_, normals.data(), size, positions + r);
        continue;
      }
      const auto v = [&](std::size_t j) { return j < order ? &registers_[j][r] : nullptr; };
      detail::filter_output(gain_, normals.data(), v(0), size, noise.data());
      for (std::size_t j = 0; j < order; ++j) {
        detail::filter_register(numerator_[j], normals.data(), denominator_[j], noise.data(), v(j + 1), size, v(j));
      }
      detail::add_noise(deviation_, noise.data(), size, positions + r);
    }
  }

private:
  double deviation_;                             ///< [m]
  double gain_ = 0.0;                            ///< b_0
  std::vector<double> numerator_, denominator_;  ///< b_1 .. b_n, a_1 .. a_n
  WhiteNoise draws_;
  std::uint32_t stream_;
  std::vector<AlignedValues> registers_;  ///< v_1 .. v_n, one value per realization
};

}  // namespace

std::unique_ptr<LinkStage> coloured_noise(const Input& input, const WhiteNoise& noise, std::uint32_t stream) {
  if (input.noise_variance == 0.0) return nullptr;
  return std::make_unique<ColouredNoise>(input.noise_variance, input.link.noise_filter, noise, stream);
}

}  // namespace platoon
