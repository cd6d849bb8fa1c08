#include "stochastic_platoon/math/model/limited_vehicle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/model/part_lanes.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

HeldCar::Held held(double t, double lag) {
  const double rest = lag > 0.0 ? -std::expm1(-t / lag) : 1.0;  // 1 - e
  return {t, 0.5 * t * t, 1.0 - rest, lag * rest, lag * (t - lag * rest)};
}

const Interval& checked(const char* name, const Interval& limits) {
  if (limits.lower < limits.upper && limits.contains(0.0)) return limits;
  throw std::invalid_argument(formatted("limits of %s: [%g, %g]: must be [lower, upper] with lower <= 0 <= upper", name,
                                        limits.lower, limits.upper));
}

}  // namespace

HeldCar::HeldCar(const ContinuousPlant& plant, const Interval& speed_limits, double sample_period)
    : sample_period_(sample_period), speed_limits_(speed_limits) {
  const std::optional<double> lag = actuator_lag(plant);
  if (!lag) throw std::invalid_argument("limits of speed: given: must be absent for a plant without actuator_lag");
  const double fraction = split_delay(plant.input_delay, sample_period).fraction;
  if (fraction > 0.0) early_ = held(fraction, *lag);
  late_ = held(sample_period - fraction, *lag);
}

std::vector<double> HeldCar::equilibrium() const {
  std::vector<double> state(order(), 0.0);
  state[0] = 1.0;
  return state;
}

std::vector<double> HeldCar::ramp() const {
  std::vector<double> state(order(), 0.0);
  state[1] = 1.0 / sample_period_;
  return state;
}

namespace detail {

PLATOON_INLINE void hold(const HeldCar::Held& held, double u, double& y, double& v, double& a) {
  const double excess = a - u;
  y += v * held.t + (u * held.half_square + excess * held.position);
  v += u * held.t + excess * held.speed;
  a = u + held.e * excess;
}

/// A HeldCar as plant of parts_lanes().
struct CarPlant {
  const HeldCar& car;

  std::size_t order() const { return car.order(); }
  PLATOON_INLINE void advance(std::size_t lanes, const double*, const double* u, double* state) const {
    if (car.early()) return advance<true>(lanes, u, state);
    advance<false>(lanes, u, state);
  }

  template <bool kDivided>
  PLATOON_INLINE void advance(std::size_t lanes, const double* u, double* state) const {
    const HeldCar::Held late = car.late(), early = kDivided ? *car.early() : late;
    const Interval limits = car.speed_limits();
    const double half_period = 0.5 * car.sample_period();
    for (std::size_t r = 0; r < lanes; ++r) {
      double *const x = state + r, y = x[0], v = x[kTile], a = x[2 * kTile];
      const double from = y, before = v;
      if (kDivided) {
        hold(early, x[3 * kTile], y, v, a);
        x[3 * kTile] = u[r];
      }
      hold(late, u[r], y, v, a);
      const double limited = v < limits.lower ? limits.lower : v > limits.upper ? limits.upper : v;
      x[0] = limited == v ? y : from + half_period * (before + limited);
      x[kTile] = limited;
      x[2 * kTile] = a;
    }
  }
};

/// Limits of the input. The controller's state forgets the part of its output beyond them: `regained` has what a unit
/// of it adds to each state, the coefficients of z^n - D by powers of z - 1.
struct InputLimits {
  Interval limits;
  const std::vector<double>& regained;

  PLATOON_INLINE void clip(const LoopParts& parts, std::size_t lanes, double* u, double* controller) const {
    std::array<double, kPartLanes> clipped;
    const double lower = limits.lower, upper = limits.upper;
    const double factor = parts.headway_filter ? 1.0 + parts.headway : 1.0;
    for (std::size_t r = 0; r < lanes; ++r) {
      const double limited = u[r] < lower ? lower : u[r] > upper ? upper : u[r];
      clipped[r] = factor * (limited - u[r]);
      u[r] = limited;
    }
    for (std::size_t j = 0; j < regained.size(); ++j) {
      const double share = regained[j];
      if (share == 0.0) continue;
      for (std::size_t r = 0; r < lanes; ++r) controller[j * kTile + r] += share * clipped[r];
    }
  }
};

PLATOON_VECTOR_CLONES
void limited_plant_tile(const LoopParts& parts, const InputLimits& limits, std::size_t place, std::size_t size,
                        double* state, const double* input, double offset, double* positions,
                        const ControlInputs& control) {
  step_lanes(parts, FilteredPlant{parts.plant}, limits, place, size, state, input, offset, positions, control);
}

PLATOON_VECTOR_CLONES
void limited_car_tile(const LoopParts& parts, const HeldCar& car, const InputLimits& limits, std::size_t place,
                      std::size_t size, double* state, const double* input, double offset, double* positions,
                      const ControlInputs& control) {
  step_lanes(parts, CarPlant{car}, limits, place, size, state, input, offset, positions, control);
}

}  // namespace detail

namespace {

// The states of the parts with those of a car in place of the plant's, if there is one.
std::vector<double> with_car(std::vector<double> state, const LoopParts& parts, const std::optional<HeldCar>& car,
                             const std::vector<double>& states_of_car) {
  if (!car) return state;
  state.erase(state.begin(), state.begin() + static_cast<std::ptrdiff_t>(parts.plant.order()));
  state.insert(state.begin(), states_of_car.begin(), states_of_car.end());
  return state;
}

// z^n = (1 + s)^n minus D, by falling powers of s from s^(n-1).
std::vector<double> forgotten(const BasicDeltaFilter<double>& controller) {
  std::vector<double> coefficients;
  const auto n = static_cast<double>(controller.order());
  double binomial = 1.0;
  for (std::size_t j = 0; j < controller.order(); ++j) {
    binomial *= (n - static_cast<double>(j)) / static_cast<double>(j + 1);
    coefficients.push_back(binomial - controller.a[j]);
  }
  return coefficients;
}

/// A vehicle by parts with limits.
class LimitedVehicleBatch : public LoopBatch {
public:
  LimitedVehicleBatch(const LoopParts& parts, std::optional<HeldCar> car, const Interval& input_limits)
      : LoopBatch(
            with_car(unit_equilibrium(parts), parts, car, car ? car->equilibrium() : std::vector<double>()),
            with_car(in_ring_order(parts, unit_ramp(parts)), parts, car, car ? car->ramp() : std::vector<double>()),
            std::max<std::size_t>(parts.delay, 1)),
        parts_(parts),
        car_(std::move(car)),
        regained_(forgotten(parts.controller)),
        limits_{input_limits, regained_} {}

private:
  void step_tile(double* state, std::size_t size, const double* input, double offset, double* positions,
                 const ControlInputs& control) override {
    if (car_)
      return detail::limited_car_tile(parts_, *car_, limits_, place(), size, state, input, offset, positions, control);
    detail::limited_plant_tile(parts_, limits_, place(), size, state, input, offset, positions, control);
  }
  void output_tile(const double* state, std::size_t size, double* positions) const override {
    std::copy_n(state, size, positions);
  }

  LoopParts parts_;
  std::optional<HeldCar> car_;
  std::vector<double> regained_;
  detail::InputLimits limits_;
};

}  // namespace

std::optional<double> actuator_lag(const LoopDesign& design) {
  const auto* continuous = std::get_if<ContinuousPlant>(&design.plant.given());
  return continuous == nullptr ? std::nullopt : actuator_lag(*continuous);
}

std::unique_ptr<LoopBatch> vehicle_batch(const VehicleModel& vehicle, double sample_period, double spacing) {
  const VehicleLimits& limits = vehicle.limits;
  if (!limits.any() && spacing == 1.0) return loop_batch(vehicle.loop);
  if (!vehicle.design)
    throw std::invalid_argument("limits: given: must be absent for a vehicle without plant and controller");
  LoopParts parts = loop_parts<double>(*vehicle.design, vehicle.headway);
  parts.spacing *= spacing;
  if (!limits.any()) return std::make_unique<LoopPartsBatch>(parts);
  const Interval input = limits.input ? checked("input", *limits.input) : Interval();
  const Interval speed = limits.speed ? checked("speed", *limits.speed) : Interval();
  std::optional<HeldCar> car;
  if (limits.speed || actuator_lag(*vehicle.design)) {
    const auto* plant = std::get_if<ContinuousPlant>(&vehicle.design->plant.given());
    car.emplace(plant == nullptr ? ContinuousPlant() : *plant, speed, sample_period);
  }
  return std::make_unique<LimitedVehicleBatch>(parts, std::move(car), input);
}

}  // namespace platoon
