#include "stochastic_platoon/math/string/burst_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace platoon {

namespace {

using Complex = std::complex<double>;

constexpr double kPi = 3.14159265358979323846;

}  // namespace

BurstSpectra::BurstSpectra(const BurstPattern& pattern, std::size_t nodes) : pattern_(&pattern), equally_spaced_(true) {
  const auto half = static_cast<Eigen::Index>(nodes / 2);
  node_ = kPi * (Eigen::ArrayXd::LinSpaced(half, 0.0, static_cast<double>(half - 1)) + 0.5) / static_cast<double>(half);
  weight_ = Eigen::ArrayXd::Constant(half, 1.0 / static_cast<double>(half));
  evaluate();
}

BurstSpectra::BurstSpectra(const BurstPattern& pattern, const Quadrature& rule)
    : pattern_(&pattern),
      node_(Eigen::Map<const Eigen::ArrayXd>(rule.node.data(), static_cast<Eigen::Index>(rule.node.size()))),
      weight_(Eigen::Map<const Eigen::ArrayXd>(rule.weight.data(), static_cast<Eigen::Index>(rule.weight.size()))),
      equally_spaced_(false) {
  evaluate();
}

void BurstSpectra::evaluate() {
  for (const BurstVehicle& vehicle : pattern_->types) {
    types_.push_back(values_of(vehicle));
    if (vehicle.losses() && !equally_spaced_ && vehicle.losses()->memory() != 0.0)
      types_.back().kernel = kernel_of(types_.back(), vehicle.losses()->memory());
  }
}

Eigen::MatrixXd BurstSpectra::kernel_of(const Type& type, double memory) const {
  const Eigen::Index count = size();
  std::vector<Complex> turn;
  for (Eigen::Index k = 0; k < count; ++k) turn.push_back(std::polar(1.0, node_(k)));
  // D(w) conj(D(nu)) y / (1 - y) without the checks of std::complex for infinities.
  const auto term = [memory](Complex product, Complex turned) {
    const double re = memory * turned.real(), im = memory * turned.imag();
    const double over = 1.0 - 2.0 * re + re * re + im * im, a = re - re * re - im * im;  // y (1 - conj y) = a + j im
    return (product.real() * a - product.imag() * im) / over;
  };
  const auto times = [](Complex a, Complex b) {
    return Complex(a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real());
  };
  Eigen::MatrixXd kernel(count, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const Complex inward = type.deviation(c), ahead = turn[static_cast<std::size_t>(c)];
    for (Eigen::Index r = 0; r < count; ++r) {
      const Complex outward = type.deviation(r), back = std::conj(turn[static_cast<std::size_t>(r)]);
      kernel(r, c) = 0.5 * (term(times(outward, std::conj(inward)), times(ahead, back)) +
                            term(times(outward, inward), times(std::conj(ahead), back)));
    }
  }
  return kernel;
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
    const double w = node_(k);
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
  const Eigen::VectorXd weighted = (weight_ * driven).matrix(), inward = type.scattered.matrix().transpose() * weighted;
  Eigen::ArrayXd result = 2.0 * (type.outward.matrix() * inward).array() - inward(link->registers());
  if (link->memory() == 0.0) return result;
  const Eigen::ArrayXd memory =
      equally_spaced_ ? remembered(type, link->memory(), driven) : Eigen::ArrayXd((type.kernel * weighted).array());
  result += 2.0 * link->odds() * memory;
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
