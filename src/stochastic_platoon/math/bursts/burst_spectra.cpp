#include "stochastic_platoon/math/bursts/burst_spectra.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <complex>
#include <utility>

namespace platoon {

namespace {

using boost::math::double_constants::pi;

using DoubleComplex = std::complex<double>;

}  // namespace

BurstSpectra::BurstSpectra(const BurstPattern& pattern, std::size_t nodes) : pattern_(&pattern) {
  const auto half = static_cast<Eigen::Index>(nodes / 2);
  node_ = pi * (Eigen::ArrayXd::LinSpaced(half, 0.0, static_cast<double>(half - 1)) + 0.5) / static_cast<double>(half);
  weight_ = Eigen::ArrayXd::Constant(half, 1.0 / static_cast<double>(half));
  evaluate(nullptr);
}

BurstSpectra::BurstSpectra(const BurstPattern& pattern, const Quadrature& rule)
    : pattern_(&pattern),
      node_(Eigen::Map<const Eigen::ArrayXd>(rule.node.data(), static_cast<Eigen::Index>(rule.node.size()))),
      weight_(Eigen::Map<const Eigen::ArrayXd>(rule.weight.data(), static_cast<Eigen::Index>(rule.weight.size()))) {
  evaluate(&rule);
}

void BurstSpectra::evaluate(const Quadrature* rule) {
  for (const BurstVehicle& vehicle : pattern_->types) {
    std::shared_ptr<const BurstScatter> losses;
    for (std::size_t t = 0; t < types_.size() && vehicle.losses(); ++t) {
      if (pattern_->types[t].vehicle().link.loss == vehicle.vehicle().link.loss) losses = types_[t].losses;
    }
    if (vehicle.losses() && !losses) losses = std::make_shared<BurstScatter>(*vehicle.losses(), node_, weight_, rule);
    types_.push_back(values_of(vehicle, std::move(losses)));
  }
}

BurstSpectra::Type BurstSpectra::values_of(const BurstVehicle& vehicle,
                                           std::shared_ptr<const BurstScatter> losses) const {
  Type type;
  const Eigen::Index count = size();
  for (auto* values : {&type.gain, &type.margin, &type.own, &type.passed, &type.complement, &type.headway, &type.noise})
    values->setZero(count);
  const auto delay = static_cast<double>(vehicle.vehicle().link.delay);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double w = node_(k);
    const LinkedVehicleValue plain = vehicle.plain().at(w);
    DoubleComplex mean = plain.undelayed * std::polar(1.0, -std::remainder(delay * w, 2.0 * pi));  // H T^
    type.own(k) = plain.gain;
    type.headway(k) = plain.headway;
    type.noise(k) = plain.input[0].noise;
    type.passed(k) = 1.0;
    type.margin(k) = plain.margin;
    if (losses) {
      mean *= losses->passed(k);
      type.passed(k) = std::norm(losses->passed(k));
      type.margin(k) += plain.gain * losses->margin(k);
    }
    type.gain(k) = type.own(k) * type.passed(k);
    type.complement(k) = std::norm(1.0 - mean);
  }
  type.losses = std::move(losses);
  return type;
}

Eigen::ArrayXd BurstSpectra::scattered(std::size_t follower, const Eigen::ArrayXd& spectrum) const {
  const Type& type = of(follower);
  if (!type.losses) return Eigen::ArrayXd::Zero(size());
  return (*type.losses)((type.losses->surprise * spectrum).matrix());
}

Eigen::ArrayXd BurstSpectra::added(std::size_t follower, double speed) const {
  const Type& type = of(follower);
  Eigen::ArrayXd sum = type.passed * type.noise;
  if (type.losses) sum += scattered(follower, type.noise) + speed * speed * type.losses->moving;
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
