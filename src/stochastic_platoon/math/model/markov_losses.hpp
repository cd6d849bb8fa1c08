#pragma once

#include <Eigen/Core>

namespace platoon {

/// Losses that depend on the state of a Markov chain (E. N. Gilbert, Bell Syst. Tech. J. 39, 1960; E. O. Elliott, 42,
/// 1963): the link changes from state s to s' with probability P_ss', and loses a value in state s with probability
/// l_s. The chain is stationary.
class MarkovLosses {
public:
  static constexpr Eigen::Index kMostStates = 8;

  /// transition: P, n x n; probability: l_1, ..., l_n. Throws std::invalid_argument unless P is square with 1 to
  /// kMostStates rows of sum 1 (within 1e-9) and entries >= 0, every l_s is from 0 to 1, and values arrive in a state
  /// that occurs, and for a chain that does not mix: one with several sets of states that it never leaves, or one that
  /// returns only at multiples of a period.
  MarkovLosses(const Eigen::MatrixXd& transition, const Eigen::VectorXd& probability);

  const Eigen::MatrixXd& given() const { return given_; }              ///< P as given
  const Eigen::MatrixXd& transition() const { return transition_; }    ///< P with rows of sum 1 to rounding
  const Eigen::VectorXd& probability() const { return probability_; }  ///< l
  const Eigen::VectorXd& stationary() const { return stationary_; }    ///< share of the steps in each state

  double loss_probability() const;  ///< of any step
  double mean_burst() const;        ///< mean length of a run of losses [steps]; 1 if nothing is lost

  bool operator==(const MarkovLosses& other) const;

private:
  Eigen::MatrixXd given_, transition_;
  Eigen::VectorXd probability_, stationary_;
};

}  // namespace platoon
