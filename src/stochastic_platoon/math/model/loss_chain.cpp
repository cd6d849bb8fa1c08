#include "stochastic_platoon/math/model/loss_chain.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/KroneckerProduct>

#include "stochastic_platoon/math/numerics/eigenvalues.hpp"

namespace platoon {

namespace {

constexpr double kNoMemory = 1e-14;

/// Rows and columns of the modes that occur.
struct Occurring {
  std::vector<Eigen::Index> modes;

  Eigen::MatrixXd of(const Eigen::MatrixXd& matrix) const {
    const auto count = static_cast<Eigen::Index>(modes.size());
    Eigen::MatrixXd result(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j < count; ++j)
        result(i, j) = matrix(modes[static_cast<std::size_t>(i)], modes[static_cast<std::size_t>(j)]);
    }
    return result;
  }
  Eigen::VectorXd of(const Eigen::VectorXd& vector) const {
    Eigen::VectorXd result(static_cast<Eigen::Index>(modes.size()));
    for (std::size_t i = 0; i < modes.size(); ++i) result(static_cast<Eigen::Index>(i)) = vector(modes[i]);
    return result;
  }
};

}  // namespace

LossChain::LossChain(const LossModel& loss)
    : predictor_(
          Eigen::Map<const Eigen::VectorXd>(loss.predictor.data(), static_cast<Eigen::Index>(loss.predictor.size()))) {
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
  Occurring occurring;
  arrived_ = 0;
  for (Eigen::Index mode = 0; mode < 2 * states; ++mode) {
    if (!(probabilities(mode) > 0.0)) continue;
    occurring.modes.push_back(mode);
    if (mode < states) ++arrived_;
  }
  transition_ = occurring.of(all);
  stationary_ = occurring.of(probabilities);
}

Eigen::MatrixXd LossChain::map(bool lost) const {
  const Eigen::Index m = registers();
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(m, m);
  map.diagonal(-1).setOnes();
  if (lost) map.row(0) = predictor_.transpose();
  return map;
}

Eigen::MatrixXd LossChain::first_moments() const {
  const Eigen::Index m = registers();
  const Eigen::MatrixXd maps[] = {map(false), map(true)};
  Eigen::MatrixXd moments(modes() * m, modes() * m);
  for (Eigen::Index to = 0; to < modes(); ++to) {
    for (Eigen::Index from = 0; from < modes(); ++from)
      moments.block(to * m, from * m, m, m) = transition_(from, to) * maps[to < arrived_ ? 0 : 1];
  }
  return moments;
}

Eigen::MatrixXd LossChain::second_moments() const {
  const Eigen::Index squares = registers() * registers();
  const Eigen::MatrixXd maps[] = {Eigen::kroneckerProduct(map(false), map(false)).eval(),
                                  Eigen::kroneckerProduct(map(true), map(true)).eval()};
  Eigen::MatrixXd moments(modes() * squares, modes() * squares);
  for (Eigen::Index to = 0; to < modes(); ++to) {
    for (Eigen::Index from = 0; from < modes(); ++from)
      moments.block(to * squares, from * squares, squares, squares) =
          transition_(from, to) * maps[to < arrived_ ? 0 : 1];
  }
  return moments;
}

std::vector<std::complex<double>> LossChain::memories() const {
  const Eigen::VectorXcd values = eigenvalues(transition_);
  Eigen::Index one = 0;
  (values.array() - 1.0).abs().minCoeff(&one);
  std::vector<std::complex<double>> found;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (i != one && std::abs(values(i)) > kNoMemory) found.push_back(values(i));
  }
  return found;
}

double LossChain::memory() const {
  double largest = 0.0;
  for (const std::complex<double>& value : memories()) largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace platoon
