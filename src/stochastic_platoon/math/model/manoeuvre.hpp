#pragma once

#include <cstdint>

namespace platoon {

/// What the virtual leader is told while it drives: a speed v(k) in place of its profile's, r_0(k+1) = r_0(k) + T_s
/// v(k). A manoeuvre begins at the speed of the step before and takes the place of the one under way.
class Manoeuvre {
public:
  static constexpr double kBraking = 4.0;         ///< [m/s^2]
  static constexpr double kAcceleration = 2.0;    ///< [m/s^2]
  static constexpr double kSpeedIncrease = 10.0;  ///< [m/s] that accelerate() adds
  static constexpr double kAmplitude = 2.0;       ///< [m/s] of the sinusoid
  static constexpr std::int64_t kPeriod = 10;     ///< steps: where the paper's string amplifies most at h = 2.4
  static constexpr double kLargestSpeed = 1e3;    ///< [m/s]

  /// T_s > 0 [s].
  explicit Manoeuvre(double sample_period) : sample_period_(sample_period) {}

  /// From the next step on this speed [m/s]. Throws std::invalid_argument unless it is finite and its magnitude at
  /// most kLargestSpeed.
  void drive_at(double speed);
  /// Slower by kBraking until it stands.
  void brake();
  /// Faster by kAcceleration until kSpeedIncrease is reached. Throws std::invalid_argument beyond kLargestSpeed.
  void accelerate();
  /// v(k) = v + kAmplitude sin(2 pi n / kPeriod), n = 1, 2, ... and v the present speed, until it is told otherwise.
  void swing();
  /// By kAcceleration back to the profile's speed, and then with the profile.
  void cruise();
  /// With the profile at once.
  void end() { kind_ = Kind::none; }

  bool is_under_way() const { return kind_ != Kind::none; }

  /// v of the next step [m/s], where the profile's is this one.
  double next_speed(double profile);

private:
  enum class Kind { none, approach, swing, back };
  void approach(double target, double acceleration);

  double sample_period_;
  Kind kind_ = Kind::none;
  double speed_ = 0.0;         ///< [m/s] of the step before
  double target_ = 0.0;        ///< [m/s] approached, or in the middle of the sinusoid
  double acceleration_ = 0.0;  ///< [m/s^2] >= 0
  std::int64_t step_ = 0;      ///< of the sinusoid
};

}  // namespace platoon
