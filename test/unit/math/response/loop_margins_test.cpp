#include "stochastic_platoon/math/response/loop_margins.hpp"

#include <gtest/gtest.h>

#include "unit/math/radio_cars.hpp"
#include "unit/math/sampled_car.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// The margins of a loop L(w) by a fine grid and bisection.
template <class Loop>
LoopMargins margins_on_a_grid(const Loop& loop) {
  constexpr int kPlaces = 200000;
  LoopMargins found{180.0, 1e300, 0.0, 0.0};
  const auto excess = [&](double w) { return std::abs(loop(w)) - 1.0; };
  for (int k = 1; k < kPlaces; ++k) {
    double from = kPi * k / kPlaces, to = kPi * (k + 1) / kPlaces;
    const double sensitivity = 1.0 / std::abs(1.0 + loop(from));
    if (sensitivity > found.sensitivity_peak) {
      found.sensitivity_peak = sensitivity;
      found.peak_frequency = from;
    }
    const bool falls = excess(from) > 0.0;
    if (falls == (excess(to) > 0.0)) continue;
    for (int i = 0; i < 60; ++i) ((excess(0.5 * (from + to)) > 0.0) == falls ? from : to) = 0.5 * (from + to);
    const double lag = std::arg(-loop(from));
    found.phase = std::min(found.phase, std::abs(lag) * 180.0 / kPi);
    found.delay = std::min(found.delay, (lag > 0.0 ? lag : lag + 2.0 * kPi) / from);
  }
  return found;
}

void expect_same(const LoopMargins& found, const LoopMargins& expected) {
  EXPECT_NEAR(found.phase, expected.phase, 1e-8 * expected.phase);
  EXPECT_NEAR(found.delay, expected.delay, 1e-8 * expected.delay);
  EXPECT_NEAR(found.sensitivity_peak, expected.sensitivity_peak, 1e-7);  // the grid misses the peak by its curvature
  EXPECT_NEAR(found.peak_frequency, expected.peak_frequency, 1e-3);
}

TEST(LoopMargins, OfSampledCarsAreThoseOfTheirFrequencyResponse) {
  for (const double delay : {0.0, 0.05, 0.2}) {
    const PlatoonModel model = radio_platoon(0.5, 0.01, 0.01, 2, delay);
    const SampledCar car{0.1, 0.01, 0.2, 0.7, delay / 0.01};
    const std::optional<LoopMargins> found = loop_margins(model);
    ASSERT_TRUE(found.has_value());
    expect_same(*found, margins_on_a_grid([&car](double w) { return car.loop(w); }));
  }
}

TEST(LoopMargins, OfThePapersLoopContainTheSpacingPolicy) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().design = paper_design();
  const auto loop = [](double w) {
    const std::complex<double> z = std::polar(1.0, w);
    return 1.35 / 4.2 * z / (z + 0.89) / ((z - 1.0) * (z - 1.0)) * (4.2 - 3.2 / z);
  };
  expect_same(*loop_margins(model), margins_on_a_grid(loop));
}

TEST(LoopMargins, SeparateStableFromUnstableDelays) {
  const auto car = [](double further) {
    LoopDesign design{{car_with_actuator_lag(0.1, 0.05 + 0.01 * further), 0.01},
                      {ControllerGains{1.0, 3.0, 0.0}, 0.01}};
    design.headway_filter = true;
    VehicleModel vehicle(close_loop(design, 50.0), 50.0);
    vehicle.design = design;
    return vehicle;
  };
  const double delay = loop_margins(car(0.0))->delay;
  EXPECT_LT(delay, 90.0);
  EXPECT_LT(spectral_radius(car(std::floor(delay)).loop), 1.0);
  EXPECT_GT(spectral_radius(car(std::floor(delay) + 1.0).loop), 1.0);
}

TEST(LoopMargins, DoNotExistForAGivenOrAnUnstableLoop) {
  EXPECT_FALSE(loop_margins(paper_platoon()).has_value());
  PlatoonModel unstable = paper_platoon(0.3);
  unstable.default_vehicle().design = paper_design();
  unstable.default_vehicle().loop = close_loop(paper_design(), 0.3);
  EXPECT_FALSE(loop_margins(unstable).has_value());
}

TEST(LoopMargins, OfAStringAreTheWorstOfItsVehicles) {
  PlatoonModel model = radio_platoon(0.5, 0.01, 0.01);
  add_trucks(model, 0.3, 0.1);
  const LoopMargins found = *loop_margins(model);
  double phase = 180.0, delay = 1e300, peak = 0.0;
  for (const VehicleType& type : model.types) {
    const LoopMargins own = *loop_margins(type.vehicle);
    phase = std::min(phase, own.phase);
    delay = std::min(delay, own.delay);
    peak = std::max(peak, own.sensitivity_peak);
  }
  EXPECT_EQ(found.phase, phase);
  EXPECT_EQ(found.delay, delay);
  EXPECT_EQ(found.sensitivity_peak, peak);
  EXPECT_LT(peak, loop_margins(model)->sensitivity_peak + 1e-15);
}

}  // namespace
}  // namespace platoon
