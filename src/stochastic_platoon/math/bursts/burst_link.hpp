#pragma once

#include <Eigen/Dense>
#include <complex>

#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/response/attenuation.hpp"

namespace platoon {

/// Losses of one link in bursts, as a filter on the unit circle.
///
/// theta(k) is a two-state Markov chain (0 arrived, 1 lost) with transitions Pi and stationary pi = (p, q), independent
/// of the sent values. With n the length of the predictor, x(k) = (r(k), ..., r(k-n+1)) obeys x(k) = A_theta x(k-1) +
/// B_theta s(k): an arrival shifts s(k) in, a loss shifts the prediction c' x(k-1) in. Relative to s, a sent e^{j nu k}
/// drives the registers at losses alone, by -u, u = 1 - L(e^{j nu}). Per unit of this drive,
///
///     d_c = sum_a Pi_ac e^{-j nu} A_c d_a + pi_c 1{c = 1} e,
///     Q_c = A_c sum_a Pi_ac Q_a A_c' + 1{c = 1} (e^{-j nu} A_1 m e' + its adjoint + q e e'),
///     d_a = E[x 1{theta = a}],   Q_a = E[x x* 1{theta = a}],
///
/// with e = (1, 0, ..., 0)' and m = sum_a Pi_a1 d_a. The link passes T_L = 1 - u D on average, D = e' (d_0 + d_1), and
/// scatters a sent spectrum Phi into < g(w, nu) |u(nu)|^2 Phi(nu) >_nu, uncorrelated with the sent signal, with
///
///     g(w, nu) = 2 Re[ l(w) V(nu) + (p/q) D(w) conj(D(nu)) y / (1 - y) ] - e' (V_0 + V_1),
///     V_a = Q_a e - d_a conj(D),   l(w) = [e' e'] (I - e^{-jw} [Pi_ac A_c])^{-1},
///     y = lambda e^{j (nu - w)},   lambda = Pi_11 - Pi_01.
///
/// Independent losses have lambda = 0. A platoon that moves v metres per step drives the registers by -v (c_1 + 2 c_2 +
/// ...) at every loss, which acts like a drive at frequency 0.
class BurstLink {
public:
  /// Throws std::invalid_argument for a loss without predictor, a loss probability of 0, losses that alternate
  /// with arrivals (lambda = -1), and predictions whose variance does not settle.
  explicit BurstLink(const LossModel& loss);

  struct Value {
    std::complex<double> surprise;   ///< u
    std::complex<double> deviation;  ///< D
    Eigen::VectorXcd outward;        ///< l, 2 n entries
    Eigen::VectorXcd scattered;      ///< V, 2 n entries; e' V_0 = 0

    /// T_L, and 1 - |T_L|^2 without cancellation.
    std::complex<double> passed() const { return 1.0 - surprise * deviation; }
    double margin() const { return 2.0 * (surprise * deviation).real() - std::norm(surprise * deviation); }
  };
  Value at(double frequency) const;

  /// g of the values at w and nu.
  double kernel(const Value& outward, double w, const Value& inward, double nu) const;

  Eigen::Index registers() const { return n_; }
  double memory() const { return memory_; }         ///< lambda
  double odds() const { return arrival_ / loss_; }  ///< p / q

  /// c_1 + 2 c_2 + ...
  double slope() const { return slope_; }

  /// Mean lag of a signal that grows steadily [steps].
  double lag() const { return slope_ * at(0.0).deviation.real(); }

  /// Poles and zeros of T_L.
  const GainFactor& factor() const { return factor_; }

private:
  double arrival_, loss_, memory_, slope_ = 0.0;
  Eigen::Index n_;
  Eigen::VectorXd predictor_;
  Eigen::MatrixXd transition_;  ///< [Pi_ac A_c], 2n x 2n
  Eigen::MatrixXd even_, odd_;  ///< from b to Q_1 e for the drives b e' + e b' and b e' - e b', n x n each
  Eigen::VectorXd own_;         ///< Q_1 e for the drive e e'
  GainFactor factor_;
};

}  // namespace platoon
