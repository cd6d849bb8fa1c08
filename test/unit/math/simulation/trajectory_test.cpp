#include "stochastic_platoon/math/simulation/trajectory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/simulation/platoon_string.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

constexpr std::size_t kFollowers = 3;
constexpr std::int64_t kSteps = 45;  // more than the string computes at once
const std::vector<std::string> kSignals{"gap", "speed", "acceleration", "jerk", "relative_speed"};

std::vector<Trajectory> trajectories(const PlatoonModel& model, std::uint64_t seed, std::size_t followers,
                                     std::int64_t steps, std::uint64_t realization) {
  std::vector<Trajectory> all;
  for_each_trajectory(model, seed, followers, steps, realization, kSignals,
                      [&](const Trajectory& of) { all.push_back(of); });
  return all;
}

// Every signal of a realization has the bits of a batch of them.
void expect_bits_of_the_string(const PlatoonModel& model) {
  constexpr std::uint64_t kFirst = 5, kPlace = 2;
  const std::vector<Trajectory> found = trajectories(model, 3, kFollowers, kSteps, kFirst + kPlace);
  ASSERT_EQ(found.size(), kFollowers + 1);
  std::size_t compared = 0;
  PlatoonString(model, 3, kFollowers, Signal::kHighestOrder)
      .run(kFirst, 4, kSteps, [&](std::size_t i, std::int64_t k, const SignalPositions& positions) {
        const FollowerSignals signals = signals_of(model, kSignals, i);
        std::vector<Signal> all{signals.error};
        all.insert(all.end(), signals.requested.begin(), signals.requested.end());
        for (std::size_t kind = 0; kind < all.size(); ++kind, ++compared)
          ASSERT_EQ(found[i].signals.at(kind).at(static_cast<std::size_t>(k)), positions.of(all[kind])[kPlace]);
      });
  EXPECT_EQ(compared, 6 * kFollowers * static_cast<std::size_t>(kSteps));
}

TEST(Trajectories, HaveTheBitsOfTheRun) {
  expect_bits_of_the_string(eventful_platoon(3.2));
}

TEST(Trajectories, HaveTheBitsOfARunWithRadios) {
  PlatoonModel model = radio_platoon(0.5, 0.01, 0.01);
  lose_inputs(model, 0.3, {1.0});
  expect_bits_of_the_string(model);
  const std::vector<Trajectory> found = trajectories(model, 3, kFollowers, kSteps, 0);
  EXPECT_EQ(found[0].input.size(), static_cast<std::size_t>(kSteps) + 1);
  EXPECT_EQ(found[1].received.at(1).size(), static_cast<std::size_t>(kSteps));
  EXPECT_TRUE(found[kFollowers].input.empty()) << "the last vehicle sends to no follower";
}

TEST(Trajectories, AreAtRestBeforeTheFirstStep) {
  const std::vector<Trajectory> found = trajectories(paper_platoon(), 1, 1, 3, 0);
  const std::vector<double>& y = found[1].position;
  ASSERT_EQ(y.size(), 4u);
  EXPECT_EQ(found[1].signals[2][0], (y[1] - y[0]) / 0.1 * 1.0) << "speed";
  EXPECT_DOUBLE_EQ(found[1].signals[4][0], (y[1] - y[0]) / 0.001) << "jerk";
}

TEST(Trajectories, OfTheLeaderHaveItsMotionAndNothingRelative) {
  const Trajectory leader = trajectories(eventful_platoon(3.2), 1, 1, kSteps, 0).front();
  ASSERT_EQ(leader.signals.size(), kSignals.size() + 1);
  for (const std::size_t relative : {0, 1, 5}) EXPECT_TRUE(leader.signals[relative].empty()) << relative;
  const std::vector<double>& speed = leader.signals[2];
  ASSERT_EQ(speed.size(), static_cast<std::size_t>(kSteps));
  double fastest = 0.0;
  for (std::size_t k = 1; k < speed.size(); ++k) {
    EXPECT_DOUBLE_EQ(speed[k], (leader.position[k + 1] - leader.position[k]) / 0.1);
    EXPECT_NEAR(leader.signals[3][k], (speed[k] - speed[k - 1]) / 0.1, 1e-9) << "acceleration";
    fastest = std::max(fastest, speed[k]);
  }
  EXPECT_GT(fastest, 1.0);
}

}  // namespace
}  // namespace platoon
