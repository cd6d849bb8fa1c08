#include "stochastic_platoon/math/links/loss_recursion.hpp"

#include <algorithm>
#include <cstddef>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

void add_driven(const ExtendedVector& drive, long double squared, ExtendedMatrix& square) {
  square.col(0) += drive;
  square.row(0) += drive.transpose();
  square(0, 0) += squared;
}

}  // namespace

LossRecursion::LossRecursion(const LossModel& loss) {
  const LossChain chain(loss);
  n_ = chain.registers();
  modes_ = chain.modes();
  arrived_ = chain.arrived();
  transition_ = chain.transition().cast<long double>();
  stationary_ = chain.stationary().cast<long double>();
  predictor_ = chain.predictor().cast<long double>();
  before_.resize(static_cast<std::size_t>(modes_ * n_));
}

SequenceMoments LossRecursion::operator()(const SequenceMoments& arriving) const {
  const Eigen::Index count = arriving.mean.size();
  const Vector innovation = innovations(arriving.mean);
  const std::vector<Matrix> later_modes = powers(count);
  Matrix mean = Matrix::Zero(modes_ * n_, 1);
  Vector received_mean = Vector::Zero(count);
  Matrix cross = started(arriving.covariance.row(0));
  std::vector<Matrix> squares;
  for (Eigen::Index c = 0; c < modes_; ++c)
    squares.push_back(Matrix::Constant(n_, n_, stationary_(c) * arriving.covariance(0, 0)));
  SequenceMoments received{arriving.mean, Matrix(count, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    check_interruption();
    if (k > 0) {
      advance(cross, k);
      advance(mean, 0);
      advance_squares(squares);
      for (Eigen::Index c = 0; c < modes_; ++c) {
        Matrix& square = squares[static_cast<std::size_t>(c)];
        const Eigen::Index first = c * n_;
        if (c < arrived_) {
          add_driven(cross.col(k).segment(first, n_), stationary_(c) * arriving.covariance(k, k), square);
          cross.row(first) += stationary_(c) * arriving.covariance.row(k);
        } else {
          add_driven(-innovation(k) * mean.col(0).segment(first, n_), stationary_(c) * innovation(k) * innovation(k),
                     square);
          mean(first) -= stationary_(c) * innovation(k);
        }
      }
    }
    received_mean(k) = received_of(mean.col(0));
    Matrix later(modes_ * n_, 1);
    for (Eigen::Index c = 0; c < modes_; ++c)
      later.middleRows(c * n_, n_) = squares[static_cast<std::size_t>(c)].col(0);
    add_later(k, later, mean, cross, innovation, later_modes, received.covariance);
  }
  received.covariance -= (received_mean * received_mean.transpose()).eval();
  received.mean += received_mean;
  return received;
}

ExtendedMatrix LossRecursion::on_average(const Matrix& columns) const {
  Matrix state = started(columns.row(0)), passed(columns.rows(), columns.cols());
  for (Eigen::Index k = 0; k < columns.rows(); ++k) {
    check_interruption();
    if (k > 0) {
      advance(state, 0);
      for (Eigen::Index c = 0; c < arrived_; ++c) state.row(c * n_) += stationary_(c) * columns.row(k);
    }
    for (Eigen::Index column = 0; column < columns.cols(); ++column) passed(k, column) = received_of(state.col(column));
  }
  return passed;
}

// u(k); positions before step -1 are that of step -1.
ExtendedVector LossRecursion::innovations(const Vector& mean) const {
  Vector innovation = mean;
  for (Eigen::Index k = 0; k < mean.size(); ++k) {
    for (Eigen::Index j = 0; j < n_; ++j) innovation(k) -= predictor_(j) * mean(std::max<Eigen::Index>(k - 1 - j, 0));
  }
  return innovation;
}

// The powers of Pi, column by column: the modes l steps later.
std::vector<ExtendedMatrix> LossRecursion::powers(Eigen::Index count) const {
  std::vector<Matrix> result{Matrix::Identity(modes_, modes_)};
  while (static_cast<Eigen::Index>(result.size()) < count) result.emplace_back(result.back() * transition_);
  return result;
}

// At step -1 all registers hold the position of step -1, in any mode.
ExtendedMatrix LossRecursion::started(const Matrix& covariance) const {
  Matrix state(modes_ * n_, covariance.cols());
  for (Eigen::Index c = 0; c < modes_; ++c) state.middleRows(c * n_, n_) = covariance.replicate(n_, 1) * stationary_(c);
  return state;
}

// The sum over the modes of the latest register.
long double LossRecursion::received_of(const Eigen::Ref<const Vector>& state) const {
  long double sum = 0.0L;
  for (Eigen::Index c = 0; c < modes_; ++c) sum += state(c * n_);
  return sum;
}

// The states in columns `from` and later, one step of the chain later: A_c sum_a Pi_ac state_a.
void LossRecursion::advance(Matrix& states, Eigen::Index from) const {
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
void LossRecursion::advance_squares(std::vector<Matrix>& squares) const {
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

// Row and column k of E r~(l) r~(k), l >= k. `state`: the Y of step k.
void LossRecursion::add_later(Eigen::Index k, Matrix state, const Matrix& mean, const Matrix& cross,
                              const Vector& innovation, const std::vector<Matrix>& later_modes, Matrix& second) const {
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

}  // namespace platoon
