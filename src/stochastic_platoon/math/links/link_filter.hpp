#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/links/loss_filter.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

namespace platoon {

/// Multiplicity of the factor w^2 in spectral gains at low frequencies.
struct ZerosAtZero {
  int complement;  ///< |1 - H T^|^2: 1 if delay or losses leave a mean error at constant speed, 2 or more otherwise
  int innovation;  ///< from the predecessor's position to a link's prediction error: |1 - L|^2, 1 for holding, ...
  int noise;       ///< of all links; kNone without noise
  static constexpr int kNone = 1000;
};

/// One link into a follower on the unit circle: its losses, its delay z^-m and the spectrum of its noise.
class LinkFilter {
public:
  /// `known`: a link whose losses may be the same, to share them. Throws as LossFilter does.
  LinkFilter(const LinkModel& link, double noise_variance, const LinkFilter* known = nullptr);

  /// |W|^2 P_d + D^2 / 12.
  double noise(const CirclePoint& point) const;

  bool has_losses() const { return losses().has_losses(); }
  bool has_memory() const { return losses().has_memory(); }
  const LossFilter& losses() const { return *losses_; }
  std::int64_t delay() const { return link_.delay; }

  /// Mean lag of a signal that grows steadily [steps].
  double lag() const { return static_cast<double>(link_.delay) + losses_->lag(); }

  /// Multiplicity of z = 1 as a zero of the noise; ZerosAtZero::kNone without noise.
  int noise_zeros() const;

  /// The complex frequencies at which the noise is singular.
  std::vector<std::complex<double>> noise_frequencies() const;

private:
  LinkModel link_;
  double noise_variance_;
  std::shared_ptr<const LossFilter> losses_;  ///< of probability 0 without a loss stage
};

}  // namespace platoon
