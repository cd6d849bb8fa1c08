#include "stochastic_platoon/math/model/limited_vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/simulation/trajectory.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

constexpr double kPeriod = 0.05;

VehicleModel car(double lag, double input_delay, const ControllerGains& gains, bool headway_filter) {
  LoopDesign design{{car_with_actuator_lag(lag, input_delay), kPeriod}, {gains, kPeriod}};
  design.headway_filter = headway_filter;
  design.sends_input = true;
  VehicleModel vehicle(close_loop(design, 30.0), 30.0);
  vehicle.design = design;
  vehicle.standstill_distance = 3.0;
  vehicle.position().noise_variance = 0.01;
  return vehicle;
}

std::vector<Trajectory> trajectories(const PlatoonModel& model, std::int64_t steps) {
  std::vector<Trajectory> all;
  for_each_trajectory(model, 1, 4, steps, 2, {"acceleration"}, [&](const Trajectory& of) { all.push_back(of); });
  return all;
}

PlatoonModel behind_a_stop(const VehicleModel& vehicle) {
  return {vehicle, LeaderProfile({{0, 20.0}, {40, 18.0}, {60, 0.0}}, kPeriod), kPeriod};
}

TEST(LimitedVehicle, IsTheLinearOneWithinItsLimits) {
  int compared = 0;
  for (const double delay : {0.0, 0.1, 0.13}) {
    for (const double lag : {0.0, 0.3}) {
      for (const ControllerGains& gains : {ControllerGains{0.4, 0.9, 0.0}, ControllerGains{0.4, 0.9, 0.02}}) {
        for (const bool filter : {true, false}) {
          PlatoonModel model = behind_a_stop(car(lag, delay, gains, filter));
          if (spectral_radius(model.default_vehicle().loop) >= 1.0) continue;  // rounding grows without bound
          ++compared;
          model.default_vehicle().limits = {Interval{-1e6, 1e6}, Interval{-1e6, 1e6}};
          const std::vector<Trajectory> limited = trajectories(model, 300);
          model.recorded_leader = limited.front().position;
          model.start = Start::steady;
          model.default_vehicle().limits = {};
          const std::vector<Trajectory> linear = trajectories(model, 300);
          for (std::size_t i = 1; i < linear.size(); ++i) {
            for (std::size_t k = 0; k <= 300; ++k)
              ASSERT_NEAR(limited[i].position[k], linear[i].position[k], 1e-8) << delay << " " << lag << " " << i;
          }
        }
      }
    }
  }
  EXPECT_GE(compared, 12);
}

TEST(LimitedVehicle, StaysWithinItsLimits) {
  PlatoonModel model = behind_a_stop(car(0.3, 0.13, {0.4, 0.9, 0.02}, true));
  model.default_vehicle().limits = {Interval{-4.0, 1.5}, Interval{0.0, 21.0}};
  const std::vector<Trajectory> all = trajectories(model, 400);
  double least = 0.0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    for (std::size_t k = 1; k <= 400; ++k) {
      const double moved = all[i].position[k] - all[i].position[k - 1];
      EXPECT_GE(moved, -1e-12);
      EXPECT_LE(moved, 21.0 * kPeriod + 1e-12);
      EXPECT_GE(all[i].input[k], -4.0);
      EXPECT_LE(all[i].input[k], 1.5);
      least = std::min(least, all[i].input[k]);
    }
  }
  EXPECT_EQ(least, -4.0);
}

TEST(LimitedVehicle, RejectsLimitsThatItCannotHave) {
  VehicleModel vehicle = car(0.3, 0.1, {0.4, 0.9, 0.0}, true);
  vehicle.limits.input = Interval{1.0, 2.0};
  EXPECT_THROW(vehicle_batch(vehicle, kPeriod), std::invalid_argument);
  vehicle.limits.input = Interval{-1.0, 2.0};
  EXPECT_NO_THROW(vehicle_batch(vehicle, kPeriod));
  vehicle.design.reset();
  EXPECT_THROW(vehicle_batch(vehicle, kPeriod), std::invalid_argument);
  VehicleModel sampled = paper_platoon().default_vehicle();
  sampled.limits.speed = Interval{0.0, 40.0};
  EXPECT_THROW(vehicle_batch(sampled, kPeriod), std::invalid_argument);
}

// Every way to compute a vehicle: a shift register, matrices, parts, and parts with limits.
TEST(SteadyStart, IsSteadyForEveryVehicle) {
  PlatoonModel paper = paper_platoon(), limited = behind_a_stop(car(0.3, 0.13, {0.4, 0.9, 0.02}, true));
  paper.leader = LeaderProfile({{0, 20.0}}, paper.sample_period);
  PlatoonModel given = paper, radio = radio_platoon(0.5, 0.0, 0.0);
  given.default_vehicle().loop = closed_loop_from(dense_paper_loop());
  given.default_vehicle().design.reset();
  limited.leader = LeaderProfile({{0, 20.0}}, kPeriod);
  limited.default_vehicle().limits = {Interval{-1.0, 1.0}, Interval{0.0, 30.0}};
  for (PlatoonModel* model : {&paper, &given, &radio, &limited}) {
    model->start = Start::steady;
    model->default_vehicle().position().noise_variance = 0.0;
    model->default_vehicle().initial_position = {};
    model->default_vehicle().position().link.delay = 3;
    model->default_vehicle().position().link.loss = LossModel{1e-12, {}, {2.0, -1.0}};
    const std::vector<Trajectory> all = trajectories(*model, 200);
    EXPECT_NEAR(all.front().position[1], 0.0, 1e-12);
    for (std::size_t i = 1; i < all.size(); ++i) {
      for (std::size_t k = 0; k <= 200; ++k) {
        const double apart =
            vehicle(*model, 1).standstill_distance + (vehicle(*model, 1).headway + 3.0) * 20.0 * model->sample_period;
        ASSERT_NEAR(all[i - 1].position[k] - all[i].position[k], apart, 1e-9) << i << " " << k;
      }
      for (const double acceleration : all[i].signals[1]) ASSERT_NEAR(acceleration, 0.0, 1e-6);
    }
  }
}

TEST(LeaderVehicle, OfCarsWithLimitsIsMovedExactlyStopsAndStands) {
  PlatoonModel model = behind_a_stop(car(0.3, 0.1, {0.4, 0.9, 0.0}, true));
  model.default_vehicle().limits = {Interval{-2.5, 1.0}, Interval{0.0, 30.0}};
  LeaderVehicle leader(model);
  EXPECT_NEAR(leader.start(), -20.0 * kPeriod, 1e-14);
  double before = leader.step();
  EXPECT_EQ(before, 0.0);
  leader.manoeuvre().brake();
  double speed = 20.0;
  for (int k = 0; k < 400; ++k) {
    const double position = leader.step(), now = (position - before) / kPeriod;
    ASSERT_GE(now, -1e-9);
    ASSERT_GE((now - speed) / kPeriod, -2.5 - 1e-6);
    before = position;
    speed = now;
  }
  EXPECT_EQ(leader.step(), before);
  EXPECT_NEAR(leader.input(), 0.0, 1e-9);
}

}  // namespace
}  // namespace platoon
