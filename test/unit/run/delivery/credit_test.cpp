#include "stochastic_platoon/run/delivery/credit.hpp"

#include <gtest/gtest.h>

#include "unit/run/delivery/credit_fixture.hpp"

namespace platoon {
namespace {

TEST(Credit, GivesNothingUntilEveryReceiverHasReported) {
  Credit credit(kSchedule, kLimits, {kMonitor, kRecorder});
  EXPECT_TRUE(published(credit).empty());
  EXPECT_TRUE(credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 0.0));
  EXPECT_TRUE(published(credit).empty());
  EXPECT_EQ(credit.attempt(), 0u);
  EXPECT_FALSE(credit.retry_if_stalled(100.0));
  EXPECT_TRUE(credit.acknowledge(kRecorder, {0, 0, kNothingYet}, 0.0));
  expect_published(published(credit), {{1, 0, -1}});
}

TEST(Credit, IgnoresUnknownReceivers) {
  Credit credit(kSchedule, kLimits, {kMonitor});
  EXPECT_FALSE(credit.acknowledge("stranger", {0, 20, kNothingYet}, 0.0));
  EXPECT_FALSE(credit.complete());
  EXPECT_TRUE(published(credit).empty());
}

TEST(Credit, IsOneStepUntilTheFirstIsAcknowledged) {
  Credit credit = with_monitor();
  expect_published(published(credit), {{1, 0, -1}});
  EXPECT_TRUE(published(credit, 0.1).empty());
  credit.acknowledge(kMonitor, {1, 0, kNothingYet}, 0.1);  // knows the attempt, has no complete step of it
  EXPECT_TRUE(published(credit, 0.1).empty());
}

TEST(Credit, IsAWindowAfterTheFirstAcknowledgement) {
  Credit credit = under_way();
  expect_published(published(credit), {{1, 0, 0}, {1, 0, 1}, {1, 0, 2}, {1, 8, -1}, {1, 8, 0}});
}

TEST(Credit, GrowsWithCumulativeAcknowledgements) {
  Credit credit = under_way();
  EXPECT_EQ(published(credit).size(), 5u);
  credit.acknowledge(kMonitor, {1, 0, 0}, 0.0);
  expect_published(published(credit), {{1, 8, 1}});
  credit.acknowledge(kMonitor, {1, 8, kNothingYet}, 0.0);  // steps 1 and 2: the batch is committed
  expect_published(published(credit), {{1, 8, 2}, {1, 16, -1}});
  credit.acknowledge(kMonitor, {1, 8, kNothingYet}, 0.0);
  EXPECT_TRUE(published(credit).empty());
  credit.acknowledge(kMonitor, {1, 8, -1}, 0.0);
  expect_published(published(credit), {{1, 16, 0}});
}

TEST(Credit, CoversEveryStepOfEveryBatchOnce) {
  Credit credit = with_monitor();
  std::vector<MessageId> all;
  for (int round = 0; round < 100 && !credit.complete(); ++round) {
    const std::vector<MessageId> some = published(credit);
    EXPECT_LE(some.size(), 5u);
    all.insert(all.end(), some.begin(), some.end());
    const MessageId& last = all.back();
    credit.acknowledge(kMonitor,
                       kSchedule.is_last_step(last.step)
                           ? Acknowledgement{1, kSchedule.next(last.first_realization), kNothingYet}
                           : last,
                       0.0);
  }
  EXPECT_TRUE(credit.complete());
  std::vector<MessageId> expected;
  for (const std::uint64_t first : {0, 8, 16}) {
    for (const std::int64_t step : {-1, 0, 1, 2}) expected.push_back({1, first, step});
  }
  expect_published(all, expected);
  EXPECT_TRUE(published(credit).empty());
  EXPECT_FALSE(credit.retry_if_stalled(1e6));
}

TEST(Credit, ContinuesFromTheReportsOfTheReceivers) {
  Credit credit(kSchedule, kLimits, {kMonitor});
  credit.acknowledge(kMonitor, {4, 5, kNothingYet}, 0.0);  // resumed, with other batches than before
  expect_published(published(credit), {{5, 5, -1}});
  credit.acknowledge(kMonitor, {5, 5, -1}, 0.0);
  expect_published(published(credit), {{5, 5, 0}, {5, 5, 1}, {5, 5, 2}, {5, 13, -1}, {5, 13, 0}});
  credit.acknowledge(kMonitor, {5, 13, 0}, 0.0);
  expect_published(published(credit), {{5, 13, 1}, {5, 13, 2}});
  credit.acknowledge(kMonitor, {5, 20, kNothingYet}, 0.0);
  EXPECT_TRUE(credit.complete());
}

TEST(Credit, IsCompleteIfEverythingHasArrivedBefore) {
  Credit credit(kSchedule, kLimits, {kMonitor});
  credit.acknowledge(kMonitor, {3, 20, kNothingYet}, 0.0);
  EXPECT_TRUE(credit.complete());
  EXPECT_TRUE(published(credit).empty());
  EXPECT_FALSE(credit.retry_if_stalled(100.0));
}

TEST(Credit, StartsAtTheEarliestBatchThatAnyReceiverNeeds) {
  for (const bool monitor_is_ahead : {true, false}) {
    Credit credit(kSchedule, kLimits, {kMonitor, kRecorder});
    credit.acknowledge(monitor_is_ahead ? kMonitor : kRecorder, {0, 16, kNothingYet}, 0.0);
    credit.acknowledge(monitor_is_ahead ? kRecorder : kMonitor, {0, 8, kNothingYet}, 0.0);
    expect_published(published(credit), {{1, 8, -1}});
  }
}

TEST(Credit, OfAShorterLastBatchEqualsThatOfAWholeOne) {
  Credit credit(kSchedule, kLimits, {kMonitor, kRecorder});
  for (const std::string& name : {kMonitor, kRecorder}) credit.acknowledge(name, {0, 16, kNothingYet}, 0.0);
  EXPECT_EQ(published(credit).size(), 1u);
  for (const std::string& name : {kMonitor, kRecorder}) credit.acknowledge(name, {1, 16, -1}, 0.0);
  expect_published(published(credit), {{1, 16, 0}, {1, 16, 1}, {1, 16, 2}});
  credit.acknowledge(kMonitor, {1, 16, 1}, 0.0);
  credit.acknowledge(kMonitor, {1, 20, kNothingYet}, 0.0);
  EXPECT_EQ(credit.attempt(), 1u) << "nothing was lost";
  credit.acknowledge(kRecorder, {1, 20, kNothingYet}, 0.0);
  EXPECT_TRUE(credit.complete());
}

TEST(Credit, OfTwoReceiversIsThatOfTheSlowerOne) {
  Credit credit(kSchedule, kLimits, {kMonitor, kRecorder});
  for (const std::string& name : {kMonitor, kRecorder}) credit.acknowledge(name, {0, 0, kNothingYet}, 0.0);
  expect_published(published(credit), {{1, 0, -1}});
  credit.acknowledge(kMonitor, {1, 0, -1}, 0.0);
  EXPECT_TRUE(published(credit).empty());
  credit.acknowledge(kRecorder, {1, 0, -1}, 0.0);
  EXPECT_EQ(published(credit).size(), 5u);
  credit.acknowledge(kMonitor, {1, 8, 0}, 0.0);
  EXPECT_TRUE(published(credit).empty());
  credit.acknowledge(kRecorder, {1, 0, 1}, 0.0);
  expect_published(published(credit), {{1, 8, 1}, {1, 8, 2}});
}

TEST(Credit, IsCompleteOnceBothReceiversAre) {
  Credit credit(kSchedule, kLimits, {kMonitor, kRecorder});
  credit.acknowledge(kMonitor, {1, 20, kNothingYet}, 0.0);
  EXPECT_FALSE(credit.complete());
  credit.acknowledge(kRecorder, {1, 16, 2}, 0.0);
  EXPECT_FALSE(credit.complete());
  credit.acknowledge(kRecorder, {1, 20, kNothingYet}, 0.0);
  EXPECT_TRUE(credit.complete());
}

TEST(Credit, OfAnEndlessRunNeverEnds) {
  Credit credit = with_monitor({1, 1, 0});
  expect_published(published(credit), {{1, 0, -1}});
  std::int64_t last = -1;
  for (int round = 0; round < 200; ++round) {
    credit.acknowledge(kMonitor, {1, 0, last}, 0.0);
    for (const MessageId& turn : published(credit)) {
      EXPECT_EQ(turn.first_realization, 0u);
      EXPECT_EQ(turn.step, ++last);
    }
  }
  EXPECT_EQ(last, -1 + 200 * 5);
  EXPECT_FALSE(credit.complete());
  expect_retry_at(credit, 2.0, {2, 0, -1});
}

TEST(Credit, CountsBatchesOfOneStep) {
  Credit credit = with_monitor({3, 1, 1});
  expect_published(published(credit), {{1, 0, -1}});
  credit.acknowledge(kMonitor, {1, 0, -1}, 0.0);
  expect_published(published(credit), {{1, 0, 0}, {1, 1, -1}, {1, 1, 0}, {1, 2, -1}, {1, 2, 0}});
  credit.acknowledge(kMonitor, {1, 2, -1}, 0.0);
  EXPECT_TRUE(published(credit).empty());
  EXPECT_FALSE(credit.complete());
}

}  // namespace
}  // namespace platoon
