#include "stochastic_platoon/math/simulation/platoon_string.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

using Errors = std::map<std::pair<std::size_t, std::int64_t>, std::vector<double>>;

Errors errors_of(PlatoonString& string, const PlatoonModel& model, std::uint64_t first, std::size_t count,
                 std::int64_t steps) {
  Errors all;
  string.run(first, count, steps, [&](std::size_t i, std::int64_t k, const SignalPositions& positions) {
    EXPECT_TRUE(all.emplace(std::make_pair(i, k), positions.of(tracking_error(model, i))).second)
        << "reported twice: " << i << ", " << k;
  });
  return all;
}

TEST(PlatoonString, FollowsTheEquations) {
  constexpr std::uint64_t kRealization = 12345;
  constexpr std::uint32_t kFollowers = 4;
  constexpr std::int64_t kSteps = 30;
  const PlatoonModel model = eventful_platoon(3.2);
  const StateSpace& loop = model.default_vehicle().loop.realization;
  const auto g = [&](std::uint32_t i, std::int64_t k) {
    double value;
    WhiteNoise(8).fill({i, k}, kRealization, 1, &value);
    return value;
  };
  const Eigen::VectorXd equilibrium = unit_equilibrium(loop);
  std::vector<Eigen::VectorXd> x = {0.0 * equilibrium};
  for (std::uint32_t i = 1; i <= kFollowers; ++i)
    x.push_back(equilibrium * (-7.0 * i + 0.8 + std::sqrt(0.3) * g(i, -1)));
  PlatoonString string(model, 8, kFollowers);
  const Errors found = errors_of(string, model, kRealization, 1, kSteps);
  ASSERT_EQ(found.size(), static_cast<std::size_t>(kFollowers * kSteps));
  for (std::int64_t k = 0; k < kSteps; ++k) {
    const std::vector<Eigen::VectorXd> before = x;
    x[0] = loop.a() * before[0] + loop.b() * model.leader.position(k - 1);
    for (std::uint32_t i = 1; i <= kFollowers; ++i) {
      const double d = k == 0 ? 0.0 : std::sqrt(0.6) * g(i, k - 1);
      const double y = loop.c() * before[i - 1];
      x[i] = loop.a() * before[i] + loop.b() * (y + d - 7.0);
    }
    for (std::uint32_t i = 1; i <= kFollowers; ++i) {
      const double y = loop.c() * x[i], y_before = loop.c() * before[i], predecessor = loop.c() * x[i - 1];
      EXPECT_NEAR(found.at({i, k})[0], predecessor - y - 7.0 - 3.2 * (y - y_before), 1e-12) << i << ", " << k;
    }
  }
}

TEST(PlatoonString, StaysInFormationWithoutDisturbance) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().position().noise_variance = 0.0;
  model.default_vehicle().standstill_distance = 7.0;
  model.leader = LeaderProfile({}, 0.1);
  PlatoonString string(model, 1, 6);
  for (const auto& entry : errors_of(string, model, 0, 3, 50)) {
    for (const double error : entry.second) EXPECT_NEAR(error, 0.0, 1e-12);
  }
}

TEST(PlatoonString, HasTheSameBitsInEveryBatch) {
  const PlatoonModel model = eventful_platoon(3.2);
  PlatoonString string(model, 1, 3);
  const Errors whole = errors_of(string, model, 0, 40, 20);
  for (const std::size_t batch : {1, 7, 33}) {
    for (std::size_t first = 0; first < 40; first += batch) {
      for (const auto& part : errors_of(string, model, first, std::min(batch, 40 - first), 20)) {
        ASSERT_EQ(
            std::memcmp(part.second.data(), whole.at(part.first).data() + first, part.second.size() * sizeof(double)),
            0);
      }
    }
  }
}

}  // namespace
}  // namespace platoon
