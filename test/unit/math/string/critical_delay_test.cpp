#include "stochastic_platoon/math/string/critical_delay.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/math/sampled_car.hpp"

namespace platoon {
namespace {

/// Plexe's Ploeg at a headway of 0.5 s: lag 0.5 s, kp 0.2, kd 0.7.
constexpr SampledCar kPloeg{0.5, 0.01, 0.2, 0.7, 0.0};

PlatoonModel ploeg(std::int64_t radio_delay = 2) {
  return radio_platoon_of({{car_with_actuator_lag(0.5, 0.0), 0.01}, {ControllerGains{0.2, 0.7, 0.0}, 0.01}}, 50.0, 0.01,
                          0.01, radio_delay, 0.01);
}

/// The largest |T^| over w > 0 at a radio delay of any real number of steps.
double peak_at(const SampledCar& car, double headway, double delay) {
  double peak = 0.0;
  for (int k = 1; k <= 100000; ++k) {
    const double w = 0.05 * k / 100000;
    const std::complex<double> loop = car.loop(w), policy = 1.0 + headway - headway * std::polar(1.0, -w);
    peak = std::max(peak, std::abs((loop + std::polar(1.0, -delay * w)) / (policy * (1.0 + loop))));
  }
  return peak;
}

TEST(CriticalDelay, SeparatesStableFromUnstableRealDelays) {
  const double found = *critical_delay(ploeg()).steps;
  EXPECT_NEAR(found, 6.983879, 1e-5);  // 0.0698 s
  EXPECT_LE(peak_at(kPloeg, 50.0, found * (1.0 - 1e-3)), 1.0);
  EXPECT_GT(peak_at(kPloeg, 50.0, found * (1.0 + 1e-3)), 1.0);
}

TEST(CriticalDelay, AgreesWithTheVerdictsAtWholeDelays) {
  for (const double input_delay : {0.0, 0.2}) {
    for (const double headway : {0.4, 0.5, 0.8}) {
      const double found = *critical_delay(radio_platoon(headway, 0.01, 0.01, 2, input_delay)).steps;
      for (const double delay : {1.0, std::floor(found), std::floor(found) + 1.0}) {
        const PlatoonModel model = radio_platoon(headway, 0.01, 0.01, static_cast<std::int64_t>(delay), input_delay);
        EXPECT_EQ(string_stability(model).string_stable, delay <= found) << headway << " s, " << delay;
      }
    }
  }
}

TEST(CriticalDelay, DoesNotDependOnTheDelayOfTheModel) {
  EXPECT_EQ(*critical_delay(ploeg(2)).steps, *critical_delay(ploeg(40)).steps);
}

TEST(CriticalDelay, SaysWhyThereIsNone) {
  PlatoonModel model = ploeg();
  lose_inputs(model, 0.1, {1.0});
  EXPECT_EQ(critical_delay(model).reason, "a link loses messages");
  model = ploeg();
  model.default_vehicle().inputs.resize(1);
  EXPECT_EQ(critical_delay(model).reason, "there is no radio");
  EXPECT_EQ(critical_delay(radio_platoon(0.1, 0.01, 0.01)).reason, "the string is not stable at a delay of one step");
  EXPECT_EQ(critical_delay(radio_platoon(20.0, 0.01, 0.01)).reason,
            "the string is stable at every delay up to 10000 steps");
  for (const PlatoonModel& without : {model, radio_platoon(20.0, 0.01, 0.01)})
    EXPECT_FALSE(critical_delay(without).steps.has_value());
}

}  // namespace
}  // namespace platoon
