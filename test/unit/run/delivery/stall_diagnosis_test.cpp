#include "stochastic_platoon/run/delivery/stall_diagnosis.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

const BatchSchedule kSchedule{80, 8, 10};  // steps -1 .. 9
const std::optional<MessageId> kNone;
constexpr std::size_t kAllAhead = 1000;

std::optional<MessageId> at(std::uint64_t first, std::int64_t step) {
  return MessageId{2, first, step};
}

std::string culprit(const std::vector<std::optional<MessageId>>& latest, const BatchSchedule& schedule) {
  return diagnose_stall(latest, schedule, kAllAhead).text;
}

TEST(StallDiagnosis, NamesTheVehicle) {
  EXPECT_EQ(diagnose_stall({at(8, 5), at(8, 6), at(8, 2), at(8, 3)}, kSchedule, kAllAhead).vehicle, 2u);
  EXPECT_EQ(diagnose_stall({at(8, 5), at(8, 6), at(8, 7)}, kSchedule, kAllAhead).vehicle, 0u) << "the leader";
  const StallDiagnosis channel = diagnose_stall({at(8, 9), at(8, 7), at(8, 6)}, kSchedule, kAllAhead);
  EXPECT_FALSE(channel.vehicle);
  EXPECT_EQ(channel.cause, StallCause::silent_channel);
}

TEST(StallDiagnosis, NamesTheOnlyFollowerThatIsBehind) {
  EXPECT_EQ(culprit({at(8, 5), at(8, 6), at(8, 2), at(8, 3), at(8, 4)}, kSchedule),
            "vehicle_2 has sent nothing since step 2 (realizations from 8)");
}

TEST(StallDiagnosis, NamesAFollowerThatHasSentNothing) {
  EXPECT_EQ(culprit({at(0, -1), at(0, 0), kNone, kNone}, kSchedule), "vehicle_2 has sent nothing at all");
}

TEST(StallDiagnosis, NamesTheLatestStepOfAnEarlierAttempt) {
  EXPECT_EQ(diagnose_stall({at(0, -1), at(0, 0), kNone, kNone}, kSchedule, kAllAhead, {},
                           {at(8, 5), at(8, 6), at(8, 2), at(8, 3)})
                .text,
            "vehicle_2 has sent nothing since step 2 (realizations from 8)");
}

TEST(StallDiagnosis, NamesAFollowerThatIsABatchBehind) {
  EXPECT_EQ(culprit({at(16, 0), at(8, 9), at(8, 9), at(8, 9)}, kSchedule),
            "vehicle_1 has sent nothing since step 9 (realizations from 8)");
}

// With 12 followers and a pipeline depth of 4, followers 3, 6, 9 and 12 publish ahead.
TEST(StallDiagnosis, RespectsFollowersThatDoNotPublishAhead) {
  std::vector<std::optional<MessageId>> latest;
  for (std::int64_t i = 0; i <= 12; ++i) latest.push_back(at(8, 2 + i / 3));
  EXPECT_EQ(diagnose_stall(latest, kSchedule, 4).vehicle, 0u);
  latest[7]->step = 3;  // its predecessor is at step 4; vehicle 7 has not sent its step 4
  EXPECT_EQ(diagnose_stall(latest, kSchedule, 4).vehicle, 7u);
}

// An external vehicle at the step of its predecessor has sent all that it can send.
TEST(StallDiagnosis, RespectsExternalVehiclesWhichDoNotPublishAhead) {
  EXPECT_EQ(diagnose_stall({at(8, 5), at(8, 5), at(8, 6)}, kSchedule, kAllAhead, {1}).vehicle, 0u);
  EXPECT_EQ(diagnose_stall({at(8, 5), at(8, 5), at(8, 6)}, kSchedule, kAllAhead).vehicle, 1u);
  EXPECT_EQ(diagnose_stall({at(8, 5), at(8, 4), at(8, 5)}, kSchedule, kAllAhead, {1}).vehicle, 1u);
}

TEST(StallDiagnosis, NamesTheOnlyFollowerOrTheChannel) {
  EXPECT_EQ(culprit({at(8, 5), at(8, 4)}, kSchedule),
            "vehicle_1 has sent nothing since step 4 (realizations from 8): it or the channel is down");
  EXPECT_EQ(culprit({at(8, 5), kNone}, kSchedule), "vehicle_1 has sent nothing at all: it or the channel is down");
}

TEST(StallDiagnosis, NamesTheChannelIfAllFollowersAreBehind) {
  EXPECT_EQ(culprit({at(8, 9), at(8, 7), at(8, 6), at(8, 5)}, kSchedule),
            "channel has passed nothing on: all followers wait, vehicle_1 has sent nothing since step 7 "
            "(realizations from 8)");
}

TEST(StallDiagnosis, NamesTheLeaderIfNoFollowerIsBehind) {
  EXPECT_EQ(culprit({at(8, 5), at(8, 6), at(8, 7)}, kSchedule),
            "vehicle_0 (leader) has sent nothing since step 5 (realizations from 8)");
  EXPECT_EQ(culprit({at(8, 9), at(8, 9), at(8, 9)}, kSchedule),
            "vehicle_0 (leader) has sent nothing since step 9 (realizations from 8)");
  EXPECT_EQ(culprit({kNone, kNone, kNone}, kSchedule), "vehicle_0 (leader) has sent nothing at all");
}

TEST(StallDiagnosis, CountsTheOtherFollowersThatAreBehind) {
  EXPECT_EQ(culprit({at(8, 9), at(8, 7), at(8, 8), at(8, 6), at(8, 7)}, kSchedule),
            "vehicle_1 has sent nothing since step 7 (realizations from 8); the same holds for 1 more");
}

TEST(StallDiagnosis, NamesAFollowerInAnEndlessRun) {
  EXPECT_EQ(culprit({at(0, 500), at(0, 501), at(0, 40), at(0, 41)}, BatchSchedule{1, 1, 0}),
            "vehicle_2 has sent nothing since step 40 (realizations from 0)");
}

}  // namespace
}  // namespace platoon
