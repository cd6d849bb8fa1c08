#include <gtest/gtest.h>

#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/math/string/critical_loss.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

/// Cars, the default vehicle, and a truck every so many followers: a longer headway and a delay.
PlatoonModel cars_and_a_truck(std::size_t vehicles) {
  PlatoonModel model = paper_platoon(3.2);
  model.default_vehicle().design = paper_design();
  VehicleModel truck = vehicle(model, 1);
  truck.headway = 4.0;
  truck.loop = close_loop(*truck.design, 4.0);
  truck.position().link.delay = 1;
  model.types.push_back({"truck", truck, {false, true, true, true}});
  model.string.assign(vehicles, 0);
  model.string.back() = 1;
  return model;
}

// Each of them is string stable by itself, hence their product.
TEST(MixedString, OfALongPatternIsJudgedByItsVehicles) {
  for (const std::size_t vehicles : {8u, 12u, 30u, 300u, 1000u}) {
    const StringStability verdict = string_stability(cars_and_a_truck(vehicles));
    EXPECT_EQ(verdict.decision(), true) << vehicles << ": " << verdict.reason;
    EXPECT_GT(*verdict.limit_variance, 0.0) << vehicles;
  }
  const std::optional<StableHeadways> headways = stable_headways(cars_and_a_truck(8));
  ASSERT_TRUE(headways && headways->critical) << "long headways are stable, too";
  EXPECT_TRUE(string_stability(with_headway(cars_and_a_truck(8), *headways->critical + 1e-9)).string_stable);
  EXPECT_FALSE(string_stability(with_headway(cars_and_a_truck(8), *headways->critical - 1e-9)).string_stable);
}

// A pattern and its repetitions have the same limit.
TEST(MixedString, HasTheSameLimitForARepeatedPattern) {
  PlatoonModel once = cars_and_a_truck(3);
  once.default_vehicle().position().link.loss = LossModel{0.1, {}, {1.0}};
  once.types[1].vehicle.position().link.loss = LossModel{0.2, {}, {2.0, -1.0}};
  PlatoonModel twice = once;
  twice.string = {0, 0, 1, 0, 0, 1};
  PlatoonModel often = once;
  for (int i = 0; i < 30; ++i) often.string.insert(often.string.end(), once.string.begin(), once.string.end());
  const StringStability expected = string_stability(once);
  ASSERT_TRUE(expected.string_stable) << expected.reason;
  for (const PlatoonModel& model : {twice, often}) {  // 6 and 93 links, below and above the size of a Krylov space
    const StringStability found = string_stability(model);
    EXPECT_NEAR(*found.limit_variance / *expected.limit_variance, 1.0, 1e-10);
    const double periods = static_cast<double>(model.string.size()) / 3.0;
    EXPECT_GT(*found.loss_gain, 0.0) << periods;
    EXPECT_LT(*found.loss_gain, 1.0) << periods;
  }
}

TEST(MixedString, FollowsTheHeadwayInTypesThatInheritIt) {
  PlatoonModel model = cars_and_a_truck(3);
  model.types[1].inherited.headway = true;
  model.types[1].vehicle = model.default_vehicle();
  model.types[1].vehicle.position().link.delay = 1;
  const std::optional<StableHeadways> found = stable_headways(model);
  ASSERT_TRUE(found && found->critical);
  EXPECT_EQ(found->types, (std::vector<std::string>{"default", "truck"}));
  EXPECT_NEAR(*found->critical, 2.8, 1e-9);  // that of one vehicle
  EXPECT_TRUE(string_stability(with_headway(model, *found->critical + 1e-6)).string_stable);
  EXPECT_FALSE(string_stability(with_headway(model, *found->critical - 1e-6)).string_stable);
  model.string = {1};
  EXPECT_EQ(stable_headways(model)->types, std::vector<std::string>{"truck"});
  model.types[1].inherited.headway = false;
  EXPECT_FALSE(stable_headways(model)) << "no vehicle of the string follows the default headway";
}

TEST(MixedString, FollowsTheLossProbabilityInTypesThatInheritIt) {
  PlatoonModel model = cars_and_a_truck(2);
  model.default_vehicle().position().link.loss = LossModel{0.1, {}, {2.0, -1.0}};
  model.types[1].vehicle.position().link.loss = LossModel{0.1, {}, {2.0, -1.0}};
  const std::optional<StableLosses> followed = stable_losses(model);
  EXPECT_EQ(followed->types, (std::vector<std::string>{"default", "truck"}));
  model.types[1].inherited.loss_probability = false;
  const std::optional<StableLosses> alone = stable_losses(model);
  EXPECT_EQ(alone->types, std::vector<std::string>{"default"});
  EXPECT_LT(*followed->critical, *alone->critical);
  model.string = {1};
  EXPECT_FALSE(stable_losses(model));
}

}  // namespace
}  // namespace platoon
