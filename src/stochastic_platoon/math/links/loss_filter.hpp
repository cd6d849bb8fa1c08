#pragma once

#include <complex>
#include <memory>

#include "stochastic_platoon/math/links/loss_kernel.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

namespace platoon {

/// The losses of one link on the unit circle. The link multiplies the sent values by T_L on average and scatters their
/// spectrum (see LossKernel).
///
/// Independent losses need no chain. With p = 1 - q and the predictor L = c_1 z^-1 + c_2 z^-2 + ..., T_L = p F, F = 1 /
/// (1 - q L), and the losses act on the moments as a white noise w = (theta - p) e at the output of the link, F w, with
/// theta 1 if a value arrives and 0 if not; w is uncorrelated with everything sent and has variance E w^2 = p q E e^2.
class LossFilter {
public:
  /// Throws std::invalid_argument as LossKernel does, unless feedback() is 1 or more.
  explicit LossFilter(const LossModel& loss);

  struct Value {
    std::complex<long double> passed = 1.0L, excess = 0.0L;  ///< T_L and 1 / T_L - 1

    static Value of_missing(std::complex<long double> missing) { return {1.0L - missing, missing / (1.0L - missing)}; }

    /// 1 / |T_L|^2 - 1.
    long double squared_excess() const { return 2.0L * excess.real() + std::norm(excess); }
  };
  Value at(const CirclePoint& point) const;

  /// For independent losses: |F|^2, and |(1 - L) F|^2 from the sent value to its prediction error e.
  struct RankOne {
    double returned, innovation;
  };
  RankOne rank_one(const CirclePoint& point) const;

  const LossModel& loss() const { return loss_; }
  bool has_losses() const { return loss_.probability > 0.0; }
  bool has_memory() const { return has_losses() && !loss_.is_independent(); }

  /// The losses as a chain; null for independent ones, and if feedback() is 1 or more.
  const LossKernel* kernel() const { return kernel_.get(); }

  /// Growth of the second moments of predictions from predictions: p q ||L F||^2 of independent losses, infinite if F
  /// is unstable; second_moment_radius() of others. The variance of what the vehicle uses settles if it is below 1.
  double feedback() const { return feedback_; }

  /// kappa = p q / (1 - p q ||L F||^2) of independent losses: E w^2 over the E e^2 without the feedback of w.
  double loss_factor() const;

  /// c_1 + 2 c_2 + ...: what the prediction of a value lacks that grows by 1 per step.
  double slope() const;

  /// Mean lag of a signal that grows steadily [steps].
  double lag() const;

  /// Multiplicity of z = 1 as a zero of 1 - L.
  int surprise_zeros() const;

  /// T_L by poles and zeros, those at z = 0 apart, and as a fraction.
  GainFactor factor() const;
  ExactTransfer transfer() const;

  /// The coefficients that limit the digits of T_L: z^n / F by powers of z - 1; 1 for a chain.
  const CirclePolynomial& registers() const { return near_.registers; }

private:
  struct Half {
    CirclePolynomial registers, surprise;
  };

  LossModel loss_;
  double feedback_;
  Half near_, far_;  ///< z^n / F and z^n (1 - L) about one centre
  std::shared_ptr<const LossKernel> kernel_;
};

}  // namespace platoon
