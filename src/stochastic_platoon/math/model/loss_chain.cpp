#include "stochastic_platoon/math/model/loss_chain.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/KroneckerProduct>
#include <vector>

#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/numerics/eigenvalues.hpp"
#include "stochastic_platoon/math/numerics/selected.hpp"

namespace platoon {

Eigen::MatrixXd register_map(const Eigen::VectorXd& predictor, bool lost) {
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(predictor.size(), predictor.size());
  map.diagonal(-1).setOnes();
  if (lost) map.row(0) = predictor.transpose();
  return map;
}

LossChain::LossChain(const LossModel& loss)
    : predictor_(
          Eigen::Map<const Eigen::VectorXd>(loss.predictor.data(), static_cast<Eigen::Index>(loss.predictor.size()))) {
  if (loss.predictor.empty()) predictor_ = Eigen::VectorXd::Zero(1);
  if (!loss.markov) {
    const double to_loss = loss.after_arrival(), stays_lost = loss.after_loss();
    transition_.resize(2, 2);
    transition_ << 1.0 - to_loss, to_loss, 1.0 - stays_lost, stays_lost;
    stationary_ = Eigen::Vector2d(1.0 - loss.probability, loss.probability);
    return;
  }
  const MarkovLosses& given = *loss.markov;
  const Eigen::Index states = given.probability().size();
  const Eigen::VectorXd in_state = given.stationary();
  Eigen::MatrixXd all(2 * states, 2 * states);
  Eigen::VectorXd probabilities(2 * states);
  for (Eigen::Index to = 0; to < states; ++to) {
    for (Eigen::Index from = 0; from < states; ++from) {
      const double arrives = given.transition()(from, to) * (1.0 - given.probability()(to)),
                   loses = given.transition()(from, to) * given.probability()(to);
      for (const Eigen::Index row : {from, states + from}) {
        all(row, to) = arrives;
        all(row, states + to) = loses;
      }
    }
    probabilities(to) = in_state(to) * (1.0 - given.probability()(to));
    probabilities(states + to) = in_state(to) * given.probability()(to);
  }
  std::vector<Eigen::Index> occurring;
  arrived_ = 0;
  for (Eigen::Index mode = 0; mode < 2 * states; ++mode) {
    if (!(probabilities(mode) > 0.0)) continue;
    occurring.push_back(mode);
    if (mode < states) ++arrived_;
  }
  transition_ = selected(all, occurring);
  stationary_ = selected(probabilities, occurring);
}

Eigen::MatrixXd LossChain::moments(const Eigen::MatrixXd& after_arrival, const Eigen::MatrixXd& after_loss) const {
  const Eigen::Index m = after_loss.rows();
  Eigen::MatrixXd result(modes() * m, modes() * m);
  for (Eigen::Index to = 0; to < modes(); ++to) {
    for (Eigen::Index from = 0; from < modes(); ++from)
      result.block(to * m, from * m, m, m) = transition_(from, to) * (to < arrived_ ? after_arrival : after_loss);
  }
  return result;
}

Eigen::MatrixXd LossChain::differences() const {
  constexpr Eigen::Index kHighestDifference = 3;  // beyond, the inverse has large entries
  Eigen::MatrixXd result = Eigen::MatrixXd::Identity(registers(), registers());
  for (Eigen::Index order = 1; order <= kHighestDifference; ++order) {
    for (Eigen::Index i = registers() - 1; i >= order; --i) result.row(i) = (result.row(i - 1) - result.row(i)).eval();
  }
  return result;
}

Eigen::MatrixXd LossChain::in_differences(bool lost) const {
  const Eigen::MatrixXd coordinates = differences();
  return coordinates * register_map(predictor_, lost) *
         coordinates.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(registers(), registers()));
}

Eigen::MatrixXd LossChain::first_moments() const {
  return moments(in_differences(false), in_differences(true));
}

Eigen::MatrixXd LossChain::second_moments() const {
  const Eigen::MatrixXd arrived = in_differences(false), lost = in_differences(true);
  return moments(Eigen::kroneckerProduct(arrived, arrived).eval(), Eigen::kroneckerProduct(lost, lost).eval());
}

double LossChain::memory() const {
  double largest = 0.0;
  for (const std::complex<double>& value : eigenvalues_beside_one(transition_))
    largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace platoon
