#pragma once

#include <Eigen/Core>

namespace platoon {

struct LossModel;

/// A_c: the registers r(k-1), r(k-2), ... of a predictor one step later, after an arrival (without the arrived value)
/// or after a loss.
Eigen::MatrixXd register_map(const Eigen::VectorXd& predictor, bool lost);

/// The losses of a link as a stationary Markov chain: n modes, each marked arrived or lost, with transitions Pi and
/// stationary probabilities pi. Independent losses and bursts have two modes; losses by a chain of states s with loss
/// probabilities l_s (E. N. Gilbert, 1960; E. O. Elliott, 1963) have the modes (s, arrived) and (s, lost), where
/// Pi_{(s,a),(s',a')} is P_ss' times 1 - l_s' or l_s'. Arrived modes come first; modes that never occur are left out.
///
/// In mode c the registers x(k) = (r(k), ..., r(k-m+1)) of the prediction obey x(k) = A_c x(k-1) + B_c s(k): an arrival
/// shifts the sent s(k) in, a loss shifts the prediction in.
class LossChain {
public:
  /// Recorded losses and losses by the distance, which are no chain, count by their probability and mean burst.
  explicit LossChain(const LossModel& loss);

  Eigen::Index modes() const { return transition_.rows(); }
  Eigen::Index arrived() const { return arrived_; }  ///< number of arrived modes
  Eigen::Index lost() const { return modes() - arrived_; }
  Eigen::Index registers() const { return predictor_.size(); }  ///< m

  const Eigen::MatrixXd& transition() const { return transition_; }  ///< Pi, from row to column
  const Eigen::VectorXd& stationary() const { return stationary_; }  ///< pi
  const Eigen::VectorXd& predictor() const { return predictor_; }    ///< c_1, ..., c_m; a single 0 for on_loss: zero

  /// Coordinates V x of the registers: row i takes the difference of order min(i, 3) of values that end at lag i, so
  /// that the first entry is r(k). Predictions that continue a steady motion or acceleration grow like powers of the
  /// number of losses; with these coordinates nothing cancels while they grow.
  Eigen::MatrixXd differences() const;

  /// [Pi_ac V A_c V^{-1}]: the sums over V x of each mode, one step later.
  Eigen::MatrixXd first_moments() const;

  /// [Pi_ac (V A_c V^{-1}) (x) (V A_c V^{-1})]: the sums over V x x' V' of each mode, one step later.
  Eigen::MatrixXd second_moments() const;

  /// [Pi_ac M_c] of a matrix M_c for arrived modes and one for lost ones.
  Eigen::MatrixXd moments(const Eigen::MatrixXd& after_arrival, const Eigen::MatrixXd& after_loss) const;

  /// The largest modulus of an eigenvalue of Pi other than 1.
  double memory() const;

private:
  Eigen::MatrixXd in_differences(bool lost) const;  ///< V A_c V^{-1} after an arrival or a loss

  Eigen::Index arrived_ = 1;
  Eigen::MatrixXd transition_;
  Eigen::VectorXd stationary_, predictor_;
};

}  // namespace platoon
