#include "stochastic_platoon/run/delivery/credit.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

const BatchSchedule kSchedule{20, 8, 3};  // batches at 0, 8 and 16, four steps each
const CreditLimits kLimits{5, 2.0, 0.5};
const std::string kMonitor = "monitor";

std::vector<MessageId> published(Credit& credit, double now = 0.0) {
  std::vector<MessageId> ids;
  while (const std::optional<MessageId> id = credit.next(now)) {
    ids.push_back(*id);
    if (ids.size() > 1000) break;
  }
  return ids;
}

void expect_published(const std::vector<MessageId>& found, const std::vector<MessageId>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t j = 0; j < found.size(); ++j) {
    EXPECT_EQ(found[j].attempt, expected[j].attempt) << j;
    EXPECT_EQ(found[j].first_realization, expected[j].first_realization) << j;
    EXPECT_EQ(found[j].step, expected[j].step) << j;
  }
}

Credit with_monitor() {
  Credit credit(kSchedule, kLimits, {kMonitor});
  EXPECT_TRUE(credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 0.0));
  return credit;
}

// The first attempt has begun, and its initial step is acknowledged.
Credit under_way(double now = 0.0) {
  Credit credit = with_monitor();
  expect_published(published(credit, now), {{1, 0, -1}});
  credit.acknowledge(kMonitor, {1, 0, -1}, now);
  return credit;
}

// Expects a stall at `now`, not before, and a new attempt that begins at `turn`.
void expect_retry_at(Credit& credit, double now, const MessageId& turn) {
  EXPECT_FALSE(credit.retry_if_stalled(now - 1e-9));
  EXPECT_TRUE(credit.retry_if_stalled(now + 1e-9));
  EXPECT_EQ(credit.attempt(), turn.attempt);
  expect_published(published(credit, now), {turn});
}

TEST(Credit, GivesNothingUntilEveryReceiverHasReported) {
  Credit credit(kSchedule, kLimits, {"monitor", "recorder"});
  EXPECT_TRUE(published(credit).empty());
  EXPECT_TRUE(credit.acknowledge("monitor", {0, 0, kNothingYet}, 0.0));
  EXPECT_TRUE(published(credit).empty());
  EXPECT_EQ(credit.attempt(), 0u);
  EXPECT_FALSE(credit.retry_if_stalled(100.0));
  EXPECT_TRUE(credit.acknowledge("recorder", {0, 0, kNothingYet}, 0.0));
  expect_published(published(credit), {{1, 0, -1}});
}

TEST(Credit, IgnoresReceiversItDoesNotKnow) {
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

TEST(Credit, LastsForEveryStepOfEveryBatchAndNoMore) {
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

TEST(Credit, GoesOnFromWhereTheReceiversAre) {
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

TEST(Credit, IsNotNeededWhenEverythingIsThereAlready) {
  Credit credit(kSchedule, kLimits, {kMonitor});
  credit.acknowledge(kMonitor, {3, 20, kNothingYet}, 0.0);
  EXPECT_TRUE(credit.complete());
  EXPECT_TRUE(published(credit).empty());
  EXPECT_FALSE(credit.retry_if_stalled(100.0));
}

TEST(Credit, BeginsAgainAtTheEarliestNeededRealizationWhenItStalls) {
  Credit credit = under_way(10.0);
  published(credit, 10.0);
  credit.acknowledge(kMonitor, {1, 8, kNothingYet}, 11.0);
  expect_retry_at(credit, 13.0, {2, 8, -1});
  EXPECT_TRUE(published(credit, 13.0).empty()) << "one step until the new attempt is acknowledged";
  credit.acknowledge(kMonitor, {2, 8, -1}, 13.1);
  EXPECT_EQ(published(credit, 13.1).size(), 5u);
}

TEST(Credit, IsNotStalledWhileThereIsProgress) {
  Credit credit = under_way();
  published(credit);
  for (std::int64_t step = 0; step < 2; ++step) {
    const double now = 1.9 * static_cast<double>(step + 1);
    EXPECT_FALSE(credit.retry_if_stalled(now));
    credit.acknowledge(kMonitor, {1, 0, step}, now);
  }
  EXPECT_FALSE(credit.retry_if_stalled(5.7));
}

TEST(Credit, IsStalledByReportsThatTellNothingNew) {
  Credit credit = under_way();
  published(credit);
  for (int j = 1; j < 20; ++j) credit.acknowledge(kMonitor, {1, 0, -1}, 0.1 * j);
  EXPECT_TRUE(credit.retry_if_stalled(2.0));
}

// The first step of a long string takes longer than any timeout on a whole step.
TEST(Credit, IsNotStalledWhileMessagesOfAStepArrive) {
  Credit credit = with_monitor();
  expect_published(published(credit), {{1, 0, -1}});
  double now = 0.0;
  for (std::uint64_t messages = 1; messages <= 50; ++messages) {
    now += 0.4;
    credit.acknowledge(kMonitor, {1, 0, kNothingYet}, now, messages);
    EXPECT_FALSE(credit.retry_if_stalled(now));
  }
  credit.acknowledge(kMonitor, {1, 0, kNothingYet}, now + 0.4, 50);
  EXPECT_TRUE(credit.retry_if_stalled(now + 0.5)) << "a report that tells nothing new is no progress";
}

// If a follower of a paced run is down, each new step of the leader still reaches the vehicles before this follower.
TEST(Credit, IsStalledWhereOnlyTheLeadersNewStepsArrive) {
  Credit credit = under_way();
  std::uint64_t messages = 10;
  for (double now = 0.5; now <= 2.0; now += 0.5) {
    EXPECT_TRUE(credit.next(now));
    EXPECT_FALSE(credit.retry_if_stalled(now));
    credit.acknowledge(kMonitor, {1, 0, -1}, now, ++messages);
  }
  expect_retry_at(credit, 0.5 + kLimits.stall_timeout, {2, 0, -1});
}

TEST(Credit, WaitsAsLongForTheHundredthStallAsForTheFirstOnceStepsHaveFlowedBetween) {
  Credit credit(BatchSchedule{1, 1, 0}, kLimits, {kMonitor});  // endless: no batch completes
  credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 0.0);
  published(credit);
  double now = 0.0;
  for (std::uint32_t attempt = 1; attempt <= 100; ++attempt) {
    for (std::int64_t step = -1; step < 8; ++step) {
      credit.acknowledge(kMonitor, {attempt, 0, step}, now);
      published(credit, now);
      now += 0.5;
    }
    credit.acknowledge(kMonitor, {attempt, 0, 8}, now);
    published(credit, now);
    now += 2.0;  // kLimits' timeout
    expect_retry_at(credit, now, {attempt + 1, 0, -1});
  }
}

TEST(Credit, IsNotStalledWhenNothingIsOnItsWay) {
  Credit credit = under_way();
  EXPECT_FALSE(credit.retry_if_stalled(1e6));
  ASSERT_TRUE(credit.next(1e6));  // a slow pace: the wait for an answer begins here
  EXPECT_FALSE(credit.retry_if_stalled(1e6 + 1.9));
  EXPECT_TRUE(credit.retry_if_stalled(1e6 + 2.0));
}

TEST(Credit, WaitsLongerForEveryStallUntilABatchIsThrough) {
  Credit credit = under_way();
  published(credit);
  double now = 0.0;
  double patience = 2.0;
  for (std::uint32_t attempt = 2; attempt < 6; ++attempt) {
    now += patience;
    expect_retry_at(credit, now, {attempt, 0, -1});
    credit.acknowledge(kMonitor, {attempt, 0, -1}, now);
    published(credit, now);
    credit.acknowledge(kMonitor, {attempt, 0, 1}, now);  // progress, but the batch is incomplete
    patience *= 1.5;
  }
  credit.acknowledge(kMonitor, {5, 8, kNothingYet}, now);
  published(credit, now);
  expect_retry_at(credit, now + 2.0, {6, 8, -1});
}

TEST(Credit, WaitsForTheFirstAnswerOfAnAttemptWithAPatienceOfItsOwn) {
  Credit credit = with_monitor();
  expect_published(published(credit), {{1, 0, -1}});
  double now = 0.0;
  double patience = 0.5;
  for (std::uint32_t attempt = 2; attempt < 12; ++attempt) {
    now += patience;
    expect_retry_at(credit, now, {attempt, 0, -1});
    patience = std::min(1.5 * patience, 3.0);  // the bound limits the delay of nodes that come up late
  }
  credit.acknowledge(kMonitor, {11, 0, -1}, now);
  published(credit, now);
  expect_retry_at(credit, now + 2.0, {12, 0, -1});
  expect_retry_at(credit, now + 2.5, {13, 0, -1});
}

TEST(Credit, BeginsAgainAtOnceWhenAReceiverHasLostWhatItHad) {
  Credit credit = under_way();
  published(credit);
  credit.acknowledge(kMonitor, {1, 8, 0}, 0.1);
  credit.acknowledge(kMonitor, {1, 0, kNothingYet}, 0.2);  // restarted from an older checkpoint
  EXPECT_EQ(credit.attempt(), 2u);
  expect_published(published(credit, 0.2), {{2, 0, -1}});
}

TEST(Credit, BeginsAgainAtOnceWhenAVehicleHasMissedMessagesOfTheAttemptUnderWay) {
  Credit credit = under_way();
  published(credit);
  credit.give_up(1, 0.1);
  expect_published(published(credit, 0.1), {{2, 0, -1}});
  credit.give_up(1, 0.2);  // a later report from another vehicle
  EXPECT_EQ(credit.attempt(), 2u);
  credit.give_up(2, 0.3);
  EXPECT_EQ(credit.attempt(), 2u) << "nothing has flowed yet";
}

TEST(Credit, BeginsAgainAtOnceWhenAReceiverHasLostMessagesOfAStep) {
  Credit credit = under_way();
  published(credit);
  credit.acknowledge(kMonitor, {1, 0, 0}, 0.1, 9);
  credit.acknowledge(kMonitor, {1, 0, 0}, 0.2, 8);
  expect_published(published(credit, 0.2), {{2, 0, -1}});
}

TEST(Credit, BeginsAgainAtOnceWhenAReceiverComesBackAfterTheNextAttemptHasBegun) {
  Credit credit = under_way();
  published(credit);
  credit.acknowledge(kMonitor, {1, 0, 1}, 0.1);
  ASSERT_TRUE(credit.retry_if_stalled(100.0));  // it is down
  published(credit, 100.0);
  credit.acknowledge(kMonitor, {1, 0, kNothingYet}, 101.0);
  expect_published(published(credit, 101.0), {{3, 0, -1}});
}

TEST(Credit, BeginsAgainAtOnceWhenAReceiverComesBackFromBeforeTheAttempt) {
  Credit credit = under_way();
  published(credit);
  credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 0.2);
  expect_published(published(credit, 0.2), {{2, 0, -1}});
}

TEST(Credit, TakesReportsThatAreLateForNoLoss) {
  Credit credit = under_way();
  published(credit);
  EXPECT_TRUE(credit.retry_if_stalled(2.0));
  expect_published(published(credit, 2.0), {{2, 0, -1}});
  credit.acknowledge(kMonitor, {1, 0, 1}, 2.1);
  EXPECT_EQ(credit.attempt(), 2u);
  EXPECT_TRUE(published(credit, 2.1).empty()) << "what an older attempt brought is no credit for this one";
  credit.acknowledge(kMonitor, {2, 0, -1}, 2.2);
  EXPECT_EQ(published(credit, 2.2).size(), 5u);
}

TEST(Credit, OfARestartedLeaderBeginsPastEveryAttemptTheReceiversKnow) {
  Credit credit(kSchedule, kLimits, {"monitor", "recorder"});
  credit.acknowledge("monitor", {7, 8, 1}, 0.0);
  credit.acknowledge("recorder", {6, 8, kNothingYet}, 0.0);
  expect_published(published(credit), {{8, 8, -1}});
}

TEST(Credit, BeginsAgainAtTheEarliestRealizationAnyReceiverNeeds) {
  for (const bool monitor_is_ahead : {true, false}) {
    Credit credit(kSchedule, kLimits, {"monitor", "recorder"});
    credit.acknowledge(monitor_is_ahead ? "monitor" : "recorder", {0, 16, kNothingYet}, 0.0);
    credit.acknowledge(monitor_is_ahead ? "recorder" : "monitor", {0, 8, kNothingYet}, 0.0);
    expect_published(published(credit), {{1, 8, -1}});
  }
}

TEST(Credit, OfTheShorterLastBatchIsThatOfAWholeOne) {
  Credit credit(kSchedule, kLimits, {"monitor", "recorder"});
  for (const char* name : {"monitor", "recorder"}) credit.acknowledge(name, {0, 16, kNothingYet}, 0.0);
  EXPECT_EQ(published(credit).size(), 1u);
  for (const char* name : {"monitor", "recorder"}) credit.acknowledge(name, {1, 16, -1}, 0.0);
  expect_published(published(credit), {{1, 16, 0}, {1, 16, 1}, {1, 16, 2}});
  credit.acknowledge("monitor", {1, 16, 1}, 0.0);
  credit.acknowledge("monitor", {1, 20, kNothingYet}, 0.0);
  EXPECT_EQ(credit.attempt(), 1u) << "nothing was lost";
  credit.acknowledge("recorder", {1, 20, kNothingYet}, 0.0);
  EXPECT_TRUE(credit.complete());
}

TEST(Credit, OfTwoReceiversIsThatOfTheSlowerOne) {
  Credit credit(kSchedule, kLimits, {"monitor", "recorder"});
  for (const char* name : {"monitor", "recorder"}) credit.acknowledge(name, {0, 0, kNothingYet}, 0.0);
  expect_published(published(credit), {{1, 0, -1}});
  credit.acknowledge("monitor", {1, 0, -1}, 0.0);
  EXPECT_TRUE(published(credit).empty());
  credit.acknowledge("recorder", {1, 0, -1}, 0.0);
  EXPECT_EQ(published(credit).size(), 5u);
  credit.acknowledge("monitor", {1, 8, 0}, 0.0);
  EXPECT_TRUE(published(credit).empty());
  credit.acknowledge("recorder", {1, 0, 1}, 0.0);
  expect_published(published(credit), {{1, 8, 1}, {1, 8, 2}});
}

TEST(Credit, IsCompleteWhenBothReceiversAre) {
  Credit credit(kSchedule, kLimits, {"monitor", "recorder"});
  credit.acknowledge("monitor", {1, 20, kNothingYet}, 0.0);
  EXPECT_FALSE(credit.complete());
  credit.acknowledge("recorder", {1, 16, 2}, 0.0);
  EXPECT_FALSE(credit.complete());
  credit.acknowledge("recorder", {1, 20, kNothingYet}, 0.0);
  EXPECT_TRUE(credit.complete());
}

TEST(Credit, OfAnEndlessRunNeverEnds) {
  Credit credit(BatchSchedule{1, 1, 0}, kLimits, {kMonitor});
  credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 0.0);
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

TEST(Credit, OfOneStepPerBatchIsCountedRight) {
  Credit credit(BatchSchedule{3, 1, 1}, kLimits, {kMonitor});
  credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 0.0);
  expect_published(published(credit), {{1, 0, -1}});
  credit.acknowledge(kMonitor, {1, 0, -1}, 0.0);
  expect_published(published(credit), {{1, 0, 0}, {1, 1, -1}, {1, 1, 0}, {1, 2, -1}, {1, 2, 0}});
  credit.acknowledge(kMonitor, {1, 2, -1}, 0.0);
  EXPECT_TRUE(published(credit).empty());
  EXPECT_FALSE(credit.complete());
}

// A real car cannot return to its initial position.
TEST(Credit, WithoutAStallTimeoutBeginsNothingAgainOnceStepsFlow) {
  Credit credit(kSchedule, {5, 0.0, 0.5}, {kMonitor});
  credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 0.0);
  expect_published(published(credit), {{1, 0, -1}});
  EXPECT_TRUE(credit.retry_if_stalled(1.0)) << "links are still coming up";
  expect_published(published(credit, 1.0), {{2, 0, -1}});
  credit.acknowledge(kMonitor, {2, 0, -1}, 1.0);
  published(credit, 1.0);
  EXPECT_FALSE(credit.retry_if_stalled(1e6));
  credit.give_up(2, 1e6);
  credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 1e6);  // it was killed
  EXPECT_EQ(credit.attempt(), 2u);
  EXPECT_TRUE(published(credit, 1e6).empty());
}

TEST(Credit, OfALeaderThatComesUpWithoutAStallTimeoutLeavesAPlatoonThatHasMovedAlone) {
  Credit moved(kSchedule, {5, 0.0, 0.5}, {kMonitor});
  moved.acknowledge(kMonitor, {1, 0, 1}, 0.0);
  EXPECT_TRUE(published(moved).empty());
  Credit at_rest(kSchedule, {5, 0.0, 0.5}, {kMonitor});
  at_rest.acknowledge(kMonitor, {1, 8, kNothingYet}, 0.0);
  expect_published(published(at_rest), {{2, 8, -1}});
}

}  // namespace
}  // namespace platoon
