#include "stochastic_platoon/run/delivery/arrivals.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "unit/messages.hpp"
#include "unit/run/delivery/message_ids.hpp"

namespace platoon {
namespace {

const BatchSchedule kSchedule{20, 8, 3};  // batches at 0, 8 and, of size 4, at 16; steps -1 .. 2
constexpr std::size_t kStreams = 2;

// Arrivals of two streams with a log of their results.
class ArrivalsTest : public testing::Test {
protected:
  void start_from(std::uint64_t committed, std::uint32_t attempt, const BatchSchedule& schedule = kSchedule) {
    schedule_ = schedule;
    arrivals_ = Arrivals(schedule, kStreams, committed, attempt);
  }

  DropReason receive(std::size_t stream, const MessageId& id) {
    const MessageDescriptor descriptor{id, schedule_.size(id.first_realization), true};
    const std::uint32_t before = arrivals_.attempt();
    const DropReason drop = arrivals_.admit(stream, descriptor);
    if (arrivals_.attempt() > before) log_ += "restarted ";
    if (drop != DropReason::none) return drop;
    log_ += "take " + std::to_string(stream) + " ";
    if (const std::optional<CompleteBatch> batch = arrivals_.count(stream, descriptor))
      log_ += formatted("batch %ju of %ju ", std::uintmax_t{batch->first_realization},
                        std::uintmax_t{batch->positions_received});
    return drop;
  }

  // Receives steps `from` to `to` of a batch from one stream.
  void receive_steps_of(std::size_t stream, std::uint32_t attempt, std::uint64_t first, std::int64_t from = -1,
                        std::int64_t to = 2) {
    for (std::int64_t step = from; step <= to; ++step)
      EXPECT_EQ(receive(stream, {attempt, first, step}), DropReason::none) << stream << ": " << first << ", " << step;
  }

  // Receives them from both streams.
  void receive_steps(std::uint32_t attempt, std::uint64_t first, std::int64_t from = -1, std::int64_t to = 2) {
    for (std::size_t stream = 0; stream < kStreams; ++stream) receive_steps_of(stream, attempt, first, from, to);
  }

  void expect_acknowledged(const MessageId& expected) const { EXPECT_EQ(arrivals_.acknowledgement(), expected); }

  // The results since the previous call.
  std::string log() { return std::exchange(log_, ""); }

  BatchSchedule schedule_ = kSchedule;
  std::string log_;
  Arrivals arrivals_{kSchedule, kStreams, 0, 0};
};

TEST_F(ArrivalsTest, ReportARestartThenAMessageThenABatch) {
  start_from(0, 0, {2, 1, 1});
  EXPECT_EQ(receive(1, {1, 0, -1}), DropReason::none);
  EXPECT_EQ(log(), "restarted take 1 ");
  receive(1, {1, 0, 0});
  receive(0, {1, 0, -1});
  EXPECT_EQ(log(), "take 1 take 0 ");
  receive(0, {1, 0, 0});
  EXPECT_EQ(log(), "take 0 batch 0 of 4 ");
}

TEST_F(ArrivalsTest, IgnoreMessagesThatAreNotInTurn) {
  receive_steps(2, 0);
  log();
  for (const MessageId& id :
       {MessageId{1, 8, -1}, MessageId{2, 8, 0}, MessageId{2, 0, 2}, MessageId{3, 8, 1}, MessageId{3, 16, -1}}) {
    EXPECT_NE(receive(0, id), DropReason::none);
  }
  EXPECT_EQ(log(), "");
  EXPECT_EQ(arrivals_.attempt(), 2u);
  expect_acknowledged({2, 8, kNothingYet});
}

TEST_F(ArrivalsTest, AreAcknowledgedUpToTheSlowestStream) {
  expect_acknowledged({0, 0, kNothingYet});
  receive_steps_of(0, 1, 0, -1, 0);
  expect_acknowledged({1, 0, kNothingYet});
  receive(1, {1, 0, -1});
  expect_acknowledged({1, 0, -1});
  receive_steps_of(1, 1, 0, 0, 2);
  receive(1, {1, 8, -1});
  expect_acknowledged({1, 0, 0});
  receive_steps_of(0, 1, 0, 1, 2);
  expect_acknowledged({1, 8, kNothingYet});
  receive(0, {1, 8, -1});
  expect_acknowledged({1, 8, -1});
}

TEST_F(ArrivalsTest, CommitEveryBatchInOrder) {
  for (const std::uint64_t first : {0, 8, 16}) {
    EXPECT_EQ(arrivals_.committed(), first);
    EXPECT_FALSE(arrivals_.complete());
    log();
    receive_steps(1, first);
    EXPECT_TRUE(contains(log(), "batch " + std::to_string(first) + " of " + (first < 16 ? "64 " : "32 ")));
  }
  EXPECT_TRUE(arrivals_.complete());
  EXPECT_EQ(arrivals_.committed(), 20u);
  expect_acknowledged({1, 20, kNothingYet});
}

TEST_F(ArrivalsTest, OfAnUnfinishedBatchAreVoidInANewAttempt) {
  receive_steps(1, 0);
  receive_steps_of(0, 1, 8);
  receive(1, {1, 8, -1});
  log();
  EXPECT_EQ(receive(1, {4, 8, -1}), DropReason::none);
  EXPECT_EQ(log(), "restarted take 1 ");
  EXPECT_EQ(arrivals_.attempt(), 4u);
  EXPECT_EQ(arrivals_.messages(), 1u);
  expect_acknowledged({4, 8, kNothingYet});
  EXPECT_EQ(receive(1, {1, 8, 0}), DropReason::stale);
  EXPECT_EQ(receive(0, {4, 8, -1}), DropReason::none);
  expect_acknowledged({4, 8, -1});
}

// Another receiver may need realizations that this one has committed.
TEST_F(ArrivalsTest, OfCommittedBatchesAreAcknowledgedAgainButNotCounted) {
  receive_steps(1, 0);
  receive_steps(1, 8);
  log();
  receive(0, {2, 0, -1});
  expect_acknowledged({2, 0, kNothingYet});
  receive(1, {2, 0, -1});
  expect_acknowledged({2, 0, -1});
  receive_steps(2, 0, 0, 2);
  expect_acknowledged({2, 8, kNothingYet});
  receive_steps(2, 8);
  expect_acknowledged({2, 16, kNothingYet});
  EXPECT_EQ(arrivals_.committed(), 16u);
  EXPECT_FALSE(contains(log(), "batch"));
  receive_steps(2, 16);
  EXPECT_TRUE(contains(log(), "batch 16 of 32 "));
  EXPECT_TRUE(arrivals_.complete());
}

TEST_F(ArrivalsTest, AreAcknowledgedIfEverythingIsCommitted) {
  start_from(20, 3);
  expect_acknowledged({3, 20, kNothingYet});
  receive_steps(4, 5);
  expect_acknowledged({4, 13, kNothingYet});
  receive_steps(4, 13);
  expect_acknowledged({4, 20, kNothingYet});
  EXPECT_FALSE(contains(log(), "batch"));
}

TEST_F(ArrivalsTest, RejectAnAttemptWhoseBatchesDoNotMeetTheCommittedOnes) {
  start_from(8, 1);
  EXPECT_EQ(receive(0, {2, 16, -1}), DropReason::out_of_turn);
  EXPECT_EQ(receive(0, {2, 3, -1}), DropReason::out_of_turn);
  EXPECT_EQ(receive(0, {2, 0, -1}), DropReason::none);
  EXPECT_EQ(receive(0, {3, 8, -1}), DropReason::none);
}

// A receiver restarts in the middle of an attempt, and its links come up one after the other.
// The leader could begin no attempt after it, and all of its messages would be stale.
TEST_F(ArrivalsTest, RejectAnAttemptAfterWhichThereIsNone) {
  receive_steps(1, 0, -1, 0);
  for (const std::uint32_t attempt : {kLastAttempt + 1, std::numeric_limits<std::uint32_t>::max()}) {
    EXPECT_EQ(receive(1, {attempt, 0, -1}), DropReason::out_of_turn);
    EXPECT_EQ(receive(1, {attempt, 0, 1}), DropReason::out_of_turn);
    expect_acknowledged({1, 0, 0});
  }
  receive_steps(2, 0);
  expect_acknowledged({2, 8, kNothingYet});
  EXPECT_EQ(receive(1, {kLastAttempt, 8, -1}), DropReason::none);
  EXPECT_TRUE(may_be_reported(kSchedule, arrivals_.acknowledgement()));
}

TEST_F(ArrivalsTest, OfAStreamThatJoinsAnAttemptAtALaterBatchAreOutOfTurn) {
  start_from(8, 0);
  receive_steps_of(0, 3, 8);
  receive_steps_of(0, 3, 16);
  EXPECT_EQ(receive(1, {3, 16, -1}), DropReason::out_of_turn);
  EXPECT_EQ(receive(1, {3, 16, 0}), DropReason::missed_start);
  expect_acknowledged({3, 8, kNothingYet});
  EXPECT_FALSE(contains(log(), "batch"));
  // The leader has not noticed the restart and is at a later batch of the attempt that the checkpoint knows.
  start_from(8, 3);
  EXPECT_EQ(receive(0, {3, 16, -1}), DropReason::out_of_turn);
  EXPECT_EQ(log(), "");
}

TEST_F(ArrivalsTest, ResumeBehindTheCommittedBatches) {
  arrivals_.resume_at(8);
  EXPECT_EQ(arrivals_.committed(), 8u);
  expect_acknowledged({0, 8, kNothingYet});
  receive_steps(1, 8);
  EXPECT_TRUE(contains(log(), "batch 8 of 64 "));
}

TEST_F(ArrivalsTest, HaveAnIdForEveryStepOfTheAttempt) {
  start_from(5, 0);
  receive(0, {7, 5, -1});
  EXPECT_EQ(arrivals_.id_of(0), (MessageId{7, 5, -1}));
  EXPECT_EQ(arrivals_.id_of(3), (MessageId{7, 5, 2}));
  EXPECT_EQ(arrivals_.id_of(4), (MessageId{7, 13, -1}));
  EXPECT_EQ(arrivals_.id_of(7), (MessageId{7, 13, 2}));
  EXPECT_EQ(arrivals_.id_of(8), (MessageId{7, 20, -1}));
}

TEST_F(ArrivalsTest, HaveTheLatestMessageOfEachStreamInThePresentAttempt) {
  receive_steps_of(0, 1, 0, -1, 0);
  EXPECT_EQ(arrivals_.latest(0)->step, 0);
  EXPECT_FALSE(arrivals_.latest(1));
  receive(1, {2, 0, -1});
  EXPECT_FALSE(arrivals_.latest()[0]);
  EXPECT_EQ(arrivals_.latest()[1]->attempt, 2u);
}

TEST_F(ArrivalsTest, OfAnEndlessRunAreAcknowledgedWithoutEnd) {
  start_from(0, 0, {1, 1, 0});
  for (std::int64_t step = -1; step < 100; ++step) {
    receive_steps(1, 0, step, step);
    expect_acknowledged({1, 0, step});
  }
  EXPECT_FALSE(arrivals_.complete());
}

TEST(Arrivals, CountAMessageOnlyOnceItsWorkIsDone) {
  Arrivals arrivals({2, 1, 1}, kStreams, 0, 0);
  const MessageDescriptor start{{1, 0, -1}, 1, true}, end{{1, 0, 0}, 1, true};
  for (std::size_t s = 0; s < kStreams; ++s)
    for (const MessageDescriptor& message : {start, end}) EXPECT_EQ(arrivals.admit(s, message), DropReason::none);
  EXPECT_EQ(arrivals.acknowledgement().step, kNothingYet);
  EXPECT_EQ(arrivals.messages(), 0u);
  EXPECT_FALSE(arrivals.count(0, start));
  EXPECT_FALSE(arrivals.count(0, end));
  EXPECT_FALSE(arrivals.count(1, start));
  EXPECT_EQ(arrivals.acknowledgement().step, -1);
  const std::optional<CompleteBatch> batch = arrivals.count(1, end);
  ASSERT_TRUE(batch);
  EXPECT_EQ(batch->positions_received, 4u);
  EXPECT_EQ(arrivals.messages(), 4u);
}

TEST(Arrivals, IgnoreAnAttemptThatEndsWhileItsWorkIsDone) {
  Arrivals arrivals({2, 2, 1}, kStreams, 0, 0);
  const MessageDescriptor old{{1, 0, -1}, 2, true};
  EXPECT_EQ(arrivals.admit(0, old), DropReason::none);
  EXPECT_EQ(arrivals.admit(1, {{2, 0, -1}, 2, true}), DropReason::none);
  EXPECT_EQ(arrivals.attempt(), 2u);
  EXPECT_FALSE(arrivals.count(0, old));
  EXPECT_EQ(arrivals.messages(), 0u);
  EXPECT_FALSE(arrivals.latest(0));
}

TEST_F(ArrivalsTest, RejectAStreamBeyondTheLast) {
  EXPECT_THROW(receive(kStreams, {1, 0, -1}), std::out_of_range);
}

}  // namespace
}  // namespace platoon
