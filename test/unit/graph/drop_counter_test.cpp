#include "stochastic_platoon/graph/drop_counter.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

constexpr MessageId kId{};

TEST(DropCounter, CountsEachVerdictAndWhatIsNotToBeExpected) {
  DropCounter drops("/platoon/vehicle_2/position");
  for (const Verdict verdict : {Verdict::stale, Verdict::stale, Verdict::missed_start, Verdict::not_finite})
    drops.count(verdict, kId, 1);
  EXPECT_EQ(drops.of(Verdict::stale), 2u);
  EXPECT_EQ(drops.of(Verdict::out_of_turn), 0u);
  EXPECT_EQ(drops.faults(), 1u);
}

TEST(DropCounter, KnowsHowAnExternalVehicleViolatedTheContractUntilAMessageOfItCounts) {
  DropCounter drops("/platoon/vehicle_2/position", "vehicle_2");
  EXPECT_FALSE(drops.latest_breach());
  drops.count(Verdict::missed_start, kId, 1);
  drops.count(Verdict::wrong_size, kId, 1);
  EXPECT_EQ(drops.latest_breach(), Verdict::wrong_size);
  drops.forget_breach();
  EXPECT_FALSE(drops.latest_breach());
}

TEST(DropCounter, TheContractBindsNoBuiltInVehicle) {
  DropCounter drops("/platoon/vehicle_2/position");
  drops.count(Verdict::wrong_size, kId, 1);
  EXPECT_FALSE(drops.latest_breach());
}

}  // namespace
}  // namespace platoon
