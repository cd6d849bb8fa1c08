#include "stochastic_platoon/math/model/signal.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "unit/messages.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

Signal error_with(double headway, double standstill_distance) {
  PlatoonModel model = paper_platoon(headway);
  model.default_vehicle().standstill_distance = standstill_distance;
  return tracking_error(model, 1);
}

TEST(TrackingError, FollowsItsFormula) {
  const Signal zeta = error_with(3.0, 2.0);
  EXPECT_EQ(zeta({30.0}, {20.0, 18.5}), 30.0 - 20.0 - 2.0 - 3.0 * 1.5);
}

TEST(TrackingError, VanishesInFormation) {
  const Signal zeta = error_with(2.5, 7.0);
  EXPECT_EQ(zeta({-7.0}, {-14.0, -14.0}), 0.0);
  const double displacement = 2.0;  // [m] per step, driven by both
  EXPECT_EQ(zeta({100.0}, {100.0 - 7.0 - 2.5 * displacement, 100.0 - 7.0 - 3.5 * displacement}), 0.0);
}

PlatoonModel car_behind_truck() {
  PlatoonModel model = paper_platoon();
  model.sample_period = 0.5;
  model.types.push_back({"truck", model.default_vehicle(), {}});
  model.types[1].vehicle.length = 12.0;
  model.string = {1, 0};
  return model;
}

double value_of(const char* name, std::size_t follower, const Signal::Recent<double>& ahead,
                const Signal::Recent<double>& own) {
  return signals_of(car_behind_truck(), {name}, follower).requested.front()(ahead, own);
}

TEST(Signal, OfAGapEndsAtTheRearOfThePredecessor) {
  EXPECT_EQ(value_of("gap", 1, {30.0}, {10.0}), 20.0) << "the leader has the default length, which is 0";
  EXPECT_EQ(value_of("gap", 2, {30.0}, {10.0}), 8.0);
}

TEST(Signal, HasSpeedAccelerationAndJerkOfAThirdPower) {
  const auto y = [](double t) { return 2.0 + 3.0 * t + 5.0 * t * t + 7.0 * t * t * t; };  // [m], at T_s = 0.5 s
  const Signal::Recent<double> own{y(2.0), y(1.5), y(1.0), y(0.5)};
  EXPECT_EQ(value_of("speed", 1, {}, own), (y(2.0) - y(1.5)) / 0.5);
  EXPECT_EQ(value_of("acceleration", 1, {}, own), 10.0 + 42.0 * 1.5);
  EXPECT_EQ(value_of("jerk", 1, {}, own), 42.0);
}

TEST(Signal, OfARelativeSpeedIsThatAtWhichTheGapGrows) {
  EXPECT_EQ(value_of("relative_speed", 2, {30.0, 27.0}, {10.0, 9.0}), (3.0 - 1.0) / 0.5);
}

// Distance and position may have any term each.
TEST(Signal, HasTermsOfAnyOrder) {
  const Signal signal{{2.0, 2}, 0.25, {-3.0, 3}};
  const Signal::Recent<double> ahead{9.0, 5.0, 4.0, 1.0}, own{1.0, 3.0, 2.0, 8.0};
  const double apart = (8.0 - 2.0) - (2.0 - 2.0), third = ((1.0 - 3.0) - (3.0 - 2.0)) - ((3.0 - 2.0) - (2.0 - 8.0));
  EXPECT_EQ(signal.order(), 3);
  EXPECT_EQ(signal(ahead, own), 2.0 * apart - 0.25 - 3.0 * third);
}

TEST(Signal, HasTheSameValuesOneByOneAndInABatch) {
  const std::vector<double> predecessor = {1.1, 2.3, -3.7}, own = {0.3, 0.1, 9.2}, one = {0.2, -0.6, 8.8},
                            two = {0.1, 0.7, 8.1}, three = {-1.0, 0.4, 7.0};
  const FollowerSignals signals =
      signals_of(car_behind_truck(), {"gap", "speed", "acceleration", "jerk", "relative_speed"}, 2);
  std::vector<Signal> all = signals.requested;
  all.push_back(signals.error);
  for (const Signal& signal : all) {
    std::vector<double> values(3);
    signal({predecessor.data(), two.data()}, {own.data(), one.data(), two.data(), three.data()}, 3, values.data());
    for (std::size_t r = 0; r < 3; ++r)
      EXPECT_EQ(values[r], signal({predecessor[r], two[r]}, {own[r], one[r], two[r], three[r]}));
  }
}

TEST(Signal, RejectsAnUnknownName) {
  EXPECT_THROW(signals_of(car_behind_truck(), {"distance"}, 1), std::invalid_argument);
  EXPECT_THROW(unit_of("distance"), std::invalid_argument);
}

TEST(Signal, HasAUnit) {
  EXPECT_STREQ(unit_of("gap"), "m");
  EXPECT_STREQ(unit_of("jerk"), "m/s^3");
}

TEST(SignalNames, AreSorted) {
  EXPECT_EQ(signal_names("jerk,gap,speed"), (std::vector<std::string>{"gap", "speed", "jerk"}));
  EXPECT_EQ(signal_names("speed, gap"), (std::vector<std::string>{"gap", "speed"})) << "as the messages list them";
  EXPECT_TRUE(signal_names("").empty());
}

TEST(SignalNames, RejectOtherTexts) {
  for (const std::string text : {"gap,distance", "gap,gap", ",", "gap,", "gap,,speed", " ", "Gap"}) {
    EXPECT_EQ(
        message_of<std::invalid_argument>([&text] { signal_names(text); }),
        "signals: " + text +
            ": must be some of gap, speed, acceleration, jerk, input, relative_speed, each once, separated by commas");
  }
}

}  // namespace
}  // namespace platoon
