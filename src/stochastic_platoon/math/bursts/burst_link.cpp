#include "stochastic_platoon/math/bursts/burst_link.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/KroneckerProduct>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

using DoubleComplex = std::complex<double>;

[[noreturn]] void reject_growth() {
  throw std::invalid_argument("on_loss: variance of the predictions grows: must settle");
}

void require_theory(const LossModel& loss) {
  if (!(loss.probability > 0.0 && loss.probability < 1.0))
    throw std::invalid_argument(formatted("loss probability: %g: must be above 0 and below 1", loss.probability));
  if (loss.predictor.empty()) throw std::invalid_argument("on_loss: zero: must be a predictor of positions");
  if (loss.alternates())
    throw std::invalid_argument(
        formatted("mean_burst: %g: must be above 1 for a probability of 0.5, as losses then alternate with arrivals",
                  *loss.mean_burst));
  if (!(second_moment_radius(loss) < 1.0)) reject_growth();
}

/// The eigenvalues less 1.
std::vector<std::complex<long double>> shifted_eigenvalues(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXcd values = matrix.eigenvalues();
  std::vector<std::complex<long double>> shifted;
  for (Eigen::Index i = 0; i < values.size(); ++i)
    shifted.emplace_back(static_cast<long double>(values(i).real()) - 1.0L, values(i).imag());
  return shifted;
}

}  // namespace

BurstLink::BurstLink(const LossModel& loss)
    : arrival_(1.0 - loss.probability),
      loss_(loss.probability),
      memory_(loss.after_loss() - loss.after_arrival()),
      n_(static_cast<Eigen::Index>(loss.predictor.size())),
      predictor_(Eigen::Map<const Eigen::VectorXd>(loss.predictor.data(), n_)) {
  require_theory(loss);
  for (Eigen::Index j = 0; j < n_; ++j) slope_ += static_cast<double>(j + 1) * predictor_(j);
  Eigen::MatrixXd arrived = Eigen::MatrixXd::Zero(n_, n_);
  arrived.diagonal(-1).setOnes();
  Eigen::MatrixXd lost = arrived;
  lost.row(0) = predictor_.transpose();
  const double to_loss = loss.after_arrival(), stays_lost = loss.after_loss();
  transition_.resize(2 * n_, 2 * n_);
  transition_ << (1.0 - to_loss) * arrived, (1.0 - stays_lost) * arrived, to_loss * lost, stays_lost * lost;

  const Eigen::Index squares = n_ * n_;
  const Eigen::MatrixXd of_arrived = Eigen::kroneckerProduct(arrived, arrived).eval(),
                        of_lost = Eigen::kroneckerProduct(lost, lost).eval();
  Eigen::MatrixXd second(2 * squares, 2 * squares);
  second << (1.0 - to_loss) * of_arrived, (1.0 - stays_lost) * of_arrived, to_loss * of_lost, stays_lost * of_lost;
  Eigen::MatrixXd drives = Eigen::MatrixXd::Zero(2 * squares, 2 * n_);  // (row, column) of Q_1 is at column n + row
  for (Eigen::Index i = 0; i < n_; ++i) {
    drives(squares + i, i) += 1.0;
    drives(squares + i * n_, i) += 1.0;
    drives(squares + i, n_ + i) += 1.0;
    drives(squares + i * n_, n_ + i) -= 1.0;
  }
  const Eigen::MatrixXd solved =
      (Eigen::MatrixXd::Identity(2 * squares, 2 * squares) - second).partialPivLu().solve(drives);
  even_ = solved.block(squares, 0, n_, n_);
  odd_ = solved.block(squares, n_, n_, n_);
  own_ = 0.5 * even_.col(0);
  if (!(own_(0) > 0.0)) reject_growth();  // a radius of 1 that rounds to less has this effect

  factor_.poles = shifted_eigenvalues(transition_);
  Eigen::MatrixXd inverse = transition_;
  inverse.row(0) -= transition_.row(0) + transition_.row(n_);
  factor_.zeros = shifted_eigenvalues(inverse);
}

BurstLink::Value BurstLink::at(double frequency) const {
  const DoubleComplex back = std::polar(1.0, -frequency);
  const Eigen::PartialPivLU<Eigen::MatrixXcd> inverse(Eigen::MatrixXcd::Identity(2 * n_, 2 * n_) - back * transition_);
  Eigen::VectorXcd output = Eigen::VectorXcd::Zero(2 * n_);
  output(0) = output(n_) = 1.0;
  Value value;
  value.surprise = 0.0;
  for (Eigen::Index j = 0; j < n_; ++j) {  // 1 - e^{-j x} = 2 sin(x/2) (sin(x/2) + j cos(x/2))
    const double half = 0.5 * static_cast<double>(j + 1) * frequency, sine = std::sin(half);
    value.surprise += 2.0 * predictor_(j) * sine * DoubleComplex(sine, std::cos(half));
  }
  const Eigen::VectorXcd d = inverse.solve(loss_ * Eigen::VectorXcd::Unit(2 * n_, n_));
  value.deviation = d(0) + d(n_);
  value.outward = inverse.transpose().solve(output);
  const Eigen::VectorXcd drive = back * (transition_.bottomRows(n_) * d);
  value.scattered = -std::conj(value.deviation) * d;
  value.scattered.tail(n_) += even_ * drive.real() + DoubleComplex(0.0, 1.0) * (odd_ * drive.imag()) + loss_ * own_;
  return value;
}

double BurstLink::kernel(const Value& outward, double w, const Value& inward, double nu) const {
  const DoubleComplex y = memory_ * std::polar(1.0, nu - w);
  const DoubleComplex remembered = odds() * outward.deviation * std::conj(inward.deviation) * y / (1.0 - y);
  return 2.0 * (outward.outward.cwiseProduct(inward.scattered).sum() + remembered).real() - inward.scattered(n_).real();
}

}  // namespace platoon
