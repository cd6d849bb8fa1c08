#pragma once

#include <cstdint>

#include "stochastic_platoon/math/model/vehicle_limits.hpp"

namespace platoon {

/// What the manoeuvres of a leader are within its limits, for those who order them.
struct ManoeuvreBounds {
  Interval speed;                ///< [m/s] that the leader reaches
  Interval acceleration;         ///< [m/s^2] to another speed; infinite: at once
  double braking;                ///< [m/s^2] > 0 of brake()
  double speed_up, speed_added;  ///< of accelerate() [m/s^2], [m/s]
  Interval back;                 ///< [m/s^2] of cruise()
  double amplitude, seconds;     ///< [m/s] and period [s] of swing()
};

/// A manual manoeuvre of the virtual leader: a speed v(k) that replaces the profile's, r_0(k+1) = r_0(k) + T_s v(k). A
/// manoeuvre starts at the speed of the previous step and replaces the active one.
class Manoeuvre {
public:
  static constexpr double kBraking = 4.0;         ///< [m/s^2]
  static constexpr double kAcceleration = 2.0;    ///< [m/s^2]
  static constexpr double kSpeedIncrease = 10.0;  ///< [m/s] added by accelerate()
  static constexpr double kAmplitude = 2.0;       ///< [m/s] of the sinusoid
  static constexpr std::int64_t kPeriod = 10;     ///< [steps], at which the paper's string amplifies most for h = 2.4
  static constexpr double kSeconds = 10.0;        ///< [s], period of the sinusoid of a vehicle with limits
  static constexpr double kLargestSpeed = 1e3;    ///< [m/s]

  /// T_s > 0 [s]. Speeds and their changes remain within the limits.
  explicit Manoeuvre(double sample_period, const VehicleLimits& limits = {});

  /// Drives at this speed [m/s] from the next step on. Throws std::invalid_argument unless it is finite and its
  /// magnitude is at most kLargestSpeed.
  void drive_at(double speed);
  /// Brakes with kBraking to standstill.
  void brake();
  /// Accelerates with kAcceleration by kSpeedIncrease. Throws std::invalid_argument if the speed would exceed
  /// kLargestSpeed.
  void accelerate();
  /// Drives at v(k) = v + kAmplitude sin(2 pi n / period), n = 1, 2, ..., with v the present speed, until the next
  /// command. The period is kPeriod, or kSeconds with limits.
  void swing();
  /// Returns to the profile's speed with kAcceleration and then follows the profile.
  void cruise();
  /// Follows the profile at once.
  void end() { kind_ = Kind::none; }

  ManoeuvreBounds bounds() const;

  bool is_under_way() const { return kind_ != Kind::none; }

  /// v of the next step [m/s]; `profile` is the profile's speed [m/s].
  double next_speed(double profile);

private:
  enum class Kind { none, approach, swing, back };
  void approach(double target, double acceleration);

  double limited(double speed) const;

  double sample_period_;
  VehicleLimits limits_;
  std::int64_t period_;  ///< [steps]
  Kind kind_ = Kind::none;
  double speed_ = 0.0;         ///< [m/s], of the previous step
  double target_ = 0.0;        ///< [m/s], to approach, or mean of the sinusoid
  double acceleration_ = 0.0;  ///< [m/s^2] >= 0
  std::int64_t step_ = 0;      ///< of the sinusoid
};

}  // namespace platoon
