#pragma once

#include <Eigen/Dense>
#include <complex>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/response/attenuation.hpp"

namespace platoon {

struct ExactTransfer;

/// Losses of one link by a Markov chain (LossChain), as a filter on the unit circle. The chain is independent of the
/// sent values s.
///
/// Relative to s, a sent e^{j nu k} drives the registers x of the prediction at losses alone, by -u, u = 1 - L(e^{j
/// nu}). Per unit of this drive, with e = (1, 0, ..., 0)', 1_c = 1 for a lost mode c and 0 for an arrived one,
///
///     d_c = e^{-j nu} A_c sum_a Pi_ac d_a + pi_c 1_c e,
///     Q_c = A_c sum_a Pi_ac Q_a A_c' + 1_c (b_c e' + e b_c* + pi_c e e'),   b_c = e^{-j nu} A_c sum_a Pi_ac d_a,
///     d_c = E[x 1{theta = c}],   Q_c = E[x x* 1{theta = c}],
///
/// the link passes T_L = 1 - u D on average, D = e' sum_c d_c, and scatters a sent spectrum Phi into
/// < g(w, nu) |u(nu)|^2 Phi(nu) >_nu, uncorrelated with the sent signal, with
///
///     g(w, nu) = 2 Re[ l(w) V(nu) + sum_m a_m(w) b_m(nu) y_m / (1 - y_m) ] - e' sum_c V_c,
///     V_c = Q_c e - d_c conj(D),   l(w) = [e' ... e'] (I - e^{-jw} [Pi_ac A_c])^{-1},
///     I_c = conj(e' d_c) - pi_c conj(D),   y_m = lambda_m e^{j (nu - w)},
///     a_m = sum_c 1_c l_c e v_mc,   b_m = u_m' I,
///
/// for the eigenvalues lambda_m of Pi' other than 1, with right and left eigenvectors v_m and u_m, u_m' v_m = 1: the
/// memory of the chain. A platoon that moves v metres per step drives the registers by -v (c_1 + 2 c_2 + ...) at every
/// loss, which acts like a drive at frequency 0.
class LossKernel {
public:
  /// Without predictor, u = 1: a lost value is 0. Throws std::invalid_argument for a loss probability of 0, losses that
  /// alternate with arrivals (lambda = -1), and predictions whose variance does not settle.
  explicit LossKernel(const LossModel& loss);

  struct Value {
    std::complex<double> surprise;   ///< u
    std::complex<double> deviation;  ///< D
    Eigen::VectorXcd outward;        ///< l, m entries for each mode
    Eigen::VectorXcd scattered;      ///< V, the same; e' V_c = 0 for arrived modes
    Eigen::VectorXcd recalling;      ///< a, one entry per memory
    Eigen::VectorXcd remembered;     ///< b at nu
    Eigen::VectorXcd mirrored;       ///< b at -nu

    /// 1 - T_L, without cancellation.
    std::complex<double> missing() const { return surprise * deviation; }
  };
  Value at(double frequency) const;

  /// g of the values at w and nu.
  double kernel(const Value& outward, double w, const Value& inward, double nu) const;

  /// Row with e' sum_c V_c = itself() V.
  const Eigen::RowVectorXd& itself() const { return itself_; }

  const std::vector<std::complex<double>>& memories() const { return memories_; }  ///< lambda_m

  /// Poles and zeros of T_L, and T_L in a hundred digits.
  const GainFactor& factor() const { return factor_; }
  const ExactTransfer& transfer() const { return *transfer_; }

private:
  ExactTransfer mean_transfer() const;
  void find_memories();
  Eigen::Index block(Eigen::Index mode) const { return mode * chain_.registers(); }

  LossChain chain_;
  bool forgets_ = false;  ///< a lost value is 0
  // In the coordinates LossChain::differences(), where e' stays the output of r:
  Eigen::MatrixXd transition_;  ///< [Pi_ac A_c]
  Eigen::VectorXd entry_;       ///< e as the input of the drives
  Eigen::MatrixXd even_, odd_;  ///< from b to Q e for the drives b e' + e b' and b e' - e b', of all lost modes
  Eigen::VectorXd own_;         ///< Q e for the drives pi_c e e'
  Eigen::RowVectorXd itself_;
  std::vector<std::complex<double>> memories_;
  Eigen::MatrixXcd right_, left_;  ///< v_m in columns, u_m' in rows
  std::shared_ptr<const ExactTransfer> transfer_;
  GainFactor factor_;
};

}  // namespace platoon
