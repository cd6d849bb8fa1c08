#include "stochastic_platoon/math/string/amplification.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/model/vehicle.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

constexpr std::size_t kFollowers = 20;
constexpr double kPi = 3.14159265358979323846;

// A speed of 20 m/s with a sinusoid of amplitude 1 m/s and a period of 10 steps on it.
PlatoonModel behind_a_sinusoid(double headway, std::int64_t steps) {
  PlatoonModel model = paper_platoon(headway);
  model.recorded_leader = {0.0};
  for (std::int64_t k = 0; k < steps; ++k)
    model.recorded_leader.push_back(model.recorded_leader.back() +
                                    0.1 * (20.0 + std::sin(2.0 * kPi * static_cast<double>(k) / 10.0)));
  return model;
}

SignalsByName theory(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t followers,
                     std::int64_t steps) {
  const std::vector<SignalMoments> moments = signal_moments(model, names, followers, steps);
  SignalsByName signals;
  for (std::size_t s = 0; s < names.size(); ++s) signals[names[s]] = with_leader(model, names[s], moments[s], steps);
  return signals;
}

// |T(e^{j 2 pi / 10})| and its 20th power, computed in 30 digits from K, G and H.
void expect_gain(double headway, double gain, double of_twenty) {
  constexpr std::int64_t kSteps = 400, kFrom = 200;
  const PlatoonModel model = behind_a_sinusoid(headway, kSteps);
  const std::vector<Amplification> found =
      amplification(theory(model, {"speed", "acceleration"}, kFollowers, kSteps), kSteps, kFrom);
  ASSERT_EQ(found.size(), kFollowers + 1);
  // The transient of the start decays to 1e-6 in 90 steps at h = 3.2, and in 140 at h = 2.4.
  for (std::size_t i = 1; i <= kFollowers; ++i) {
    EXPECT_NEAR(found[i].l2_ratio, gain, 1e-5 * gain) << i;
    // The largest of ten values per period is within cos(pi / 10) of the amplitude.
    EXPECT_NEAR(std::log(found[i].linf_ratio), std::log(gain), -std::log(std::cos(kPi / 10.0))) << i;
  }
  EXPECT_NEAR(found.back().l2_head_to_tail, of_twenty, 1e-5 * of_twenty);
  EXPECT_NEAR(std::log(found.back().linf_head_to_tail), std::log(of_twenty), -std::log(std::cos(kPi / 10.0)));
  // D of a sinusoid: 2 sin(w/2) times its amplitude.
  const double leader = 2.0 * std::sin(kPi / 10.0) / 0.1 / std::sqrt(2.0);
  EXPECT_NEAR(found[0].rms_acceleration, leader, 1e-9 * leader);
  EXPECT_NEAR(found.back().rms_mean_acceleration, leader * of_twenty, 1e-5 * leader * of_twenty);
}

TEST(Amplification, OfASinusoidIsTheFrequencyResponse) {
  expect_gain(2.4, 1.15823, 18.8753);
  expect_gain(3.2, 0.799494, 0.0113841);
}

TEST(Amplification, OfTheLoopOfTheLeaderEqualsThatOfItsPositions) {
  PlatoonModel model = eventful_platoon(3.2);
  LeaderVehicle leader(model);
  std::vector<double> positions{leader.start()};
  for (int k = 0; k < 60; ++k) positions.push_back(leader.step());
  const std::vector<double> speed = leader_signal(model, "speed", 60), jerk = leader_signal(model, "jerk", 60);
  for (std::size_t k = 0; k < 60; ++k) EXPECT_NEAR(speed[k], (positions[k + 1] - positions[k]) / 0.1, 1e-10) << k;
  const auto at = [&](int k) { return k < 0 ? 0.0 : speed[static_cast<std::size_t>(k)]; };
  for (int k = 0; k < 60; ++k)
    EXPECT_NEAR(jerk[static_cast<std::size_t>(k)], (at(k) - 2.0 * at(k - 1) + at(k - 2)) / 0.01, 1e-7) << k;
  const SignalsByName of_loop = theory(model, {"speed"}, 3, 60);
  model.recorded_leader = positions;
  EXPECT_EQ(leader_signal(model, "speed", 60), speed);
  const std::vector<Amplification> found = amplification(theory(model, {"speed"}, 3, 60), 60, 0),
                                   expected = amplification(of_loop, 60, 0);
  for (std::size_t i = 1; i <= 3; ++i) EXPECT_NEAR(found[i].l2_ratio, expected[i].l2_ratio, 1e-10);
}

// Two vehicles, four steps, the first of which is left out: speeds 1, 2, 3 about 2 and 2, 2, 5 about 3.
SignalRows small_rows(double variance, double variance_of_mean) {
  return {{9.0, 1.0, 2.0, 3.0, 9.0, 2.0, 2.0, 5.0},
          std::vector<double>(8, variance),
          std::vector<double>(8, variance_of_mean)};
}

TEST(Amplification, TakesNormsAboutTheAverage) {
  const SignalRows rows = small_rows(0.0, 0.0);
  const std::vector<Amplification> found = amplification({{"speed", rows}, {"acceleration", rows}}, 4, 1);
  EXPECT_TRUE(std::isnan(found[0].l2_ratio) && std::isnan(found[0].linf_head_to_tail));
  EXPECT_DOUBLE_EQ(found[1].l2_ratio, std::sqrt(6.0 / 2.0));
  EXPECT_DOUBLE_EQ(found[1].linf_ratio, 2.0);
  EXPECT_DOUBLE_EQ(found[1].rms_mean_speed, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(found[1].l2_head_to_tail, found[1].l2_ratio);
  EXPECT_DOUBLE_EQ(found[0].rms_acceleration, std::sqrt(14.0 / 3.0));
  EXPECT_DOUBLE_EQ(found[1].rms_mean_acceleration, std::sqrt(33.0 / 3.0));
  EXPECT_TRUE(std::isnan(found[1].rms_jerk)) << "not given";
}

TEST(Amplification, CountsNoiseInTheMotionButNotInTheMeanMotion) {
  const SignalRows rows = small_rows(7.0, 0.05);
  const std::vector<Amplification> found = amplification({{"speed", rows}, {"jerk", rows}}, 4, 1);
  EXPECT_DOUBLE_EQ(found[1].l2_ratio, std::sqrt((6.0 - 0.15) / (2.0 - 0.15)));
  EXPECT_DOUBLE_EQ(found[1].rms_jerk, std::sqrt(33.0 / 3.0 + 7.0));
  EXPECT_DOUBLE_EQ(found[1].rms_mean_jerk, std::sqrt((33.0 - 0.15) / 3.0));
  EXPECT_TRUE(std::isnan(found[1].linf_ratio)) << "2 and 1 m/s are not above 100 standard errors of 0.22 m/s";
  EXPECT_DOUBLE_EQ(amplification({{"speed", small_rows(7.0, 1e-4)}}, 4, 1)[1].linf_ratio, 2.0);
}

TEST(Amplification, IsUndefinedIfNoiseHidesTheMotion) {
  // The leader's sum of squares is 2: less than eleven times 3 x 0.061.
  const std::vector<Amplification> found = amplification({{"speed", small_rows(7.0, 0.061)}}, 4, 1);
  EXPECT_TRUE(std::isnan(found[1].l2_ratio));
  EXPECT_FALSE(std::isnan(amplification({{"speed", small_rows(7.0, 0.060)}}, 4, 1)[1].l2_ratio));
  EXPECT_TRUE(std::isnan(amplification({{"speed", small_rows(7.0, std::nan(""))}}, 4, 1)[1].l2_ratio))
      << "unknown standard errors, of one realization";
}

TEST(Amplification, IsUndefinedAtConstantSpeed) {
  PlatoonModel model = paper_platoon();
  const SignalsByName signals = theory(model, {"speed", "acceleration"}, 2, 400);
  const std::vector<Amplification> settled = amplification(signals, 400, 300), all = amplification(signals, 400, 0);
  EXPECT_TRUE(std::isnan(settled[1].l2_ratio) && std::isnan(settled[1].linf_ratio) && std::isnan(settled[2].l2_ratio));
  EXPECT_EQ(settled[0].rms_mean_speed, 0.0);
  EXPECT_LT(settled[2].rms_mean_acceleration, 1e-6);
  EXPECT_GT(settled[2].rms_acceleration, settled[1].rms_acceleration);
  EXPECT_GT(all[1].l2_ratio, 0.0) << "the start, from standstill to 20 m/s, is a motion";
}

TEST(Amplification, RejectsStepsAndRowsThatDoNotFit) {
  const SignalRows rows = small_rows(0.0, 0.0);
  EXPECT_THROW(amplification({{"speed", rows}}, 4, -1), std::invalid_argument);
  EXPECT_THROW(amplification({{"speed", rows}}, 4, 3), std::invalid_argument);
  EXPECT_NO_THROW(amplification({{"speed", rows}}, 4, 2));
  EXPECT_THROW(amplification({{"speed", rows}}, 3, 0), std::invalid_argument);
  SignalRows shorter = rows;
  shorter.variance.pop_back();
  EXPECT_THROW(amplification({{"speed", rows}, {"jerk", shorter}}, 4, 0), std::invalid_argument);
  EXPECT_TRUE(amplification({}, 4, 0).empty());
}

}  // namespace
}  // namespace platoon
