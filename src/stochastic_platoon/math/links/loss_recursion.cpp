#include "stochastic_platoon/math/links/loss_recursion.hpp"

#include <algorithm>
#include <cstddef>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

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

SequenceMoments LossRecursion::operator()(const SequenceMoments& arriving,
                                          const std::vector<long double>& slopes) const {
  const auto sequences = static_cast<Eigen::Index>(slopes.size());
  const Eigen::Index count = arriving.mean.size() / sequences;
  const std::vector<Matrix> later_modes = powers(count);
  std::vector<Vector> innovation;
  Vector deviation(arriving.mean.size());
  for (Eigen::Index a = 0; a < sequences; ++a) {
    innovation.push_back(innovations(arriving.mean.segment(a * count, count), slopes[static_cast<std::size_t>(a)]));
    deviation.segment(a * count, count) = mean_of(innovation.back());
  }
  SequenceMoments received{arriving.mean + deviation, Matrix(arriving.mean.size(), arriving.mean.size())};
  for (Eigen::Index a = 0; a < sequences; ++a) {
    for (Eigen::Index b = 0; b < sequences; ++b)
      add_products(innovation[static_cast<std::size_t>(a)], innovation[static_cast<std::size_t>(b)],
                   arriving.covariance.block(a * count, b * count, count, count), later_modes,
                   received.covariance.block(a * count, b * count, count, count),
                   received.covariance.block(b * count, a * count, count, count));
  }
  received.covariance -= (deviation * deviation.transpose()).eval();
  return received;
}

// E r~(l) r~'(k) and its transpose for l >= k, where r~ is of the sequence of innovation `one` and r~' of `other`.
// `covariance`: of the arriving values of the one (rows) with those of the other.
void LossRecursion::add_products(const Vector& one, const Vector& other, const Matrix& covariance,
                                 const std::vector<Matrix>& later_modes, Block second, Block mirrored) const {
  const bool same = &one == &other;
  Matrix mean_of_one = Matrix::Zero(modes_ * n_, 1), mean_of_other = mean_of_one;
  Matrix cross_of_one = started(covariance.row(0));  // with the arriving values of the other
  Matrix cross_of_other = same ? Matrix() : started(covariance.col(0).transpose());
  const Matrix &mean = same ? mean_of_one : mean_of_other, &cross = same ? cross_of_one : cross_of_other;
  std::vector<Matrix> products;
  for (Eigen::Index c = 0; c < modes_; ++c)
    products.push_back(Matrix::Constant(n_, n_, stationary_(c) * covariance(0, 0)));
  for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
    check_interruption();
    if (k > 0) {
      advance(cross_of_one, k);
      advance(mean_of_one, 0);
      if (!same) advance(cross_of_other, k);
      if (!same) advance(mean_of_other, 0);
      advance_products(products);
      for (Eigen::Index c = 0; c < modes_; ++c) {
        Matrix& product = products[static_cast<std::size_t>(c)];
        const Eigen::Index first = c * n_;
        const long double share = stationary_(c);
        if (c < arrived_) {
          product.col(0) += cross_of_one.col(k).segment(first, n_);
          product.row(0) += cross.col(k).segment(first, n_).transpose();
          product(0, 0) += share * covariance(k, k);
          cross_of_one.row(first) += share * covariance.row(k);
          if (!same) cross_of_other.row(first) += share * covariance.col(k).transpose();
        } else {
          product.col(0) -= other(k) * mean_of_one.col(0).segment(first, n_);
          product.row(0) -= one(k) * mean.col(0).segment(first, n_).transpose();
          product(0, 0) += share * one(k) * other(k);
          mean_of_one(first) -= share * one(k);
          if (!same) mean_of_other(first) -= share * other(k);
        }
      }
    }
    Matrix later(modes_ * n_, 1);
    for (Eigen::Index c = 0; c < modes_; ++c)
      later.middleRows(c * n_, n_) = products[static_cast<std::size_t>(c)].col(0);
    add_later(k, later, mean, cross, one, later_modes, second, mirrored);
  }
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

// u(k); values before step -1 are that of step -1, in the frame that moves with the slope.
ExtendedVector LossRecursion::innovations(const Eigen::Ref<const Vector>& mean, long double slope) const {
  Vector innovation = mean;
  for (Eigen::Index j = 0; j < n_; ++j) {
    for (Eigen::Index k = 0; k < mean.size(); ++k)
      innovation(k) -=
          predictor_(j) * (mean(std::max<Eigen::Index>(k - 1 - j, 0)) - slope * static_cast<long double>(j + 1));
  }
  return innovation;
}

// E r~(k).
ExtendedVector LossRecursion::mean_of(const Vector& innovation) const {
  Matrix state = Matrix::Zero(modes_ * n_, 1);
  Vector mean = Vector::Zero(innovation.size());
  for (Eigen::Index k = 1; k < innovation.size(); ++k) {
    advance(state, 0);
    for (Eigen::Index c = arrived_; c < modes_; ++c) state(c * n_) -= stationary_(c) * innovation(k);
    mean(k) = received_of(state.col(0));
  }
  return mean;
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
void LossRecursion::advance_products(std::vector<Matrix>& products) const {
  const std::vector<Matrix> before = products;
  const Eigen::Index kept = n_ - 1;
  for (Eigen::Index c = 0; c < modes_; ++c) {
    Matrix moved = Matrix::Zero(n_, n_), &product = products[static_cast<std::size_t>(c)];
    for (Eigen::Index a = 0; a < modes_; ++a)
      moved.noalias() += transition_(a, c) * before[static_cast<std::size_t>(a)];
    product.setZero();
    product.bottomRightCorner(kept, kept) = moved.topLeftCorner(kept, kept);
    if (c < arrived_) continue;
    const Vector predicted = moved * predictor_;
    product.col(0).tail(kept) = predicted.head(kept);
    product.row(0).tail(kept) = (moved.transpose() * predictor_).head(kept).transpose();
    product(0, 0) = predictor_.dot(predicted);
  }
}

// `state`: the Y of step k; `mean` and `cross`: of the other sequence; `innovation`: of the one.
void LossRecursion::add_later(Eigen::Index k, Matrix state, const Matrix& mean, const Matrix& cross,
                              const Vector& innovation, const std::vector<Matrix>& later_modes, Block second,
                              Block mirrored) const {
  second(k, k) = mirrored(k, k) = received_of(state.col(0));
  for (Eigen::Index l = k + 1; l < second.rows(); ++l) {
    check_interruption();
    advance(state, 0);
    const Matrix& modes = later_modes[static_cast<std::size_t>(l - k)];
    for (Eigen::Index c = 0; c < modes_; ++c) {
      long double expected = 0.0L;  // E[s~(l) or 1, mode c at l, r~'(k)]
      for (Eigen::Index a = 0; a < modes_; ++a)
        expected += modes(a, c) * (c < arrived_ ? cross(a * n_, l) : mean(a * n_, 0));
      state(c * n_) += c < arrived_ ? expected : -innovation(l) * expected;
    }
    second(l, k) = mirrored(k, l) = received_of(state.col(0));
  }
}

}  // namespace platoon
