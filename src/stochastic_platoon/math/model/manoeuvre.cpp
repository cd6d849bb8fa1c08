#include "stochastic_platoon/math/model/manoeuvre.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

using boost::math::double_constants::pi;

void require_speed(double speed) {
  if (std::abs(speed) <= Manoeuvre::kLargestSpeed) return;  // false for NaN
  throw std::invalid_argument(formatted("leader speed: %g: must be a finite number of magnitude %g at most [m/s]",
                                        speed, Manoeuvre::kLargestSpeed));
}

double moved(double from, double to, double most) {
  return from + std::clamp(to - from, -most, most);
}

}  // namespace

Manoeuvre::Manoeuvre(double sample_period, const VehicleLimits& limits)
    : sample_period_(sample_period),
      limits_(limits),
      period_(limits.any() ? std::max(kPeriod, static_cast<std::int64_t>(kSeconds / sample_period)) : kPeriod) {}

ManoeuvreBounds Manoeuvre::bounds() const {
  const Interval input = limits_.input.value_or(Interval{});
  const double braking = std::min(kBraking, -input.lower), speed_up = std::min(kAcceleration, input.upper);
  return {limits_.speed.value_or(Interval{-kLargestSpeed, kLargestSpeed}),
          input,
          braking,
          speed_up,
          kSpeedIncrease,
          {-std::min(kAcceleration, -input.lower), speed_up},
          kAmplitude,
          static_cast<double>(period_) * sample_period_};
}

void Manoeuvre::approach(double target, double acceleration) {
  require_speed(target);
  kind_ = Kind::approach;
  target_ = target;
  acceleration_ = acceleration;
}

void Manoeuvre::drive_at(double speed) {
  approach(speed, std::numeric_limits<double>::infinity());
}

void Manoeuvre::brake() {
  approach(0.0, kBraking);
}

void Manoeuvre::accelerate() {
  approach(speed_ + kSpeedIncrease, kAcceleration);
}

void Manoeuvre::swing() {
  kind_ = Kind::swing;
  target_ = speed_;
  step_ = 0;
}

void Manoeuvre::cruise() {
  if (kind_ != Kind::none) kind_ = Kind::back;
}

// Within reach of the present speed, which a drive may have taken beyond the limits.
double Manoeuvre::limited(double speed) const {
  if (limits_.speed) speed = std::clamp(speed, limits_.speed->lower, limits_.speed->upper);
  if (!limits_.input) return speed;
  return speed_ +
         std::clamp(speed - speed_, limits_.input->lower * sample_period_, limits_.input->upper * sample_period_);
}

double Manoeuvre::next_speed(double profile) {
  switch (kind_) {
    case Kind::none:
      speed_ = profile;
      break;
    case Kind::approach:
      speed_ = limited(moved(speed_, target_, acceleration_ * sample_period_));
      break;
    case Kind::swing:
      step_ = (step_ + 1) % period_;
      speed_ = limited(target_ +
                       kAmplitude * std::sin(2.0 * pi * static_cast<double>(step_) / static_cast<double>(period_)));
      break;
    case Kind::back:
      speed_ = limited(moved(speed_, profile, kAcceleration * sample_period_));
      if (speed_ == profile) kind_ = Kind::none;
      break;
  }
  return speed_;
}

}  // namespace platoon
