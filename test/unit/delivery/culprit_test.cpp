#include "stochastic_platoon/delivery/culprit.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

const BatchSchedule kSchedule{80, 8, 10};  // steps -1 .. 9
const std::optional<Turn> kNone;

std::optional<Turn> at(std::uint64_t first, std::int64_t step) {
  return Turn{2, first, step};
}

TEST(Culprit, IsTheOneFollowerThatIsBehind) {
  EXPECT_EQ(culprit({at(8, 5), at(8, 6), at(8, 2), at(8, 3), at(8, 4)}, kSchedule),
            "vehicle_2 has sent nothing since step 2 (realizations from 8)");
}

TEST(Culprit, IsAFollowerThatHasNeverBeenHeard) {
  EXPECT_EQ(culprit({at(0, -1), at(0, 0), kNone, kNone}, kSchedule), "vehicle_2 has sent nothing at all");
}

TEST(Culprit, IsAFollowerThatIsABatchBehind) {
  EXPECT_EQ(culprit({at(16, 0), at(8, 9), at(8, 9), at(8, 9)}, kSchedule),
            "vehicle_1 has sent nothing since step 9 (realizations from 8)");
}

TEST(Culprit, IsTheOnlyFollowerOrTheChannel) {
  EXPECT_EQ(culprit({at(8, 5), at(8, 4)}, kSchedule),
            "vehicle_1 has sent nothing since step 4 (realizations from 8): it or the channel is down");
  EXPECT_EQ(culprit({at(8, 5), kNone}, kSchedule),
            "vehicle_1 has sent nothing at all: it or the channel is down");
}

TEST(Culprit, IsTheChannelWhenAllFollowersAreBehind) {
  EXPECT_EQ(culprit({at(8, 9), at(8, 7), at(8, 6), at(8, 5)}, kSchedule),
            "channel has passed nothing on: all followers wait, vehicle_1 has sent nothing since step 7 "
            "(realizations from 8)");
}

TEST(Culprit, IsTheLeaderWhenEveryFollowerHasSentWhatItCould) {
  EXPECT_EQ(culprit({at(8, 5), at(8, 6), at(8, 7)}, kSchedule),
            "vehicle_0 (leader) has sent nothing since step 5 (realizations from 8)");
  EXPECT_EQ(culprit({at(8, 9), at(8, 9), at(8, 9)}, kSchedule),
            "vehicle_0 (leader) has sent nothing since step 9 (realizations from 8)");
  EXPECT_EQ(culprit({kNone, kNone, kNone}, kSchedule), "vehicle_0 (leader) has sent nothing at all");
}

TEST(Culprit, AreSeveralFollowersWhenSomeAreBehind) {
  EXPECT_EQ(culprit({at(8, 9), at(8, 7), at(8, 8), at(8, 6), at(8, 7)}, kSchedule),
            "vehicle_1 has sent nothing since step 7 (realizations from 8); the same holds for 1 more");
}

TEST(Culprit, OfAnEndlessRunIsFoundToo) {
  EXPECT_EQ(culprit({at(0, 500), at(0, 501), at(0, 40), at(0, 41)}, BatchSchedule{1, 1, 0}),
            "vehicle_2 has sent nothing since step 40 (realizations from 0)");
}

}  // namespace
}  // namespace platoon
