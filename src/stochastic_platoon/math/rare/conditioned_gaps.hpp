#pragma once

#include <vector>

#include "stochastic_platoon/math/rare/gap_law.hpp"
#include "stochastic_platoon/math/rare/rare_event.hpp"
#include "stochastic_platoon/math/rare/weighted_choice.hpp"

namespace platoon {

/// Probabilities of small gaps behind links with normal errors, by conditioned realizations.
///
/// With p_k = P(g(k) < b) of a follower, a realization is given a step tau, chosen with probability p_tau / sum p, and
/// a value x from the law of g(tau) below b. Its noise is shifted such that g(tau) = x,
///
///     g(.) += C(., tau) / C(tau, tau) (x - g(tau)),   draw of link j at step l += f_j(tau - l) / C(tau, tau) (x -
///     g(tau)),
///
/// which gives the law of the realizations under this condition. With n steps below b, P = sum p E[1 / n], of relative
/// variance sum p / P - 1 or less per realization. For any follower, the pair (i, tau) is chosen and pairs are counted.
/// All probabilities are logarithms, so that they may be below the range of double.
///
/// References: R. Adler, J. Blanchet, J. Liu, Ann. Appl. Probab. 22, 2012; A. Owen, Y. Maximov, M. Chertkov, Electron.
/// J. Statist. 13, 2019 (arXiv 1710.06965).
class ConditionedGaps : public RareEstimator {
public:
  /// Throws std::invalid_argument as GapLaw does, and unless the bound is below the mean of every gap that counts and a
  /// gap is random; if followers times steps^2 are more than fit the memory.
  ConditionedGaps(const PlatoonModel& model, const RareEvent& event);

  /// ln sum p.
  std::vector<double> log_scales(std::size_t row) const override { return {choices_[row].log_sum()}; }

  /// The largest p; and collision_bounds() or sum p, whichever is smaller.
  std::pair<double, double> log_limits(std::size_t row) const override;

  BatchWork work() const override;

  std::shared_ptr<const ChangedDraws> replay(std::size_t row, std::optional<std::uint64_t> sample) const override;

  /// Realizations that a thread computes at once: their gaps fit the caches.
  std::uint64_t batch() const;

private:
  class Sampler;
  class Shifts;

  /// The condition that realization `sample` has in a row.
  struct Condition {
    std::size_t follower, step;
    double gap;  ///< x [m]
  };
  Condition condition(std::size_t row, const double* uniforms) const;
  /// The shift of the noise per metre of x - g(tau).
  double shift(const Condition& at, const DrawName& draw) const;

  PlatoonModel model_;
  RareEvent event_;
  GapLaw law_;
  std::vector<Eigen::MatrixXd> covariances_;
  std::vector<WeightedChoice> choices_;  ///< per follower, of the steps; at last of the followers
  std::vector<double> bounds_;           ///< per follower, see collision_bounds()
};

}  // namespace platoon
