#include "stochastic_platoon/math/string/burst_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace platoon {

namespace {

using Complex = std::complex<double>;

constexpr double kPi = 3.14159265358979323846;

}  // namespace

BurstSpectra::BurstSpectra(const BurstPattern& pattern, std::size_t nodes) : pattern_(&pattern), nodes_(nodes) {
  for (const BurstVehicle& vehicle : pattern.types) types_.push_back(values_of(vehicle));
}

BurstSpectra::Type BurstSpectra::values_of(const BurstVehicle& vehicle) const {
  Type type;
  const Eigen::Index count = size();
  for (auto* values : {&type.gain, &type.margin, &type.own, &type.passed, &type.complement, &type.headway, &type.noise,
                       &type.surprise, &type.moving})
    values->setZero(count);
  const std::optional<BurstLink>& link = vehicle.losses();
  std::optional<BurstLink::Value> constant;
  if (link) {
    constant = link->at(0.0);
    type.deviation.resize(count);
    type.outward.resize(count, 2 * link->registers());
    type.scattered.resize(count, 2 * link->registers());
  }
  const auto delay = static_cast<double>(vehicle.vehicle().link.delay);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double w = 2.0 * kPi * (static_cast<double>(k) + 0.5) / static_cast<double>(nodes_);
    const LinkedVehicleValue plain = vehicle.plain().at(w);
    Complex mean = plain.undelayed * std::polar(1.0, -std::remainder(delay * w, 2.0 * kPi));  // H T^
    type.own(k) = plain.gain;
    type.headway(k) = plain.headway;
    type.noise(k) = plain.input[0].noise;
    type.passed(k) = 1.0;
    type.margin(k) = plain.margin;
    if (link) {
      const BurstLink::Value value = link->at(w);
      mean *= value.passed();
      type.passed(k) = std::norm(value.passed());
      type.margin(k) += plain.gain * value.margin();
      type.surprise(k) = std::norm(value.surprise);
      type.moving(k) = link->slope() * link->slope() * link->kernel(value, w, *constant, 0.0);
      type.deviation(k) = value.deviation;
      type.outward.row(k) = value.outward.real().transpose();
      type.scattered.row(k) = value.scattered.real().transpose();
    }
    type.gain(k) = type.own(k) * type.passed(k);
    type.complement(k) = std::norm(1.0 - mean);
  }
  return type;
}

// < conj(D(nu)) driven(nu) y / (1 - y) >_nu: on equally spaced nodes a circular convolution with the powers of lambda.
Eigen::ArrayXd BurstSpectra::remembered(const Type& type, double memory, const Eigen::ArrayXd& driven) const {
  const Eigen::Index half = size(), n = 2 * half;
  Eigen::VectorXcd values(n), lags(n);
  values.head(half) = (type.deviation.conjugate() * driven).matrix();
  values.tail(half) = values.head(half).reverse().conjugate();
  fft_.inv(lags, values);
  double power = std::pow(memory, static_cast<double>(n));
  const double all = 1.0 - power;
  for (Eigen::Index t = 0; t < n; ++t) {
    lags(t) *= power / all;
    power = t == 0 ? memory : power * memory;
  }
  fft_.fwd(values, lags);
  return (type.deviation * values.head(half).array()).real();
}

Eigen::ArrayXd BurstSpectra::scattered(std::size_t follower, const Eigen::ArrayXd& driven) const {
  const std::optional<BurstLink>& link = (*pattern_)[follower].losses();
  if (!link) return Eigen::ArrayXd::Zero(size());
  const Type& type = of(follower);
  const Eigen::VectorXd inward =
      2.0 / static_cast<double>(nodes_) * (type.scattered.matrix().transpose() * driven.matrix());
  Eigen::ArrayXd result = 2.0 * (type.outward.matrix() * inward).array() - inward(link->registers());
  if (link->memory() != 0.0) result += 2.0 * link->odds() * remembered(type, link->memory(), driven);
  return result;
}

Eigen::ArrayXd BurstSpectra::added(std::size_t follower, double speed) const {
  const Type& type = of(follower);
  Eigen::ArrayXd sum = type.passed * type.noise;
  if ((*pattern_)[follower].losses())
    sum += scattered(follower, type.surprise * type.noise) + speed * speed * type.moving;
  return type.own * sum;
}

Eigen::ArrayXd BurstSpectra::pattern_margin() const {
  // Uses logarithms: at a resonance one vehicle's gain may be 1e9 and that of the product 1e-9.
  Eigen::ArrayXd log = Eigen::ArrayXd::Zero(size());
  for (std::size_t t = 0; t < types_.size(); ++t) {
    const auto count = static_cast<double>(std::count(pattern_->order.begin(), pattern_->order.end(), t));
    const Type& type = types_[t];
    log += count * (type.margin < 0.5).select((-type.margin).log1p(), type.gain.log());
  }
  return -log.expm1();
}

Eigen::ArrayXd BurstSpectra::in_front(const std::vector<Eigen::ArrayXd>& added,
                                      const Eigen::ArrayXd& margin_of_pattern) const {
  Eigen::ArrayXd once = Eigen::ArrayXd::Zero(size());
  for (std::size_t j = 0; j < pattern_->size(); ++j) once = of(j).gain * once + added[j];
  return once / margin_of_pattern;
}

}  // namespace platoon
