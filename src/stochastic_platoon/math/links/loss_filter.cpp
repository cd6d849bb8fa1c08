#include "stochastic_platoon/math/links/loss_filter.hpp"

#include <cmath>
#include <vector>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

// z^n - factor (c_1 z^(n-1) + ... + c_n), by powers of z - 1; exactly 1 - factor at z = 1, as the c have sum 1.
CirclePolynomial register_polynomial(const std::vector<double>& c, double factor) {
  if (c.empty()) return {1.0L};
  Polynomial p(static_cast<Eigen::Index>(c.size()) + 1);
  p(0) = 1.0;
  for (std::size_t j = 0; j < c.size(); ++j) p(static_cast<Eigen::Index>(j) + 1) = -factor * c[j];
  CirclePolynomial shifted = delta_form(p);
  shifted.front() = 1.0L - static_cast<long double>(factor);
  return shifted;
}

}  // namespace

LossFilter::LossFilter(const LossModel& loss)
    : loss_(loss), feedback_(has_memory() ? second_moment_radius(loss) : loss_feedback(loss)) {
  near_ = {register_polynomial(loss.predictor, loss.probability), register_polynomial(loss.predictor, 1.0)};
  if (has_memory()) near_.registers = {1.0L};
  far_ = {recentred(near_.registers), recentred(near_.surprise)};
  if (has_memory() && feedback_ < 1.0) kernel_ = std::make_shared<LossKernel>(loss);
}

LossFilter::Value LossFilter::at(const CirclePoint& point) const {
  if (kernel_) return Value::of_missing(kernel_->at(point.frequency).missing());
  const bool near = point.centre == Centre::kOne;
  const Half& part = near ? near_ : far_;
  const Complex s = point.offset, powers = power(s + (near ? 1.0L : -1.0L), loss_.predictor.size());
  const Complex registers = evaluate(part.registers, s);
  const long double q = loss_.probability, p = 1.0L - q;
  return {p * powers * std::conj(registers) / std::norm(registers), q / p * evaluate(part.surprise, s) / powers};
}

LossFilter::RankOne LossFilter::rank_one(const CirclePoint& point) const {
  const Half& part = point.centre == Centre::kOne ? near_ : far_;
  const long double returned = 1.0L / std::norm(evaluate(part.registers, point.offset));
  return {static_cast<double>(returned),
          static_cast<double>(std::norm(evaluate(part.surprise, point.offset)) * returned)};
}

double LossFilter::loss_factor() const {
  const double q = loss_.probability;
  return q * (1.0 - q) / (1.0 - feedback_);
}

double LossFilter::slope() const {
  double sum = 0.0;
  for (std::size_t j = 0; j < loss_.predictor.size(); ++j) sum += static_cast<double>(j + 1) * loss_.predictor[j];
  return sum;
}

double LossFilter::lag() const {
  if (kernel_) return slope() * kernel_->at(0.0).deviation.real();
  return loss_.probability * slope() / (1.0 - loss_.probability);
}

int LossFilter::surprise_zeros() const {
  if (loss_.predictor.empty()) return 0;
  const Polynomial surprise = z_form(near_.surprise);
  return leading_zeros(near_.surprise, delta_form(surprise.cwiseAbs()), 1);
}

GainFactor LossFilter::factor() const {
  if (kernel_) return kernel_->factor();
  return {zeros(near_.registers), {}};
}

ExactTransfer LossFilter::transfer() const {
  if (kernel_) return kernel_->transfer();
  ExactTransfer found{{Exact(1.0L - static_cast<long double>(loss_.probability))}, {}};
  for (const long double c : near_.registers) found.denominator.emplace_back(c);
  found.delay = 1 - static_cast<std::ptrdiff_t>(near_.registers.size());
  return found;
}

}  // namespace platoon
