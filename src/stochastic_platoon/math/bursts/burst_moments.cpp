#include "stochastic_platoon/math/bursts/burst_moments.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/links/linked_responses.hpp"
#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// Moments of a sequence from step -1 on: its means, and the covariance of every two steps.
struct SequenceMoments {
  Vector mean;
  Matrix covariance;
};

/// Moments of the positions that a vehicle uses, and their covariance at step k (row) with the predecessor's at step l
/// >= k.
struct Received {
  SequenceMoments own;
  Matrix with_sent;
};

/// The recursion over the steps of one link with losses. A state has n entries for each mode of the chain.
class LossRecursion {
public:
  explicit LossRecursion(const LossModel& loss)
      : chain_(loss),
        n_(chain_.registers()),
        modes_(chain_.modes()),
        arrived_(chain_.arrived()),
        transition_(chain_.transition().cast<long double>()),
        stationary_(chain_.stationary().cast<long double>()),
        predictor_(chain_.predictor().cast<long double>()),
        before_(static_cast<std::size_t>(modes_ * n_)) {}

  /// From the moments of the arriving positions, and their covariance with the sent ones.
  Received operator()(const SequenceMoments& arriving, const Matrix& with_sent) const {
    const Eigen::Index count = arriving.mean.size();
    const Vector innovation = innovations(arriving.mean);
    const std::vector<Matrix> later_modes = powers(count);
    Matrix mean = Matrix::Zero(modes_ * n_, 1);
    Vector received_mean = Vector::Zero(count);
    Matrix cross = started(arriving.covariance.row(0)), sent = started(with_sent.row(0));
    std::vector<Matrix> squares;
    for (Eigen::Index c = 0; c < modes_; ++c)
      squares.push_back(Matrix::Constant(n_, n_, stationary_(c) * arriving.covariance(0, 0)));
    Received received{{arriving.mean, Matrix(count, count)}, Matrix::Zero(count, count)};
    for (Eigen::Index k = 0; k < count; ++k) {
      check_interruption();
      if (k > 0) {
        advance(cross, k);
        advance(sent, k);
        advance(mean, 0);
        advance_squares(squares);
        for (Eigen::Index c = 0; c < modes_; ++c) {
          Matrix& square = squares[static_cast<std::size_t>(c)];
          const Eigen::Index first = c * n_;
          if (c < arrived_) {
            add_driven(cross.col(k).segment(first, n_), stationary_(c) * arriving.covariance(k, k), square);
            cross.row(first) += stationary_(c) * arriving.covariance.row(k);
            sent.row(first) += stationary_(c) * with_sent.row(k);
          } else {
            add_driven(-innovation(k) * mean.col(0).segment(first, n_), stationary_(c) * innovation(k) * innovation(k),
                       square);
            mean(first) -= stationary_(c) * innovation(k);
          }
        }
      }
      received_mean(k) = received_of(mean.col(0));
      for (Eigen::Index l = k; l < count; ++l) received.with_sent(k, l) = received_of(sent.col(l));
      Matrix later(modes_ * n_, 1);
      for (Eigen::Index c = 0; c < modes_; ++c)
        later.middleRows(c * n_, n_) = squares[static_cast<std::size_t>(c)].col(0);
      add_later(k, later, mean, cross, innovation, later_modes, received.own.covariance);
    }
    received.own.covariance -= (received_mean * received_mean.transpose()).eval();
    received.own.mean += received_mean;
    return received;
  }

private:
  // u(k); positions before step -1 are that of step -1.
  Vector innovations(const Vector& mean) const {
    Vector innovation = mean;
    for (Eigen::Index k = 0; k < mean.size(); ++k) {
      for (Eigen::Index j = 0; j < n_; ++j) innovation(k) -= predictor_(j) * mean(std::max<Eigen::Index>(k - 1 - j, 0));
    }
    return innovation;
  }

  // The powers of Pi, column by column: the modes l steps later.
  std::vector<Matrix> powers(Eigen::Index count) const {
    std::vector<Matrix> result{Matrix::Identity(modes_, modes_)};
    while (static_cast<Eigen::Index>(result.size()) < count) result.emplace_back(result.back() * transition_);
    return result;
  }

  // At step -1 all registers hold the position of step -1, in any mode.
  Matrix started(const Matrix& covariance) const {
    Matrix state(modes_ * n_, covariance.cols());
    for (Eigen::Index c = 0; c < modes_; ++c)
      state.middleRows(c * n_, n_) = covariance.replicate(n_, 1) * stationary_(c);
    return state;
  }

  // The sum over the modes of the latest register.
  template <class State>
  long double received_of(const State& state) const {
    long double sum = 0.0L;
    for (Eigen::Index c = 0; c < modes_; ++c) sum += state(c * n_);
    return sum;
  }

  // The states in columns `from` and later, one step of the chain later: A_c sum_a Pi_ac state_a.
  void advance(Matrix& states, Eigen::Index from) const {
    for (Eigen::Index column = from; column < states.cols(); ++column) {
      std::copy_n(states.col(column).data(), before_.size(), before_.begin());
      for (Eigen::Index c = 0; c < modes_; ++c) {
        long double* const state = states.col(column).data() + c * n_;
        long double predicted = 0.0L;
        for (Eigen::Index j = n_ - 1; j >= 0; --j) {
          long double moved = 0.0L;
          for (Eigen::Index a = 0; a < modes_; ++a)
            moved += transition_(a, c) * before_[static_cast<std::size_t>(a * n_ + j)];
          predicted += predictor_(j) * moved;
          if (j + 1 < n_) state[j + 1] = moved;
        }
        state[0] = c < arrived_ ? 0.0L : predicted;
      }
    }
  }

  // A_c sum_a Pi_ac Q_a A_c' for all modes.
  void advance_squares(std::vector<Matrix>& squares) const {
    const std::vector<Matrix> before = squares;
    const Eigen::Index kept = n_ - 1;
    for (Eigen::Index c = 0; c < modes_; ++c) {
      Matrix moved = Matrix::Zero(n_, n_), &square = squares[static_cast<std::size_t>(c)];
      for (Eigen::Index a = 0; a < modes_; ++a)
        moved.noalias() += transition_(a, c) * before[static_cast<std::size_t>(a)];
      square.setZero();
      square.bottomRightCorner(kept, kept) = moved.topLeftCorner(kept, kept);
      if (c < arrived_) continue;
      const Vector predicted = moved * predictor_;
      square.col(0).tail(kept) = predicted.head(kept);
      square.row(0).tail(kept) = predicted.head(kept).transpose();
      square(0, 0) = predictor_.dot(predicted);
    }
  }

  void add_driven(const Vector& drive, long double squared, Matrix& square) const {
    square.col(0) += drive;
    square.row(0) += drive.transpose();
    square(0, 0) += squared;
  }

  // Row and column k of E r~(l) r~(k), l >= k. `state`: the Y of step k.
  void add_later(Eigen::Index k, Matrix state, const Matrix& mean, const Matrix& cross, const Vector& innovation,
                 const std::vector<Matrix>& later_modes, Matrix& second) const {
    second(k, k) = received_of(state.col(0));
    for (Eigen::Index l = k + 1; l < second.rows(); ++l) {
      check_interruption();
      advance(state, 0);
      const Matrix& modes = later_modes[static_cast<std::size_t>(l - k)];
      for (Eigen::Index c = 0; c < modes_; ++c) {
        long double expected = 0.0L;  // E[s~(l) or 1, mode c at l, r~(k)]
        for (Eigen::Index a = 0; a < modes_; ++a)
          expected += modes(a, c) * (c < arrived_ ? cross(a * n_, l) : mean(a * n_, 0));
        state(c * n_) += c < arrived_ ? expected : -innovation(l) * expected;
      }
      second(l, k) = received_of(state.col(0));
      second(k, l) = second(l, k);
    }
  }

  LossChain chain_;
  Eigen::Index n_, modes_, arrived_;
  Matrix transition_;
  Vector stationary_, predictor_;
  mutable std::vector<long double> before_;  ///< a state, while advance() changes it
};

/// One follower and its link.
class BurstFollower {
public:
  BurstFollower(const VehicleModel& vehicle, std::size_t steps)
      : model_(vehicle),
        count_(static_cast<Eigen::Index>(steps) + 1),
        vehicle_(vehicle),
        free_(filled(vehicle_.free_motion(steps + 1).position)),
        noise_(Matrix::Zero(count_, count_)) {
    const Vector colour = filled(filtered_impulse(vehicle.link.noise_filter, steps));
    const long double variance = vehicle.noise_variance, step = vehicle.link.quantisation_step;
    for (Eigen::Index a = 1; a < count_; ++a) {
      check_interruption();
      for (Eigen::Index b = 1; b <= a; ++b) {
        noise_(a, b) = noise_(a - 1, b - 1) + variance * colour(a) * colour(b);
        noise_(b, a) = noise_(a, b);
      }
    }
    for (Eigen::Index a = 1; a < count_; ++a) noise_(a, a) += step * step / 12.0L;
  }

  /// The positions that the vehicle uses, given those sent.
  Received receives(const SequenceMoments& sent) const {
    SequenceMoments arriving{Vector(count_), Matrix(count_, count_)};
    Matrix with_sent(count_, count_);
    for (Eigen::Index a = 0; a < count_; ++a) {
      check_interruption();
      arriving.mean(a) = sent.mean(before(a));
      with_sent.row(a) = sent.covariance.row(before(a));
      for (Eigen::Index b = 0; b < count_; ++b)
        arriving.covariance(a, b) = sent.covariance(before(a), before(b)) + noise_(before(a), before(b));
    }
    if (!model_.link.loses()) return {std::move(arriving), std::move(with_sent)};
    return LossRecursion(*model_.link.loss)(arriving, with_sent);
  }

  SequenceMoments drives(const SequenceMoments& used) const {
    const InitialPosition& initial = model_.initial_position;
    SequenceMoments own{passed(used.mean) + static_cast<long double>(initial.mean) * free_,
                        passed(passed(used.covariance).transpose())};
    own.covariance += static_cast<long double>(initial.variance) * (free_ * free_.transpose());
    return own;
  }

  /// Appends mean and variance of every tracking error.
  void add_errors(const SequenceMoments& predecessor, const SequenceMoments& own, const Matrix& used_with_sent,
                  ErrorMoments& moments) const {
    const Matrix shared = passed(used_with_sent);  // own step (row) with the predecessor's
    const long double h = model_.headway, g = 1.0L + h;
    for (Eigen::Index a = 1; a < count_; ++a) {
      moments.mean.push_back(
          static_cast<double>(predecessor.mean(a) - own.mean(a) - h * (own.mean(a) - own.mean(a - 1))));
      const long double variance = predecessor.covariance(a, a) + g * g * own.covariance(a, a) +
                                   h * h * own.covariance(a - 1, a - 1) - 2.0L * g * h * own.covariance(a, a - 1) -
                                   2.0L * g * shared(a, a) + 2.0L * h * shared(a - 1, a);
      moments.variance.push_back(static_cast<double>(std::max(variance, 0.0L)));
    }
  }

private:
  Eigen::Index before(Eigen::Index a) const { return std::max<Eigen::Index>(a - model_.link.delay, 0); }

  static Vector filled(const MeanVehicle::Sequence& values) {
    return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
  }

  // The closed loop's response to every column.
  Matrix passed(const Matrix& columns) const {
    Matrix result(columns.rows(), columns.cols());
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      const Vector column = columns.col(c);
      result.col(c) =
          filled(vehicle_({MeanVehicle::Sequence(column.data(), column.data() + column.size()), {}}).position);
    }
    return result;
  }

  VehicleModel model_;
  Eigen::Index count_;
  VehicleResponse vehicle_;
  Vector free_;
  Matrix noise_;  ///< covariance of the noise of the link
};

}  // namespace

ErrorMoments burst_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  if (has_feed_forward(model))
    throw std::invalid_argument("inputs: a radio: must be absent for the theory of losses in bursts");
  const auto count = static_cast<std::size_t>(steps);
  std::vector<BurstFollower> vehicles;
  for (const VehicleModel& vehicle : pattern(model)) {
    unit_equilibrium(vehicle.loop.realization);
    if (vehicles.size() == followers) break;
    vehicles.emplace_back(vehicle, count);
  }
  const MeanVehicle::Sequence leader = leader_motion(model, count).position;
  const auto size = static_cast<Eigen::Index>(leader.size());
  SequenceMoments predecessor{Eigen::Map<const Vector>(leader.data(), size), Matrix::Zero(size, size)};
  ErrorMoments moments{steps, followers, {}, {}};
  for (std::size_t i = 0; i < followers; ++i) {
    const BurstFollower& vehicle = vehicles[i % vehicles.size()];
    Received received = vehicle.receives(predecessor);
    SequenceMoments own = vehicle.drives(received.own);
    vehicle.add_errors(predecessor, own, received.with_sent, moments);
    predecessor = std::move(own);
  }
  return moments;
}

bool has_feasible_burst_moments(std::size_t followers, std::int64_t steps) {
  const auto count = static_cast<double>(steps);
  return count <= kMostBurstSteps && static_cast<double>(followers) * count * count <= kMostBurstCells;
}

}  // namespace platoon
