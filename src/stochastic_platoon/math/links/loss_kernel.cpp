#include "stochastic_platoon/math/links/loss_kernel.hpp"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/numerics/exact_resolvent.hpp"
#include "stochastic_platoon/math/numerics/resolvent_terms.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/numerics/zeros.hpp"

namespace platoon {

namespace {

using DoubleComplex = std::complex<double>;

[[noreturn]] void reject_growth() {
  throw std::invalid_argument("on_loss: variance of the predictions grows: must settle");
}

void require_theory(const LossModel& loss) {
  if (!(loss.probability > 0.0 && loss.probability < 1.0))
    throw std::invalid_argument(formatted("loss probability: %g: must be above 0 and below 1", loss.probability));
  if (loss.alternates())
    throw std::invalid_argument(
        formatted("mean_burst: %g: must be above 1 for a probability of 0.5, as losses then alternate with arrivals",
                  *loss.mean_burst));
  if (!(second_moment_radius(loss) < 1.0)) reject_growth();
}

}  // namespace

LossKernel::LossKernel(const LossModel& loss) : chain_(loss) {
  require_theory(loss);
  const Eigen::Index m = chain_.registers(), modes = chain_.modes(), arrived = chain_.arrived(), lost = chain_.lost();
  forgets_ = loss.predictor.empty();
  transition_ = chain_.first_moments();
  entry_ = chain_.differences().col(0);

  // V Q V' of each drive; the row or column of V Q_c V' next to V e is at place (i, c) of a drive.
  const Eigen::Index squares = m * m, drives = lost * m;
  Eigen::MatrixXd driven = Eigen::MatrixXd::Zero(modes * squares, 2 * drives);
  for (Eigen::Index c = 0; c < lost; ++c) {
    const Eigen::Index square = (arrived + c) * squares;
    for (Eigen::Index i = 0; i < m; ++i) {
      for (Eigen::Index k = 0; k < m; ++k) {
        driven(square + k * m + i, c * m + i) += entry_(k);
        driven(square + i * m + k, c * m + i) += entry_(k);
        driven(square + k * m + i, drives + c * m + i) += entry_(k);
        driven(square + i * m + k, drives + c * m + i) -= entry_(k);
      }
    }
  }
  const Eigen::MatrixXd solved = (Eigen::MatrixXd::Identity(modes * squares, modes * squares) - chain_.second_moments())
                                     .partialPivLu()
                                     .solve(driven);
  even_.resize(drives, drives);
  odd_.resize(drives, drives);
  own_ = Eigen::VectorXd::Zero(drives);
  for (Eigen::Index c = 0; c < lost; ++c) {
    even_.middleRows(c * m, m) = solved.block((arrived + c) * squares, 0, m, drives);
    odd_.middleRows(c * m, m) = solved.block((arrived + c) * squares, drives, m, drives);
  }
  for (Eigen::Index c = 0; c < lost; ++c)
    own_ += 0.5 * chain_.stationary()(arrived + c) * even_.middleCols(c * m, m) * entry_;
  itself_ = Eigen::RowVectorXd::Zero(modes * m);
  for (Eigen::Index c = arrived; c < modes; ++c) itself_(block(c)) = 1.0;
  // A radius of 1 that rounds to less has this effect.
  for (Eigen::Index c = 0; c < lost; ++c) {
    if (!(own_(c * m) > 0.0)) reject_growth();
  }

  transfer_ = std::make_shared<const ExactTransfer>(mean_transfer());
  factor_ = {zeros(transfer_->denominator), zeros(transfer_->numerator)};
  find_memories();
}

ExactTransfer LossKernel::mean_transfer() const {
  constexpr double kZero = 1e-80;  // smaller coefficients are rounding of a hundred digits
  const auto polynomial = [](const ExactMatrix& matrix) {
    return exact_resolvent(matrix, ExactMatrix::Zero(1, matrix.cols())).denominator;
  };
  Exact arrivals(0);
  for (Eigen::Index c = 0; c < chain_.arrived(); ++c) arrivals += Exact(chain_.stationary()(c));
  // The mean of r is zero if s takes away what the registers give.
  const ExactMatrix transition = transition_.cast<Exact>();
  ExactMatrix inverse = transition, given = ExactMatrix::Zero(1, transition.cols());
  for (Eigen::Index c = 0; c < chain_.modes(); ++c) given += transition.row(block(c));
  for (Eigen::Index c = 0; c < chain_.arrived(); ++c) {
    const Exact share = Exact(chain_.stationary()(c)) / arrivals;
    for (Eigen::Index i = 0; i < chain_.registers(); ++i) inverse.row(block(c) + i) -= given * Exact(share * entry_(i));
  }
  ExactTransfer found{polynomial(inverse), polynomial(transition)};
  const auto without_zeros_at_origin = [kZero](ExactPolynomial& p) {
    std::ptrdiff_t count = 0;
    for (; p.size() > 1 && abs(p.back()) < kZero; ++count) p.pop_back();
    return count;
  };
  found.delay = without_zeros_at_origin(found.denominator);
  found.delay -= without_zeros_at_origin(found.numerator);
  for (Exact& coefficient : found.numerator) coefficient *= arrivals;
  found.numerator = shifted_to_one(std::move(found.numerator));
  found.denominator = shifted_to_one(std::move(found.denominator));
  return found;
}

void LossKernel::find_memories() {
  const Eigen::Index modes = chain_.modes();
  right_.resize(modes, 0);
  left_.resize(0, modes);
  for (const ResolventTerm& term : memory_terms(chain_.transition().transpose())) {
    for (Eigen::Index k = 0; k < term.left.cols(); ++k) {
      memories_.push_back(term.eigenvalue);
      right_.conservativeResize(modes, right_.cols() + 1);
      right_.rightCols(1) = term.left.col(k);
      left_.conservativeResize(left_.rows() + 1, modes);
      left_.bottomRows(1) = term.right.row(k);
    }
  }
}

LossKernel::Value LossKernel::at(double frequency) const {
  const Eigen::Index m = chain_.registers(), size = transition_.rows(), modes = chain_.modes(), drives = even_.rows();
  const DoubleComplex back = std::polar(1.0, -frequency);
  const Eigen::PartialPivLU<Eigen::MatrixXcd> inverse(Eigen::MatrixXcd::Identity(size, size) - back * transition_);
  Eigen::VectorXcd output = Eigen::VectorXcd::Zero(size), drive = Eigen::VectorXcd::Zero(size);
  for (Eigen::Index c = 0; c < modes; ++c) output(block(c)) = 1.0;
  for (Eigen::Index c = chain_.arrived(); c < modes; ++c) drive.segment(block(c), m) = chain_.stationary()(c) * entry_;
  Value value;
  value.surprise = forgets_ ? 1.0 : 0.0;
  for (Eigen::Index j = 0; j < m; ++j) {  // 1 - e^{-j x} = 2 sin(x/2) (sin(x/2) + j cos(x/2))
    const double half = 0.5 * static_cast<double>(j + 1) * frequency, sine = std::sin(half);
    value.surprise += 2.0 * chain_.predictor()(j) * sine * DoubleComplex(sine, std::cos(half));
  }
  const Eigen::VectorXcd d = inverse.solve(drive);
  value.deviation = output.cwiseProduct(d).sum();
  value.outward = inverse.transpose().solve(output);
  const Eigen::VectorXcd crossed = back * (transition_.bottomRows(drives) * d);
  value.scattered = -std::conj(value.deviation) * d;
  value.scattered.tail(drives) += even_ * crossed.real() + DoubleComplex(0.0, 1.0) * (odd_ * crossed.imag()) + own_;
  Eigen::VectorXcd lost = Eigen::VectorXcd::Zero(modes), innovation(modes);
  for (Eigen::Index c = 0; c < modes; ++c) {
    if (c >= chain_.arrived()) lost(c) = value.outward.segment(block(c), m).cwiseProduct(entry_).sum();
    innovation(c) = std::conj(d(block(c))) - chain_.stationary()(c) * std::conj(value.deviation);
  }
  value.recalling = right_.transpose() * lost;
  value.remembered = left_ * innovation;
  value.mirrored = left_ * innovation.conjugate();
  return value;
}

double LossKernel::kernel(const Value& outward, double w, const Value& inward, double nu) const {
  DoubleComplex sum = outward.outward.cwiseProduct(inward.scattered).sum();
  for (std::size_t m = 0; m < memories_.size(); ++m) {
    const auto i = static_cast<Eigen::Index>(m);
    const DoubleComplex y = memories_[m] * std::polar(1.0, nu - w);
    sum += outward.recalling(i) * inward.remembered(i) * y / (1.0 - y);
  }
  return 2.0 * sum.real() - (itself_ * inward.scattered.real()).value();
}
}  // namespace platoon
