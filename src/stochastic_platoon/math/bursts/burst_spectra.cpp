#include "stochastic_platoon/math/bursts/burst_spectra.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <complex>
#include <utility>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

using boost::math::double_constants::pi;

using DoubleComplex = std::complex<double>;

}  // namespace

BurstSpectra::BurstSpectra(const BurstPattern& pattern, std::size_t nodes) : PatternFactors(pattern.order) {
  const auto half = static_cast<Eigen::Index>(nodes / 2);
  node_ = pi * (Eigen::ArrayXd::LinSpaced(half, 0.0, static_cast<double>(half - 1)) + 0.5) / static_cast<double>(half);
  weight = Eigen::ArrayXd::Constant(half, 1.0 / static_cast<double>(half));
  evaluate(pattern, nullptr);
}

BurstSpectra::BurstSpectra(const BurstPattern& pattern, const Quadrature& rule)
    : PatternFactors(pattern.order),
      node_(Eigen::Map<const Eigen::ArrayXd>(rule.node.data(), static_cast<Eigen::Index>(rule.node.size()))) {
  weight = Eigen::Map<const Eigen::ArrayXd>(rule.weight.data(), node_.size());
  evaluate(pattern, &rule);
}

void BurstSpectra::evaluate(const BurstPattern& pattern, const Quadrature* rule) {
  for (const BurstVehicle& vehicle : pattern.types) {
    std::shared_ptr<const BurstScatter> losses;
    for (std::size_t t = 0; t < types_.size() && vehicle.losses(); ++t) {
      if (pattern.types[t].vehicle().link.loss == vehicle.vehicle().link.loss) losses = types_[t].losses;
    }
    if (vehicle.losses() && !losses) losses = std::make_shared<BurstScatter>(*vehicle.losses(), node_, weight, rule);
    add(vehicle, std::move(losses));
  }
}

void BurstSpectra::add(const BurstVehicle& vehicle, std::shared_ptr<const BurstScatter> losses) {
  Type type;
  Eigen::ArrayXd whole(nodes()), missing(nodes());  // |T^|^2 and 1 - |T^|^2
  for (auto* values : {&type.own, &type.passed, &type.complement, &type.spacing_gain, &type.noise})
    values->setZero(nodes());
  const auto delay = static_cast<double>(vehicle.vehicle().link.delay);
  for (Eigen::Index k = 0; k < nodes(); ++k) {
    check_interruption();
    const double w = node_(k);
    const LinkedVehicleValue plain = vehicle.plain().at(w);
    DoubleComplex mean = plain.undelayed * std::polar(1.0, -std::remainder(delay * w, 2.0 * pi));  // H T^
    type.own(k) = plain.gain;
    type.spacing_gain(k) = plain.spacing_gain;
    type.noise(k) = plain.input[0].noise;
    type.passed(k) = 1.0;
    missing(k) = plain.margin;
    if (losses) {
      mean *= losses->passed(k);
      type.passed(k) = std::norm(losses->passed(k));
      missing(k) += plain.gain * losses->margin(k);
    }
    whole(k) = type.own(k) * type.passed(k);
    type.complement(k) = std::norm(1.0 - mean);
  }
  gain.push_back(std::move(whole));
  margin.push_back(std::move(missing));
  type.losses = std::move(losses);
  types_.push_back(std::move(type));
}

Eigen::ArrayXd BurstSpectra::scattered(std::size_t follower, const Eigen::ArrayXd& spectrum) const {
  const Type& type = of(follower);
  if (!type.losses) return Eigen::ArrayXd::Zero(nodes());
  return (*type.losses)((type.losses->surprise * spectrum).matrix());
}

Eigen::ArrayXd BurstSpectra::added(std::size_t follower, double speed) const {
  const Type& type = of(follower);
  Eigen::ArrayXd sum = type.passed * type.noise;
  if (type.losses) sum += scattered(follower, type.noise) + speed * speed * type.losses->moving;
  return type.own * sum;
}

}  // namespace platoon
