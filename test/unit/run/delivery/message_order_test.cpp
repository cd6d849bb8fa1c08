#include "stochastic_platoon/run/delivery/message_order.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>

#include "unit/run/delivery/message_ids.hpp"

namespace platoon {
namespace {

const BatchSchedule kSchedule{20, 8, 3};  // batches at 0, 8 and, of size 4, at 16; steps -1 .. 2

DropReason receive(MessageOrder& order, const MessageId& id) {
  return order.receive({id, kSchedule.size(id.first_realization), true});
}

// Receives the messages of attempt `attempt` from step -1 of the batch at `first` up to `step`.
MessageOrder after(std::uint32_t attempt, std::uint64_t first, std::int64_t step) {
  MessageOrder order(kSchedule);
  for (std::int64_t k = kInitialStep; k <= step; ++k) {
    EXPECT_EQ(receive(order, {attempt, first, k}), DropReason::none);
  }
  return order;
}

void expect_latest(const MessageOrder& order, const MessageId& id) {
  ASSERT_TRUE(order.latest());
  EXPECT_EQ(*order.latest(), id);
}

TEST(MessageOrder, AcceptsEveryStepOfEveryBatchInOrder) {
  MessageOrder order(kSchedule);
  EXPECT_FALSE(order.latest());
  for (const std::uint64_t first : {0, 8, 16}) {
    for (const std::int64_t step : {-1, 0, 1, 2}) {
      EXPECT_EQ(receive(order, {1, first, step}), DropReason::none);
      expect_latest(order, {1, first, step});
    }
  }
  EXPECT_NE(order.receive({{1, 20, -1}, 4, true}), DropReason::none);
  EXPECT_NE(order.receive({{1, 20, -1}, 0, true}), DropReason::none);
}

TEST(MessageOrder, ReportsAMissedStartOfAnAttempt) {
  MessageOrder fresh(kSchedule);
  EXPECT_EQ(receive(fresh, {1, 0, 0}), DropReason::missed_start);
  EXPECT_FALSE(fresh.latest());
  MessageOrder order = after(1, 0, 1);
  EXPECT_EQ(receive(order, {2, 0, 2}), DropReason::missed_start);
  expect_latest(order, {1, 0, 1});
}

TEST(MessageOrder, ReportsGapsAndDuplicatesAsOutOfTurn) {
  MessageOrder order = after(1, 0, 1);
  for (const MessageId& id : {MessageId{1, 0, 1}, MessageId{1, 0, 0}, MessageId{1, 0, -1}, MessageId{1, 0, 3},
                              MessageId{1, 8, 2}, MessageId{1, 8, -1}}) {
    EXPECT_EQ(receive(order, id), DropReason::out_of_turn);
  }
  EXPECT_EQ(receive(order, {1, 0, 2}), DropReason::none);
}

TEST(MessageOrder, ReportsABatchThatIsNotDueAsOutOfTurn) {
  MessageOrder order = after(1, 0, 2);
  for (const MessageId& id : {MessageId{1, 0, 3}, MessageId{1, 0, -1}, MessageId{1, 16, -1}, MessageId{1, 8, 0}}) {
    EXPECT_EQ(receive(order, id), DropReason::out_of_turn);
  }
  EXPECT_EQ(receive(order, {1, 8, -1}), DropReason::none);
}

TEST(MessageOrder, AcceptsANewerAttemptFromItsInitialStepAtAnyBatch) {
  for (const std::uint64_t first : {0, 8, 16}) {
    MessageOrder order = after(3, 0, 1);
    EXPECT_EQ(receive(order, {7, first, -1}), DropReason::none);
    EXPECT_EQ(receive(order, {7, first, 0}), DropReason::none);
  }
}

TEST(MessageOrder, ReportsAnOlderAttemptAsStale) {
  MessageOrder order = after(3, 0, 1);
  for (const std::int64_t step : {-1, 0, 2}) EXPECT_EQ(receive(order, {2, 0, step}), DropReason::stale);
  EXPECT_EQ(receive(order, {3, 0, 2}), DropReason::none);
}

TEST(MessageOrder, RejectsAnAttemptBeyondTheLast) {
  for (const std::uint32_t attempt :
       {kLastAttempt + 1, std::uint32_t{1} << 31, std::numeric_limits<std::uint32_t>::max()}) {
    MessageOrder order = after(3, 0, 1);
    for (const std::int64_t step : {-1, 2}) {
      EXPECT_EQ(receive(order, {attempt, 0, step}), DropReason::out_of_turn);
      EXPECT_FALSE(order.has_missed(DropReason::out_of_turn, {attempt, 0, step}, 0)) << "no such message";
    }
    EXPECT_EQ(receive(order, {3, 0, 2}), DropReason::none);
    EXPECT_EQ(receive(order, {4, 0, -1}), DropReason::none);
  }
  MessageOrder order = after(kLastAttempt, 0, 2);
  EXPECT_EQ(receive(order, {kLastAttempt, 8, -1}), DropReason::none);
}

TEST(MessageOrder, RejectsAWrongBatchSizeAndAcceptsTheRightOneAfterIt) {
  MessageOrder order = after(1, 0, 1);
  for (const std::size_t size : {0, 1, 7, 9}) {
    EXPECT_EQ(order.receive({{1, 0, 2}, size, true}), DropReason::wrong_size);
  }
  EXPECT_EQ(receive(order, {1, 0, 2}), DropReason::none);
  MessageOrder last = after(1, 8, 2);
  EXPECT_EQ(last.receive({{1, 16, -1}, 8, true}), DropReason::wrong_size);
  EXPECT_EQ(last.receive({{1, 16, -1}, 4, true}), DropReason::none);
}

TEST(MessageOrder, RejectsRealizationsBeyondTheLast) {
  MessageOrder order(kSchedule);
  EXPECT_EQ(order.receive({{1, 20, -1}, 0, true}), DropReason::wrong_size);
  EXPECT_EQ(order.receive({{1, 24, -1}, 8, true}), DropReason::wrong_size);
  EXPECT_FALSE(order.latest());
}

TEST(MessageOrder, RejectsPositionsThatAreNotFinite) {
  MessageOrder order = after(1, 0, 1);
  EXPECT_EQ(order.receive({{1, 0, 2}, 8, false}), DropReason::not_finite);
  EXPECT_EQ(receive(order, {1, 0, 2}), DropReason::none);
}

TEST(MessageOrder, RecognizesLostMessages) {
  MessageOrder late(kSchedule);  // came up during attempt 1
  EXPECT_FALSE(late.has_missed(DropReason::missed_start, {1, 0, 1}, 2)) << "a step that start-up explains";
  EXPECT_TRUE(late.has_missed(DropReason::missed_start, {1, 0, 2}, 2));
  const MessageOrder order = after(2, 8, 0);
  EXPECT_TRUE(order.has_missed(DropReason::out_of_turn, {2, 8, 2}, 0)) << "a gap";
  EXPECT_TRUE(order.has_missed(DropReason::out_of_turn, {2, 16, -1}, 0)) << "the end of a batch";
  EXPECT_FALSE(order.has_missed(DropReason::out_of_turn, {2, 8, -1}, 0)) << "a duplicate";
  EXPECT_FALSE(order.has_missed(DropReason::stale, {1, 8, 2}, 0));
  EXPECT_FALSE(order.has_missed(DropReason::none, {2, 8, 0}, 0));
  EXPECT_FALSE(order.has_missed(DropReason::missed_start, {3, 28, 1}, 0)) << "no such message";
}

TEST(MessageOrder, OfAnEndlessRunHasOneBatch) {
  MessageOrder order(BatchSchedule{1, 1, 0});
  for (std::int64_t step = -1; step < 1000; ++step) {
    EXPECT_EQ(order.receive({{1, 0, step}, 1, true}), DropReason::none);
  }
  EXPECT_EQ(order.receive({{1, 0, -1}, 1, true}), DropReason::out_of_turn);
}

TEST(MessageOrder, ContinuesFromARealizationWithinABatch) {
  MessageOrder order(kSchedule);
  for (std::int64_t step = -1; step < 3; ++step) {
    EXPECT_EQ(order.receive({{1, 5, step}, 8, true}), DropReason::none);
  }
  EXPECT_EQ(order.receive({{1, 13, -1}, 7, true}), DropReason::none);
}

TEST(DropReason, HasDifferentNames) {
  std::set<std::string> words;
  for (std::size_t v = 0; v < kDropReasons; ++v) words.insert(to_string(static_cast<DropReason>(v)));
  EXPECT_EQ(words.size(), kDropReasons);
  EXPECT_EQ(words.count("unknown"), 0u);
}

}  // namespace
}  // namespace platoon
