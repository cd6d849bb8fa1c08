#include "stochastic_platoon/ros/transport/message_counter.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

constexpr MessageId kId{};

TEST(MessageCounter, CountsEachVerdictAndWhatIsNotToBeExpected) {
  MessageCounter counter("/platoon/vehicle_2/position");
  for (const DropReason drop : {DropReason::stale, DropReason::stale, DropReason::missed_start, DropReason::not_finite})
    counter.drop(drop, kId, 1);
  EXPECT_EQ(counter.dropped(DropReason::stale), 2u);
  EXPECT_EQ(counter.dropped(DropReason::out_of_turn), 0u);
  EXPECT_EQ(counter.faults(), 1u);
  EXPECT_EQ(counter.taken(), 0u);
}

TEST(MessageCounter, KnowsHowAnExternalVehicleViolatedTheContractUntilAMessageOfItCounts) {
  MessageCounter counter("/platoon/vehicle_2/position", "vehicle_2");
  EXPECT_FALSE(counter.latest_breach());
  counter.drop(DropReason::missed_start, kId, 1);
  counter.drop(DropReason::wrong_size, kId, 1);
  EXPECT_EQ(counter.latest_breach(), DropReason::wrong_size);
  counter.take({1, 0, 7});
  EXPECT_FALSE(counter.latest_breach());
  EXPECT_EQ(counter.taken(), 1u);
  EXPECT_EQ(counter.step(), 7);
  EXPECT_EQ(counter.attempt(), 1u);
}

TEST(MessageCounter, TheContractBindsNoBuiltInVehicle) {
  MessageCounter counter("/platoon/vehicle_2/position");
  counter.drop(DropReason::wrong_size, kId, 1);
  EXPECT_FALSE(counter.latest_breach());
}

}  // namespace
}  // namespace platoon
