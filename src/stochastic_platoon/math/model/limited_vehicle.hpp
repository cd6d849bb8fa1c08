#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/loop_batch.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// A car with an actuator lag lambda whose control input u is held over a sample, by its position y, speed v and
/// acceleration a. Over an interval t of constant u, with e = exp(-t / lambda) and e = 0 for lambda = 0,
///
///     y += v t + u t^2 / 2 + (a - u) lambda (t - lambda (1 - e)),   v += u t + (a - u) lambda (1 - e),
///     a = e a + (1 - e) u.
///
/// If v is beyond its limits at the end of a sample, it is set to the limit and y moves by T_s times the mean of the
/// speeds at the ends of the sample; a stays. An input delay of d + f sample periods, 0 <= f < 1, divides the sample: u
/// changes after f T_s. See ContinuousPlant and Plant.
class HeldCar {
public:
  /// Throws std::invalid_argument unless the plant has an actuator_lag().
  HeldCar(const ContinuousPlant& plant, const Interval& speed_limits, double sample_period);

  /// An interval t of constant input.
  struct Held {
    double t, half_square;   ///< t, t^2 / 2
    double e;                ///< exp(-t / lambda)
    double speed, position;  ///< lambda (1 - e), lambda (t - lambda (1 - e))
  };
  const std::optional<Held>& early() const { return early_; }  ///< f T_s; none for a delay of whole steps
  const Held& late() const { return late_; }
  const Interval& speed_limits() const { return speed_limits_; }  ///< [m/s]
  double sample_period() const { return sample_period_; }         ///< [s]

  /// States: y, v, a and, with a divided sample, the input before.
  std::size_t order() const { return early_ ? 4 : 3; }
  std::vector<double> equilibrium() const;  ///< states of y = 1 at rest
  std::vector<double> ramp() const;         ///< states of y = k at k = 0

private:
  double sample_period_;
  Interval speed_limits_;
  std::optional<Held> early_;
  Held late_;
};

/// The actuator lag of a design [s]; none for other plants, which have no speed in their state.
std::optional<double> actuator_lag(const LoopDesign& design);

/// The batch computation of a vehicle: loop_batch() without limits. With limits on its input, the controller's
/// difference equation D(z) u = N(z) e (headway filter included) runs on the limited past inputs, so that no part of it
/// winds up; the limited input enters the delay of the plant, and is sent. T_s > 0 [s]. `spacing`: the
/// spacing_in_vehicles() of a vehicle by parts.
///
/// Throws std::invalid_argument if the loop has no equilibrium, for limits of a vehicle that was not given by plant and
/// controller, for speed limits without an actuator_lag(), and for limits that exclude 0.
std::unique_ptr<LoopBatch> vehicle_batch(const VehicleModel& vehicle, double sample_period, double spacing = 1.0);

}  // namespace platoon
