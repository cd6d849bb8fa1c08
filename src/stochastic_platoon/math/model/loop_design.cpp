#include "stochastic_platoon/math/model/loop_design.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

void require(bool met, const char* name, double value, const char* allowed) {
  if (!met) throw std::invalid_argument(formatted("%s: %g: must be %s", name, value, allowed));
}

std::shared_ptr<const ExactTransfer> held(const ContinuousPlant& plant, double sample_period) {
  require(sample_period > 0.0 && std::isfinite(sample_period), "sample_period", sample_period, "finite and > 0 [s]");
  require(plant.input_delay >= 0.0 && plant.input_delay <= kLongestInputDelay * sample_period, "input_delay",
          plant.input_delay, "from 0 to 100 sample periods [s]");
  const TransferFunction fraction(plant.numerator, plant.denominator);
  if (!fraction.is_strictly_proper() || fraction.numerator()(0) == 0.0)
    throw std::invalid_argument("continuous plant: must be strictly proper: more poles than zeros, and not zero");
  return std::make_shared<const ExactTransfer>(
      zero_order_hold(trimmed(plant.numerator), trimmed(plant.denominator), plant.input_delay, sample_period));
}

// With z = 1 + s: (kp z s + kd / T_s s^2 + ki T_s z^2) / (z s), without the factor s if ki = 0 and without z if kd = 0.
std::shared_ptr<const ExactTransfer> of_gains(const ControllerGains& gains, double sample_period) {
  require(sample_period > 0.0 && std::isfinite(sample_period), "sample_period", sample_period, "finite and > 0 [s]");
  for (const double gain : {gains.kp, gains.kd, gains.ki}) require(std::isfinite(gain), "gain", gain, "finite");
  if (gains.kp == 0.0 && gains.kd == 0.0 && gains.ki == 0.0)
    throw std::invalid_argument("kp, kd, ki: all 0: at least one must differ from 0");
  const Exact kp = gains.kp, derivative = Exact(gains.kd) / Exact(sample_period),
              integral = Exact(gains.ki) * Exact(sample_period);
  const bool differentiates = gains.kd != 0.0, integrates = gains.ki != 0.0;
  const auto times_s = [&](const ExactPolynomial& p) { return integrates ? multiply(p, {Exact(0), Exact(1)}) : p; };
  const auto times_z = [&](const ExactPolynomial& p) { return times_power_of_z(p, differentiates ? 1 : 0); };
  ExactTransfer transfer{times_z(times_s({kp})), times_s({Exact(1)}), differentiates ? 1 : 0};
  if (differentiates) transfer.numerator = add(transfer.numerator, times_s({Exact(0), derivative}));
  if (integrates) transfer.numerator = add(transfer.numerator, times_z({integral, integral}));
  while (transfer.numerator.size() > 1 && transfer.numerator.back() == 0) transfer.numerator.pop_back();
  return std::make_shared<const ExactTransfer>(transfer);
}

}  // namespace

ContinuousPlant car_with_actuator_lag(double lag, double input_delay) {
  Polynomial denominator = Polynomial::Zero(lag > 0.0 ? 4 : 3);
  if (lag > 0.0) denominator << lag, 1.0, 0.0, 0.0;
  if (lag == 0.0) denominator(0) = 1.0;
  return {Polynomial::Ones(1), denominator, input_delay};
}

std::optional<double> actuator_lag(const ContinuousPlant& plant) {
  const Polynomial &n = plant.numerator, &d = plant.denominator;
  const Eigen::Index order = d.size() - 1;
  const bool integrates_twice = (order == 2 || order == 3) && d(order) == 0.0 && d(order - 1) == 0.0;
  if (!integrates_twice || n.size() != 1 || n(0) != d(order - 2) || !(d(0) / n(0) > 0.0)) return std::nullopt;
  return order == 3 ? d(0) / n(0) : 0.0;
}

SplitDelay split_delay(double input_delay, double sample_period) {
  const double periods = input_delay / sample_period, nearest = std::round(periods);
  if (std::abs(periods - nearest) <= 8.0 * std::numeric_limits<double>::epsilon() * periods) return {nearest, 0.0};
  return {std::floor(periods), std::fma(-std::floor(periods), sample_period, input_delay)};
}

Plant::Plant(const TransferFunction& sampled)
    : given_(sampled), exact_(std::make_shared<const ExactTransfer>(exact_transfer(sampled))) {}

Plant::Plant(const ContinuousPlant& continuous, double sample_period)
    : given_(continuous), exact_(held(continuous, sample_period)) {}

SampledPlant Plant::sampled() const {
  const auto coefficients = [](const ExactPolynomial& p, std::ptrdiff_t powers) {
    return rounded(shifted_to_origin(times_power_of_z(p, powers)));
  };
  return {coefficients(exact_->numerator, -exact_->delay), coefficients(exact_->denominator, exact_->delay)};
}

int Plant::integrators() const {
  return exact_->integrators();
}

bool Plant::operator==(const Plant& other) const {
  return exact_ == other.exact_ ||
         (exact_->delay == other.exact_->delay && exact_->numerator == other.exact_->numerator &&
          exact_->denominator == other.exact_->denominator);
}

Controller::Controller(const TransferFunction& sampled)
    : given_(sampled), exact_(std::make_shared<const ExactTransfer>(exact_transfer(sampled))) {}

Controller::Controller(const ControllerGains& gains, double sample_period)
    : given_(gains), sample_period_(sample_period), exact_(of_gains(gains, sample_period)) {}

double Controller::gain() const {
  if (const auto* gains = std::get_if<ControllerGains>(&given_)) return gains->kp;
  return std::get<TransferFunction>(given_).numerator()(0);
}

Controller Controller::with_gain(double gain) const {
  const double present = this->gain();
  require(present != 0.0, "gain of the controller", present, "other than 0 to vary it");
  const double factor = gain / present;
  if (const auto* gains = std::get_if<ControllerGains>(&given_))
    return {ControllerGains{gain, factor * gains->kd, factor * gains->ki}, sample_period_};
  const TransferFunction& sampled = std::get<TransferFunction>(given_);
  return TransferFunction{sampled.numerator() * factor, sampled.denominator()};
}

bool is_by_parts(const LoopDesign& design) {
  return design.headway_filter || design.sends_input || std::holds_alternative<ContinuousPlant>(design.plant.given()) ||
         std::holds_alternative<ControllerGains>(design.controller.given());
}

}  // namespace platoon
