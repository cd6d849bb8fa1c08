#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

namespace platoon {

/// Multiplicity of the factor w^2 in spectral gains at low frequencies.
struct ZerosAtZero {
  int complement;  ///< |1 - H T^|^2: 1 if delay or losses leave a mean error at constant speed, 2 or more otherwise
  int innovation;  ///< from the predecessor's position to a link's prediction error: |(1 - L) F|^2, 1 for holding, ...
  int noise;       ///< of all links; kNone without noise
  static constexpr int kNone = 1000;
};

/// One link into a follower on the unit circle, its independent losses replaced by their mean effect. With p = 1 - q
/// and the predictor L = c_1 z^-1 + c_2 z^-2 + ..., the link multiplies the sent values by p F z^-m, F = 1 / (1 - q L).
/// The losses act on the moments as a white noise w = (theta - p) e at its output, F w, with theta 1 if a value arrives
/// and 0 if not; w is uncorrelated with everything sent and has variance E w^2 = p q E e^2.
class LinkFilter {
public:
  /// Throws std::invalid_argument for losses in bursts.
  LinkFilter(const LinkModel& link, double noise_variance);

  struct Value {
    std::complex<long double> powers;     ///< z^n, n the length of the predictor
    std::complex<long double> registers;  ///< z^n / F
    std::complex<long double> surprise;   ///< z^n (1 - L)
    double innovation;                    ///< |(1 - L) F|^2: from the sent value to its prediction error e
    double noise;                         ///< |W|^2 P_d + D^2 / 12

    /// q / p (1 - L), which is 1 / (p F) - 1.
    std::complex<long double> excess(long double p) const { return (1.0L - p) / p * surprise / powers; }
  };
  Value at(const CirclePoint& point) const;

  bool has_losses() const { return loss_.probability > 0.0; }
  const LossModel& loss() const { return loss_; }
  std::int64_t delay() const { return link_.delay; }
  long double arrival() const { return 1.0L - static_cast<long double>(loss_.probability); }  ///< p

  double loss_feedback() const { return loss_feedback_; }  ///< p q ||L F||^2; infinite: F is unstable

  /// kappa = p q / (1 - p q ||L F||^2): E w^2 over the E e^2 without the feedback of w through the link.
  double loss_factor() const;

  /// (c_1 + 2 c_2 + ...) / p: the mean of e if the sent value grows by 1 per step; 0 without losses.
  double mean_innovation() const;

  /// Mean lag of a signal that grows steadily [steps]: m + q (c_1 + 2 c_2 + ...) / p.
  double lag() const { return static_cast<double>(link_.delay) + loss_.probability * mean_innovation(); }

  /// Multiplicity of z = 1 as a zero of 1 - L, and of the noise; ZerosAtZero::kNone without noise.
  int surprise_zeros() const;
  int noise_zeros() const;

  /// z^n / F by powers of z - 1.
  const CirclePolynomial& registers() const { return near_.registers; }

  /// The complex frequencies at which the noise is singular.
  std::vector<std::complex<double>> noise_frequencies() const;

private:
  struct Half {
    CirclePolynomial registers, surprise;
  };

  LinkModel link_;
  double noise_variance_;
  LossModel loss_;  ///< probability 0 without a loss stage
  double loss_feedback_;
  Half near_, far_;
};

}  // namespace platoon
