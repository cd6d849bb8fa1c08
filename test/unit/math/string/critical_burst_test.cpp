#include "stochastic_platoon/math/string/critical_burst.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/math/string/critical_loss.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/math/lossy_platoon.hpp"

namespace platoon {
namespace {

bool is_stable(const PlatoonModel& model) {
  return string_stability(model).string_stable;
}

TEST(CriticalBurst, SeparatesStableFromUnstable) {
  const std::optional<CriticalBurst> found = critical_mean_burst(lossy_platoon({0.1, 2.0, {2.0, -1.0}}));
  ASSERT_TRUE(found && found->critical);
  EXPECT_EQ(found->from, 1.0);
  EXPECT_TRUE(is_stable(lossy_platoon({0.1, *found->critical * (1.0 - 1e-9), {2.0, -1.0}})));
  EXPECT_FALSE(is_stable(lossy_platoon({0.1, *found->critical * (1.0 + 1e-9), {2.0, -1.0}})));
  EXPECT_EQ(critical_mean_burst(lossy_platoon({0.1, 5.0, {2.0, -1.0}}))->critical, found->critical)
      << "does not depend on the model's own";
}

// Long bursts narrow the spectra so far that coarse grids of frequencies miss them.
TEST(CriticalBurst, OfLongBurstsSeparatesStableFromUnstable) {
  const std::optional<StableLosses> losses = stable_losses(lossy_platoon({0.0016, 120.0, {2.0, -1.0}}, 20.0));
  ASSERT_TRUE(losses && losses->critical);
  EXPECT_TRUE(is_stable(lossy_platoon({*losses->critical * (1.0 - 1e-8), 120.0, {2.0, -1.0}}, 20.0)));
  EXPECT_FALSE(is_stable(lossy_platoon({*losses->critical * (1.0 + 1e-8), 120.0, {2.0, -1.0}}, 20.0)));
  const std::optional<CriticalBurst> bursts =
      critical_mean_burst(lossy_platoon({*losses->critical, 2.0, {2.0, -1.0}}, 20.0));
  ASSERT_TRUE(bursts && bursts->critical);
  EXPECT_NEAR(*bursts->critical, 120.0, 1e-6);
}

TEST(CriticalBurst, DoesNotExistIfTheStringIsAlwaysOrNeverStable) {
  const std::optional<CriticalBurst> held = critical_mean_burst(lossy_platoon({0.4, 2.0, {1.0}}));
  ASSERT_TRUE(held);
  EXPECT_TRUE(held->stable);
  EXPECT_FALSE(held->critical);
  const std::optional<CriticalBurst> never = critical_mean_burst(lossy_platoon({0.1, 2.0, {2.0, -1.0}}, 2.4));
  ASSERT_TRUE(never);
  EXPECT_FALSE(never->stable);
  EXPECT_FALSE(never->critical);
  EXPECT_FALSE(critical_mean_burst(paper_platoon()));
  PlatoonModel own = lossy_platoon({0.1, 2.0, {2.0, -1.0}});
  own.types.front().inherited.mean_burst = false;
  EXPECT_FALSE(critical_mean_burst(own)) << "no vehicle follows the default link";
}

TEST(CriticalBurst, AgreesWithTheCriticalHeadwayAndLoss) {
  const double burst = *critical_mean_burst(lossy_platoon({0.1, 2.0, {2.0, -1.0}}))->critical;
  PlatoonModel designed = lossy_platoon({0.1, burst, {2.0, -1.0}});
  designed.default_vehicle().design = paper_design();
  const std::optional<StableHeadways> headways = stable_headways(designed);
  ASSERT_TRUE(headways && headways->critical);
  EXPECT_NEAR(*headways->critical, 3.2, 1e-9);
  const std::optional<StableLosses> losses = stable_losses(lossy_platoon({0.05, burst, {2.0, -1.0}}));
  ASSERT_TRUE(losses && losses->critical);
  EXPECT_NEAR(*losses->critical, 0.1, 1e-9);
  EXPECT_NEAR(losses->largest, burst / (1.0 + burst), 1e-12);
}

}  // namespace
}  // namespace platoon
