#include "stochastic_platoon/math/string/link_filter.hpp"

#include <cmath>
#include <stdexcept>

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

LinkFilter::LinkFilter(const LinkModel& link, double noise_variance)
    : link_(link), noise_variance_(noise_variance), loss_(link.loss.value_or(LossModel())) {
  if (!loss_.is_independent()) throw std::invalid_argument("mean_burst: given: must be absent for this theory");
  loss_feedback_ = platoon::loss_feedback(loss_);
  near_ = {register_polynomial(loss_.predictor, loss_.probability), register_polynomial(loss_.predictor, 1.0)};
  far_ = {recentred(near_.registers), recentred(near_.surprise)};
}

LinkFilter::Value LinkFilter::at(const CirclePoint& point) const {
  const bool near = point.centre == Centre::kOne;
  const Half& part = near ? near_ : far_;
  const Complex s = point.offset, z = s + (near ? 1.0L : -1.0L);
  Value value{power(z, loss_.predictor.size()), evaluate(part.registers, s), evaluate(part.surprise, s), 0.0, 0.0};
  value.innovation = static_cast<double>(std::norm(value.surprise) / std::norm(value.registers));
  const double coloured =
      link_.has_white_noise() ? 1.0 : std::norm(link_.noise_filter(static_cast<std::complex<double>>(z)));
  value.noise = coloured * noise_variance_ + link_.quantisation_step * link_.quantisation_step / 12.0;
  return value;
}

double LinkFilter::loss_factor() const {
  const double q = loss_.probability;
  return q * (1.0 - q) / (1.0 - loss_feedback_);
}

double LinkFilter::mean_innovation() const {
  if (!has_losses()) return 0.0;
  double sum = 0.0;
  for (std::size_t j = 0; j < loss_.predictor.size(); ++j) sum += static_cast<double>(j + 1) * loss_.predictor[j];
  return sum / (1.0 - loss_.probability);
}

int LinkFilter::surprise_zeros() const {
  if (loss_.predictor.empty()) return 0;
  const Polynomial surprise = z_form(near_.surprise);
  return leading_zeros(near_.surprise, delta_form(surprise.cwiseAbs()), 1);
}

int LinkFilter::noise_zeros() const {
  if (link_.quantisation_step > 0.0) return 0;
  if (noise_variance_ == 0.0) return ZerosAtZero::kNone;
  const Polynomial& filter = link_.noise_filter.numerator();
  return leading_zeros(delta_form(filter), delta_form(filter.cwiseAbs()), 0);
}

std::vector<std::complex<double>> LinkFilter::noise_frequencies() const {
  const CirclePolynomial filter = delta_form(link_.noise_filter.denominator());
  if (filter.size() < 2) return {};
  return frequencies_of(zeros(filter));
}

}  // namespace platoon
