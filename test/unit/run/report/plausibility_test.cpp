#include "stochastic_platoon/run/report/plausibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/messages.hpp"
#include "unit/paper_run.hpp"

namespace platoon {
namespace {

class PlausibilityTest : public testing::Test {
protected:
  PlausibilityTest() { configuration_.model = radio_platoon(0.5, 1e-6, 1e-6); }  // quiet cars with a headway of 0.5 s

  std::vector<std::string> warnings() const { return plausibility_warnings(configuration_); }

  // The only warning, which contains the texts.
  void expect_warning(const std::vector<std::string>& texts) const {
    const std::vector<std::string> found = warnings();
    ASSERT_EQ(found.size(), 1u) << testing::PrintToString(found);
    for (const std::string& text : texts) EXPECT_TRUE(contains(found[0], text)) << found[0];
  }

  VehicleModel& car() { return configuration_.model.default_vehicle(); }

  Configuration configuration_ = paper_run("");
};

TEST_F(PlausibilityTest, CarsHaveNone) {
  EXPECT_TRUE(warnings().empty()) << testing::PrintToString(warnings());
}

TEST_F(PlausibilityTest, AFastLeaderHasOneWithItsSpeedInBothUnits) {
  configuration_.model.leader = LeaderProfile({{0, 20.0}, {50, 60.0}}, 0.01);
  EXPECT_TRUE(warnings().empty()) << "60 m/s is allowed";
  configuration_.model.leader = LeaderProfile({{0, 20.0}, {50, 90.0}}, 0.01);
  expect_warning({"leader: speed of 90 m/s (324 km/h)", "60 m/s"});
}

TEST_F(PlausibilityTest, ARecordedDriveIsJudgedByItsPositions) {
  car().inputs.resize(1);
  configuration_.model.recorded_leader = {0.0, 0.2, 0.4, 1.1};  // the last step at 70 m/s
  const std::vector<std::string> found = warnings();
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(contains(found[0], "leader: speed of 70 m/s"));
}

TEST_F(PlausibilityTest, ARunThatEndsBeforeTheDriveHasOneUnlessItsStepsAreGiven) {
  configuration_.model.recorded_leader.assign(301, 0.0);
  configuration_.run.steps = 100;
  EXPECT_TRUE(warnings().empty());
  configuration_.run.steps_chosen = true;
  expect_warning({formatted("leader: the run ends at %.6g s of a drive of %.6g s: steps 300 run all of it",
                            100.0 * configuration_.model.sample_period, 300.0 * configuration_.model.sample_period)});
  configuration_.run.steps = 300;
  EXPECT_TRUE(warnings().empty());
}

TEST_F(PlausibilityTest, AHeadwayInTheWrongUnitHasOne) {
  car().headway = 320.0 / 0.01;
  EXPECT_TRUE(
      contains(warnings().at(0), "time_headway: 320 s (32000 sample periods of 0.01 s): cars keep 0.05 s to 10 s"));
  car().headway = 4.0;
  EXPECT_TRUE(contains(warnings().at(0), "time_headway: 0.04 s"));
  car().headway = 5.0;
  EXPECT_TRUE(warnings().empty());
}

TEST_F(PlausibilityTest, AStandstillDistanceWithinTheCarAheadHasOne) {
  car().length = 4.5;
  car().standstill_distance = 4.5;
  EXPECT_TRUE(warnings().empty());
  VehicleType truck{"truck", car(), {}};
  truck.vehicle.length = 16.5;
  configuration_.model.types.push_back(truck);
  configuration_.model.string = {1, 0};
  configuration_.run.followers = 1;
  EXPECT_TRUE(warnings().empty()) << "the truck follows the leader, which is a car";
  configuration_.run.followers = 2;
  expect_warning({"standstill_distance: 4.5 m of follower 2: below the 16.5 m of vehicle_length"});
}

TEST_F(PlausibilityTest, TheAccelerationIsThatOfTheWorstStep) {
  configuration_ = paper_run("");
  configuration_.run.followers = 20;
  configuration_.run.steps = 100;
  const std::vector<std::string> found = warnings();
  ASSERT_EQ(found.size(), 2u);
  const SignalMoments acceleration = signal_moments(configuration_.model, {"acceleration"}, 20, 100)[0];
  double largest = 0.0;
  for (std::size_t c = 0; c < acceleration.mean.size(); ++c)
    largest = std::fmax(largest, std::abs(acceleration.mean[c]) + 2.58 * std::sqrt(acceleration.variance[c]));
  EXPECT_TRUE(contains(found[1], formatted("acceleration: |mean| + 2.58 sigma = %.3g m/s^2, of follower ", largest)))
      << found[1];
  EXPECT_TRUE(contains(found[0], "speed: mean - 2.58 sigma = -"));
  EXPECT_TRUE(contains(found[0], "the car reverses"));
}

// The verdict and all figures are those of the paper's loop.
TEST_F(PlausibilityTest, ACancelledUnstableModeHasOneThatNamesIt) {
  configuration_ = paper_run("");
  const std::vector<std::string> without = warnings();
  const LoopDesign paper = paper_design();
  const TransferFunction plant(Eigen::Vector2d(1.0, -1.2), Eigen::Vector4d(1.0, -3.2, 3.4, -1.2));
  car().loop = close_loop(LoopDesign{plant, paper.controller, true}, car().headway);
  const std::vector<std::string> found = warnings();
  ASSERT_EQ(found.size(), without.size() + 1);
  const std::string expected =
      "G(z) K(z) cancels an unstable mode at z = 1.2, which allow_unstable admits: it grows in a real car, and no "
      "figure contains it";
  EXPECT_EQ(std::count(found.begin(), found.end(), expected), 1) << testing::PrintToString(found);
}

TEST_F(PlausibilityTest, LossesAddToTheAcceleration) {
  configuration_ = paper_run("");
  configuration_.run.followers = 5;
  configuration_.run.steps = 60;
  const std::vector<std::string> without = warnings();
  for (const double burst : {1.25, 4.0}) {
    configuration_.model.default_vehicle().position().link.loss = LossModel{0.2, burst, {1.0}};
    const std::vector<std::string> found = warnings();
    ASSERT_EQ(found.size(), 2u);
    EXPECT_TRUE(contains(found[1], "acceleration: |mean| + 2.58 sigma = ")) << found[1];
    EXPECT_NE(found[1], without.at(1));
  }
}

TEST_F(PlausibilityTest, MeasuredMotionIsJudgedLikeThatOfTheTheory) {
  const PlatoonModel& model = configuration_.model;
  EXPECT_TRUE(motion_warnings(model, {{"acceleration", {9.9, -5.0}, {0.0, 1.0}}, {"jerk", {1e6}, {0.0}}}, 2).empty());
  const std::vector<std::string> found = motion_warnings(model, {{"acceleration", {0.0, -8.0}, {0.0, 1.0}}}, 2);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(
      contains(found[0], "acceleration: |mean| + 2.58 sigma = 10.6 m/s^2, of follower 1 at " + time_of_step(1, model)));
  EXPECT_TRUE(motion_warnings(model, {{"speed", {0.0, NAN}, {0.001, 1.0}}}, 2).empty()) << "standing cars with noise";
}

TEST_F(PlausibilityTest, MotionBeyondTheLimitsOfAVehicleIsImpossible) {
  PlatoonModel model = configuration_.model;
  const std::vector<SignalFigures> motion{{"speed", {0.1, 0.5}, {1.0, 1.0}}, {"acceleration", {0.0, -8.0}, {0.0, 9.0}}};
  EXPECT_EQ(motion_warnings(model, motion, 2).size(), 2u);
  model.default_vehicle().limits.speed = Interval{0.0, 40.0};
  EXPECT_EQ(motion_warnings(model, motion, 2).size(), 1u) << "does not reverse";
  model.default_vehicle().limits.input = Interval{-6.0, 2.0};
  EXPECT_TRUE(motion_warnings(model, motion, 2).empty());
  model.default_vehicle().limits.input = Interval{-12.0, 2.0};
  EXPECT_TRUE(contains(motion_warnings(model, motion, 2).at(0), "= 12 m/s^2"));
}

}  // namespace
}  // namespace platoon
