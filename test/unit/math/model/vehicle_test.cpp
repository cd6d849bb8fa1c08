#include "stochastic_platoon/math/model/vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/math/noise/draw.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

// The paper's example with a standstill distance of 6.5 m and these initial positions.
PlatoonModel platoon_at(const InitialPosition& initial) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().standstill_distance = 6.5;
  model.default_vehicle().initial_position = initial;
  return model;
}

TEST(FollowerVehicle, StartsInItsPlaceWithoutRandomness) {
  const PlatoonModel model = platoon_at({0.25, 0.0});
  std::vector<double> positions;
  FollowerVehicle(model, 1, 4).start(10, 3, positions);
  ASSERT_EQ(positions.size(), 3u);
  for (const double position : positions) EXPECT_NEAR(position, -4.0 * 6.5 + 0.25, 1e-13);
}

TEST(FollowerVehicle, StartsWithTheNoiseOfStepMinusOne) {
  const PlatoonModel model = platoon_at({0.25, 2.0});
  std::vector<double> positions;
  FollowerVehicle(model, 5, 3).start(101, 50, positions);
  const std::vector<double> g = draw(5, {3, -1}, 101, 50);
  for (std::size_t r = 0; r < 50; ++r) {
    EXPECT_NEAR(positions[r], -3.0 * 6.5 + 0.25 + std::sqrt(2.0) * g[r], 1e-13);
  }
}

// The tolerance is four standard errors of mean and variance of n normals, sqrt(v / n) and v sqrt(2 / n).
TEST(FollowerVehicle, StartsWithTheMeanAndTheVarianceOfTheModel) {
  const PlatoonModel model = platoon_at({-0.8, 0.3});
  constexpr std::size_t kCount = 40000;
  std::vector<double> positions;
  FollowerVehicle(model, 1, 2).start(0, kCount, positions);
  double mean = 0.0, variance = 0.0;
  for (const double position : positions) mean += position / kCount;
  for (const double position : positions) variance += (position - mean) * (position - mean) / kCount;
  EXPECT_NEAR(mean, -13.0 - 0.8, 4.0 * std::sqrt(0.3 / kCount));
  EXPECT_NEAR(variance, 0.3, 4.0 * 0.3 * std::sqrt(2.0 / kCount));
}

TEST(FollowerVehicle, StaysAtRestBehindAPredecessorAtRest) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().standstill_distance = 6.5;
  FollowerVehicle follower(model, 1, 3);
  std::vector<double> positions;
  follower.start(0, 2, positions);
  for (int k = 0; k < 200; ++k) {
    follower.step({-2.0 * 6.5, -2.0 * 6.5}, positions);
    for (const double position : positions) ASSERT_NEAR(position, -3.0 * 6.5, 1e-12);
  }
}

TEST(FollowerVehicle, ForgetsItsPastAtANewStart) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().initial_position = {0.0, 1.0};
  FollowerVehicle used(model, 1, 1), fresh(model, 1, 1);
  std::vector<double> one, other;
  used.start(0, 5, one);
  for (int k = 0; k < 7; ++k) used.step({1.0, 2.0, 3.0, 4.0, 5.0}, one);
  used.start(20, 3, one);
  fresh.start(20, 3, other);
  EXPECT_EQ(one, other);
  used.step({0.1, 0.2, 0.3}, one);
  fresh.step({0.1, 0.2, 0.3}, other);
  EXPECT_EQ(one, other);
}

TEST(LeaderVehicle, ReceivesTheVirtualLeaderOneStepLater) {
  PlatoonModel model = paper_platoon();
  LeaderVehicle leader(model);
  EXPECT_EQ(leader.start(), 0.0);
  EXPECT_EQ(leader.step(), 0.0);                        // y_0(0): r_0(-1) = 0
  EXPECT_EQ(leader.step(), 0.0);                        // y_0(1): r_0(0) = 0
  EXPECT_EQ(leader.step(), 0.0);                        // y_0(2): T has the relative degree 2
  EXPECT_NEAR(leader.step(), 1.35 / 4.2 * 2.0, 1e-14);  // y_0(3): r_0(1) = 2
}

// T(1) = 1 and dT/dz(1) = -h: on a ramp the leader follows the virtual one at the distance of the headway.
TEST(LeaderVehicle, TracksARampAtItsHeadway) {
  for (const double h : {3.2, 2.4}) {
    LeaderVehicle leader(paper_platoon(h));
    leader.start();
    double position = 0.0;
    for (std::int64_t k = 0; k <= 200; ++k) position = leader.step();
    EXPECT_NEAR(position, 2.0 * 200 - h * 2.0, 1e-10);
  }
}

TEST(LeaderVehicle, CarriesOutAnOrderFromBeforeItsFirstStartAndNoneFromBeforeTheNext) {
  LeaderVehicle leader(paper_platoon()), by_model(paper_platoon());
  leader.manoeuvre().brake();
  const auto moved = [](LeaderVehicle& of) {
    double before = of.start(), last = 0.0;
    for (int k = 0; k < 200; ++k) {
      const double now = of.step();
      last = now - before;
      before = now;
    }
    return last;
  };
  EXPECT_NEAR(moved(leader), 0.0, 1e-9);
  const double driven = moved(by_model);
  EXPECT_GT(driven, 1.0);
  EXPECT_EQ(moved(leader), driven);
}

TEST(LeaderVehicle, ForgetsItsPastAtANewStart) {
  LeaderVehicle leader(paper_platoon());
  std::vector<double> first, second;
  for (std::vector<double>* run : {&first, &second}) {
    run->push_back(leader.start());
    for (int k = 0; k < 40; ++k) run->push_back(leader.step());
  }
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace platoon
