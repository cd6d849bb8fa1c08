#include "stochastic_platoon/ros/transport/drop_counter.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

constexpr MessageId kId{};

TEST(DropCounter, CountsEachReasonAndTheFaults) {
  DropCounter drops("/platoon/vehicle_2/position");
  for (const DropReason drop : {DropReason::stale, DropReason::stale, DropReason::missed_start, DropReason::not_finite})
    drops.count(drop, kId, 1);
  EXPECT_EQ(drops.of(DropReason::stale), 2u);
  EXPECT_EQ(drops.of(DropReason::out_of_turn), 0u);
  EXPECT_EQ(drops.faults(), 1u);
}

TEST(DropCounter, KeepsTheLatestBreachOfAnExternalVehicle) {
  DropCounter drops("/platoon/vehicle_2/position", "vehicle_2");
  EXPECT_FALSE(drops.latest_breach());
  drops.count(DropReason::missed_start, kId, 1);
  drops.count(DropReason::wrong_size, kId, 1);
  EXPECT_EQ(drops.latest_breach(), DropReason::wrong_size);
  drops.forget_breach();
  EXPECT_FALSE(drops.latest_breach());
}

TEST(DropCounter, IgnoresBreachesOfABuiltInVehicle) {
  DropCounter drops("/platoon/vehicle_2/position");
  drops.count(DropReason::wrong_size, kId, 1);
  EXPECT_FALSE(drops.latest_breach());
}

}  // namespace
}  // namespace platoon
