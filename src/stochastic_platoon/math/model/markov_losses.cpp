#include "stochastic_platoon/math/model/markov_losses.hpp"

#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/math/numerics/eigenvalues.hpp"
#include "stochastic_platoon/math/numerics/selected.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

using States = std::vector<Eigen::Index>;

/// The states that are reached from a state, itself included.
std::vector<bool> reached(const Eigen::MatrixXd& transition, Eigen::Index from) {
  std::vector<bool> found(static_cast<std::size_t>(transition.rows()), false);
  States open{from};
  found[static_cast<std::size_t>(from)] = true;
  while (!open.empty()) {
    const Eigen::Index state = open.back();
    open.pop_back();
    for (Eigen::Index next = 0; next < transition.cols(); ++next) {
      if (!(transition(state, next) > 0.0) || found[static_cast<std::size_t>(next)]) continue;
      found[static_cast<std::size_t>(next)] = true;
      open.push_back(next);
    }
  }
  return found;
}

/// The states that the chain returns to for ever. Throws std::invalid_argument if there are several sets of them.
States recurrent(const Eigen::MatrixXd& transition) {
  States found;
  for (Eigen::Index state = 0; state < transition.rows(); ++state) {
    const std::vector<bool> ahead = reached(transition, state);
    bool returns = true;
    for (Eigen::Index other = 0; other < transition.rows(); ++other)
      returns = returns && (!ahead[static_cast<std::size_t>(other)] ||
                            reached(transition, other)[static_cast<std::size_t>(state)]);
    if (!returns) continue;
    if (!found.empty() && !ahead[static_cast<std::size_t>(found.front())])
      throw std::invalid_argument(formatted("transition: a chain that never changes between states %d and %d: must mix",
                                            static_cast<int>(found.front()), static_cast<int>(state)));
    found.push_back(state);
  }
  return found;
}

/// By elimination of one state after the other, without subtractions (W. Grassmann, M. Taksar, D. Heyman, Oper. Res.
/// 33, 1985).
Eigen::VectorXd stationary_of(Eigen::MatrixXd p) {
  const Eigen::Index n = p.rows();
  for (Eigen::Index k = n - 1; k > 0; --k) {
    p.col(k).head(k) /= p.row(k).head(k).sum();
    for (Eigen::Index i = 0; i < k; ++i) p.row(i).head(k) += p(i, k) * p.row(k).head(k);
  }
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(n);
  weights(0) = 1.0;
  for (Eigen::Index k = 1; k < n; ++k) weights(k) = weights.head(k).dot(p.col(k).head(k));
  return weights / weights.sum();
}

void check(const Eigen::MatrixXd& transition, const Eigen::VectorXd& probability) {
  const Eigen::Index n = transition.rows();
  if (n < 1 || n > MarkovLosses::kMostStates || transition.cols() != n)
    throw std::invalid_argument(formatted("transition: %d x %d: must be square, of 1 to %d states", static_cast<int>(n),
                                          static_cast<int>(transition.cols()),
                                          static_cast<int>(MarkovLosses::kMostStates)));
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      if (!(transition(i, j) >= 0.0))
        throw std::invalid_argument(
            formatted("transition[%d]: %g: must be at least 0", static_cast<int>(i), transition(i, j)));
    }
    const double sum = transition.row(i).sum();
    if (!(std::abs(sum - 1.0) <= 1e-9))
      throw std::invalid_argument(formatted("transition[%d]: a sum of %.10g: must be 1", static_cast<int>(i), sum));
  }
  if (probability.size() != n)
    throw std::invalid_argument(formatted("probability: %d numbers: must be one for each of the %d states",
                                          static_cast<int>(probability.size()), static_cast<int>(n)));
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(probability(i) >= 0.0 && probability(i) <= 1.0))
      throw std::invalid_argument(formatted("probability: %g: must be from 0 to 1", probability(i)));
  }
}

/// Throws std::invalid_argument if the chain of these states returns only at multiples of a period, or mixes too
/// slowly for the theory.
void require_mixing(const Eigen::MatrixXd& transition) {
  for (const std::complex<double>& value : eigenvalues_beside_one(transition)) {
    if (std::abs(value) < 1.0 - 1e-7) continue;
    throw std::invalid_argument(
        value.real() > 0.5
            ? formatted("transition: a chain that leaves a set of states once in %.2g steps: must mix faster",
                        1.0 / std::abs(1.0 - value))
            : formatted("transition: a chain that returns to its states every %.3g steps: must have no period",
                        2.0 * boost::math::double_constants::pi / std::abs(std::arg(value))));
  }
}

}  // namespace

MarkovLosses::MarkovLosses(const Eigen::MatrixXd& transition, const Eigen::VectorXd& probability)
    : given_(transition),
      transition_(transition),
      probability_(probability),
      stationary_(Eigen::VectorXd::Zero(transition.rows())) {
  check(transition, probability);
  for (Eigen::Index i = 0; i < transition_.rows(); ++i) transition_.row(i) /= transition_.row(i).sum();
  const States states = recurrent(transition_);
  const Eigen::MatrixXd among = selected(transition_, states);
  require_mixing(among);
  const Eigen::VectorXd shares = stationary_of(among);
  for (std::size_t i = 0; i < states.size(); ++i) stationary_(states[i]) = shares(static_cast<Eigen::Index>(i));
  if (!((stationary_.array() > 0.0) && (probability_.array() < 1.0)).any())
    throw std::invalid_argument("probability: 1 in every state that occurs: must be below 1 in one of them");
}

double MarkovLosses::loss_probability() const {
  return stationary_.dot(probability_);
}

double MarkovLosses::mean_burst() const {
  const Eigen::VectorXd arrived = stationary_.array() * (1.0 - probability_.array());
  const double begins = arrived.dot(transition_ * probability_);  // a loss that follows an arrival
  return begins > 0.0 ? loss_probability() / begins : 1.0;
}

bool MarkovLosses::operator==(const MarkovLosses& other) const {
  return given_.rows() == other.given_.rows() && given_ == other.given_ && probability_ == other.probability_;
}

}  // namespace platoon
