// When the leader starts a new attempt.

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "unit/run/delivery/credit_fixture.hpp"

namespace platoon {
namespace {

TEST(CreditRetry, StartsANewAttemptAtTheFirstUncommittedBatchIfItStalls) {
  Credit credit = under_way(10.0);
  published(credit, 10.0);
  credit.acknowledge(kMonitor, {1, 8, kNothingYet}, 11.0);
  expect_retry_at(credit, 13.0, {2, 8, -1});
  EXPECT_TRUE(published(credit, 13.0).empty()) << "one step until the new attempt is acknowledged";
  credit.acknowledge(kMonitor, {2, 8, -1}, 13.1);
  EXPECT_EQ(published(credit, 13.1).size(), 5u);
}

TEST(CreditRetry, IsNotStalledWhileThereIsProgress) {
  Credit credit = under_way();
  published(credit);
  for (std::int64_t step = 0; step < 2; ++step) {
    const double now = 1.9 * static_cast<double>(step + 1);
    EXPECT_FALSE(credit.retry_if_stalled(now));
    credit.acknowledge(kMonitor, {1, 0, step}, now);
  }
  EXPECT_FALSE(credit.retry_if_stalled(5.7));
}

TEST(CreditRetry, IsStalledIfReportsShowNoProgress) {
  Credit credit = under_way();
  published(credit);
  for (int j = 1; j < 20; ++j) credit.acknowledge(kMonitor, {1, 0, -1}, 0.1 * j);
  EXPECT_TRUE(credit.retry_if_stalled(2.0));
}

// The first step of a long string takes longer than any timeout on a whole step.
TEST(CreditRetry, IsNotStalledWhileMessagesOfAStepArrive) {
  Credit credit = with_monitor();
  expect_published(published(credit), {{1, 0, -1}});
  double now = 0.0;
  for (std::uint64_t messages = 1; messages <= 50; ++messages) {
    now += 0.4;
    credit.acknowledge(kMonitor, {1, 0, kNothingYet}, now, messages);
    EXPECT_FALSE(credit.retry_if_stalled(now));
  }
  credit.acknowledge(kMonitor, {1, 0, kNothingYet}, now + 0.4, 50);
  EXPECT_TRUE(credit.retry_if_stalled(now + 0.5)) << "no progress";
}

// If a follower of a paced run is down, each new step of the leader still reaches the vehicles before this follower.
TEST(CreditRetry, IsStalledIfOnlyNewStepsOfTheLeaderArrive) {
  Credit credit = under_way();
  std::uint64_t messages = 10;
  for (double now = 0.5; now <= 2.0; now += 0.5) {
    EXPECT_TRUE(credit.next(now));
    EXPECT_FALSE(credit.retry_if_stalled(now));
    credit.acknowledge(kMonitor, {1, 0, -1}, now, ++messages);
  }
  expect_retry_at(credit, 0.5 + kLimits.stall_timeout, {2, 0, -1});
}

TEST(CreditRetry, HasTheSameTimeoutForTheHundredthStallIfStepsArriveBetween) {
  Credit credit = with_monitor({1, 1, 0});  // endless: no batch completes
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

TEST(CreditRetry, IsNotStalledIfNothingIsUnacknowledged) {
  Credit credit = under_way();
  EXPECT_FALSE(credit.retry_if_stalled(1e6));
  ASSERT_TRUE(credit.next(1e6));  // a slow pace: the wait for an answer begins here
  EXPECT_FALSE(credit.retry_if_stalled(1e6 + 1.9));
  EXPECT_TRUE(credit.retry_if_stalled(1e6 + 2.0));
}

TEST(CreditRetry, WaitsLongerAfterEachStallUntilABatchIsComplete) {
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

TEST(CreditRetry, HasASeparateTimeoutForTheFirstStepOfAnAttempt) {
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

// A first step takes 1 s, a hundred times as long as both timeouts.
TEST(CreditRetry, WaitsLongEnoughForASlowFirstStepEvenWithAShortStallTimeout) {
  Credit credit = with_monitor(kSchedule, {5, 0.01, 0.01});
  published(credit);
  double began = 0.0, now = 0.0;
  for (; now - began < 1.0 && now < 100.0; now += 0.005) {
    if (!credit.retry_if_stalled(now)) continue;
    published(credit, now);
    began = now;
  }
  EXPECT_LT(now, 10.0);
  EXPECT_GT(credit.attempt(), 10u);
  credit.acknowledge(kMonitor, {credit.attempt(), 0, -1}, now);
  EXPECT_EQ(published(credit, now).size(), 5u);
}

// Each step takes 0.05 s, five times as long as the timeout.
TEST(CreditRetry, CompletesALongBatchOfStepsThatTakeLongerThanTheStallTimeout) {
  Credit credit = with_monitor({8, 8, 200}, {5, 0.01, 0.01});
  double now = 0.0, begun = 0.0;
  std::deque<MessageId> waiting;
  while (!credit.complete() && now < 600.0) {
    now += 0.002;
    if (credit.retry_if_stalled(now)) waiting.clear();
    for (const MessageId& id : published(credit, now)) {
      if (waiting.empty()) begun = now;
      waiting.push_back(id);
    }
    if (waiting.empty() || now - begun < 0.05) continue;
    const MessageId id = waiting.front();
    waiting.pop_front();
    begun = now;
    credit.acknowledge(kMonitor, id.step == 199 ? MessageId{id.attempt, 8, kNothingYet} : id, now);
  }
  EXPECT_TRUE(credit.complete());
  EXPECT_LT(credit.attempt(), 40u);
}

TEST(CreditRetry, StartsANewAttemptAtOnceIfAReceiverRestarts) {
  Credit credit = under_way();
  published(credit);
  credit.acknowledge(kMonitor, {1, 8, 0}, 0.1);
  credit.acknowledge(kMonitor, {1, 0, kNothingYet}, 0.2);  // restarted from an older checkpoint
  EXPECT_EQ(credit.attempt(), 2u);
  expect_published(published(credit, 0.2), {{2, 0, -1}});
}

TEST(CreditRetry, StartsANewAttemptAtOnceIfAVehicleHasMissedMessages) {
  Credit credit = under_way();
  published(credit);
  EXPECT_TRUE(credit.give_up(1, 0.1));
  expect_published(published(credit, 0.1), {{2, 0, -1}});
  EXPECT_FALSE(credit.give_up(1, 0.2)) << "a later report from another vehicle";
  EXPECT_FALSE(credit.give_up(2, 0.3)) << "nothing has flowed yet";
  EXPECT_EQ(credit.attempt(), 2u);
}

// A step takes 3 s; notices come ten times as often as they may be followed.
TEST(CreditRetry, CompletesASlowBatchBesideAFloodOfNotices) {
  Credit credit = with_monitor();
  double now = 0.0, stepped = 0.0;
  std::deque<MessageId> waiting;
  bool committed = false;
  for (; !committed && now < 600.0; now += 0.01) {
    const std::uint32_t before = credit.attempt();
    credit.give_up(before, now);
    if (credit.attempt() != before) waiting.clear();
    for (const MessageId& id : published(credit, now)) waiting.push_back(id);
    if (now - stepped < 3.0 || waiting.empty()) continue;
    const MessageId id = waiting.front();
    waiting.pop_front();
    stepped = now;
    committed = kSchedule.is_last_step(id.step);
    credit.acknowledge(kMonitor, committed ? MessageId{id.attempt, 8, kNothingYet} : id, now);
  }
  EXPECT_TRUE(committed);
  EXPECT_GT(credit.attempt(), 3u);
  EXPECT_LT(credit.attempt(), 20u);
}

TEST(CreditRetry, StartsANewAttemptAtOnceIfAReceiverHasLostMessagesOfAStep) {
  Credit credit = under_way();
  published(credit);
  credit.acknowledge(kMonitor, {1, 0, 0}, 0.1, 9);
  credit.acknowledge(kMonitor, {1, 0, 0}, 0.2, 8);
  expect_published(published(credit, 0.2), {{2, 0, -1}});
}

TEST(CreditRetry, StartsANewAttemptAtOnceIfAReceiverRestartsDuringTheNextAttempt) {
  Credit credit = under_way();
  published(credit);
  credit.acknowledge(kMonitor, {1, 0, 1}, 0.1);
  ASSERT_TRUE(credit.retry_if_stalled(100.0));  // it is down
  published(credit, 100.0);
  credit.acknowledge(kMonitor, {1, 0, kNothingYet}, 101.0);
  expect_published(published(credit, 101.0), {{3, 0, -1}});
}

TEST(CreditRetry, StartsANewAttemptAtOnceIfAReceiverDoesNotKnowTheAttempt) {
  Credit credit = under_way();
  published(credit);
  credit.acknowledge(kMonitor, {0, 0, kNothingYet}, 0.2);
  expect_published(published(credit, 0.2), {{2, 0, -1}});
}

TEST(CreditRetry, IgnoresLateReportsOfAnOlderAttempt) {
  Credit credit = under_way();
  published(credit);
  EXPECT_TRUE(credit.retry_if_stalled(2.0));
  expect_published(published(credit, 2.0), {{2, 0, -1}});
  credit.acknowledge(kMonitor, {1, 0, 1}, 2.1);
  EXPECT_EQ(credit.attempt(), 2u);
  EXPECT_TRUE(published(credit, 2.1).empty()) << "reports of an older attempt give no credit";
  credit.acknowledge(kMonitor, {2, 0, -1}, 2.2);
  EXPECT_EQ(published(credit, 2.2).size(), 5u);
}

TEST(CreditRetry, OfARestartedLeaderHasANewerAttemptThanAllReports) {
  Credit credit(kSchedule, kLimits, {kMonitor, kRecorder});
  credit.acknowledge(kMonitor, {7, 8, 1}, 0.0);
  credit.acknowledge(kRecorder, {6, 8, kNothingYet}, 0.0);
  expect_published(published(credit), {{8, 8, -1}});
}

// A real car cannot return to its initial position.
TEST(CreditRetry, WithoutAStallTimeoutStartsNoNewAttemptOnceStepsFlow) {
  Credit credit = with_monitor(kSchedule, {5, 0.0, 0.5});
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

TEST(CreditRetry, WithoutAStallTimeoutStartsNoAttemptOfARestartedLeaderIfThePlatoonHasMoved) {
  Credit moved(kSchedule, {5, 0.0, 0.5}, {kMonitor});
  moved.acknowledge(kMonitor, {1, 0, 1}, 0.0);
  EXPECT_TRUE(published(moved).empty());
  Credit at_rest(kSchedule, {5, 0.0, 0.5}, {kMonitor});
  at_rest.acknowledge(kMonitor, {1, 8, kNothingYet}, 0.0);
  expect_published(published(at_rest), {{2, 8, -1}});
}

}  // namespace
}  // namespace platoon
