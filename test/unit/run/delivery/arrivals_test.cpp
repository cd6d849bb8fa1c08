#include "stochastic_platoon/run/delivery/arrivals.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <tuple>

namespace platoon {
namespace {

const BatchSchedule kSchedule{20, 8, 3};  // batches at 0, 8 and, of size 4, at 16; steps -1 .. 2
constexpr std::size_t kStreams = 2;

// Arrivals with a record of their results.
class Recorded {
public:
  explicit Recorded(std::uint64_t committed = 0, std::uint32_t attempt = 0, const BatchSchedule& schedule = kSchedule)
      : schedule_(schedule), arrivals_(schedule, kStreams, committed, attempt) {}

  DropReason receive(std::size_t stream, const MessageId& id) {
    const MessageDescriptor descriptor{id, schedule_.size(id.first_realization), true};
    const std::uint32_t before = arrivals_.attempt();
    const DropReason drop = arrivals_.admit(stream, descriptor);
    if (arrivals_.attempt() > before) told_ += "restarted ";
    if (drop != DropReason::none) return drop;
    told_ += "take " + std::to_string(stream) + " ";
    const std::optional<CompleteBatch> batch = arrivals_.count(stream, descriptor);
    if (batch) {
      told_ += "batch " + std::to_string(batch->first_realization) + " of " +
               std::to_string(batch->positions_received) + " ";
    }
    return drop;
  }

  void receive_batch(std::uint32_t attempt, std::uint64_t first) {
    for (std::int64_t step = kInitialStep; step < schedule_.steps; ++step) {
      for (std::size_t s = 0; s < kStreams; ++s) {
        ASSERT_EQ(receive(s, {attempt, first, step}), DropReason::none) << s << ": " << first << ", " << step;
      }
    }
  }

  void expect_acknowledged(const MessageId& expected) const {
    const Acknowledgement found = arrivals_.acknowledgement();
    EXPECT_EQ(std::tie(found.attempt, found.first_realization, found.step),
              std::tie(expected.attempt, expected.first_realization, expected.step));
  }

  /// The results since the previous call.
  std::string told() {
    std::string text;
    text.swap(told_);
    return text;
  }

  Arrivals& arrivals() { return arrivals_; }

private:
  BatchSchedule schedule_;
  std::string told_;
  Arrivals arrivals_;
};

TEST(Arrivals, TellRestartThenMessageThenBatch) {
  Recorded recorded(0, 0, {2, 1, 1});
  EXPECT_EQ(recorded.receive(1, {1, 0, -1}), DropReason::none);
  EXPECT_EQ(recorded.told(), "restarted take 1 ");
  recorded.receive(1, {1, 0, 0});
  recorded.receive(0, {1, 0, -1});
  EXPECT_EQ(recorded.told(), "take 1 take 0 ");
  recorded.receive(0, {1, 0, 0});
  EXPECT_EQ(recorded.told(), "take 0 batch 0 of 4 ");
}

TEST(Arrivals, TellNothingOfWhatIsNotInTurn) {
  Recorded recorded;
  recorded.receive_batch(2, 0);
  recorded.told();
  for (const MessageId& id :
       {MessageId{1, 8, -1}, MessageId{2, 8, 0}, MessageId{2, 0, 2}, MessageId{3, 8, 1}, MessageId{3, 16, -1}}) {
    EXPECT_NE(recorded.receive(0, id), DropReason::none);
  }
  EXPECT_EQ(recorded.told(), "");
  EXPECT_EQ(recorded.arrivals().attempt(), 2u);
  recorded.expect_acknowledged({2, 8, kNothingYet});
}

TEST(Arrivals, AreAcknowledgedUpToWhereAllStreamsAre) {
  Recorded recorded;
  recorded.expect_acknowledged({0, 0, kNothingYet});
  recorded.receive(0, {1, 0, -1});
  recorded.receive(0, {1, 0, 0});
  recorded.expect_acknowledged({1, 0, kNothingYet});
  recorded.receive(1, {1, 0, -1});
  recorded.expect_acknowledged({1, 0, -1});
  recorded.receive(1, {1, 0, 0});
  recorded.receive(1, {1, 0, 1});
  recorded.receive(1, {1, 0, 2});
  recorded.receive(1, {1, 8, -1});
  recorded.expect_acknowledged({1, 0, 0});
  recorded.receive(0, {1, 0, 1});
  recorded.receive(0, {1, 0, 2});
  recorded.expect_acknowledged({1, 8, kNothingYet});
  recorded.receive(0, {1, 8, -1});
  recorded.expect_acknowledged({1, 8, -1});
}

TEST(Arrivals, CommitEveryBatchInOrder) {
  Recorded recorded;
  for (const std::uint64_t first : {0, 8, 16}) {
    EXPECT_EQ(recorded.arrivals().committed(), first);
    EXPECT_FALSE(recorded.arrivals().complete());
    recorded.told();
    recorded.receive_batch(1, first);
    const std::string told = recorded.told();
    const std::string batch = "batch " + std::to_string(first) + " of " + (first < 16 ? "64 " : "32 ");
    EXPECT_EQ(told.substr(told.size() - batch.size()), batch);
  }
  EXPECT_TRUE(recorded.arrivals().complete());
  EXPECT_EQ(recorded.arrivals().committed(), 20u);
  recorded.expect_acknowledged({1, 20, kNothingYet});
}

TEST(Arrivals, OfAnUnfinishedBatchAreVoidInANewAttempt) {
  Recorded recorded;
  recorded.receive_batch(1, 0);
  for (std::int64_t step = -1; step < 3; ++step) recorded.receive(0, {1, 8, step});
  recorded.receive(1, {1, 8, -1});
  recorded.told();
  EXPECT_EQ(recorded.receive(1, {4, 8, -1}), DropReason::none);
  EXPECT_EQ(recorded.told(), "restarted take 1 ");
  EXPECT_EQ(recorded.arrivals().attempt(), 4u);
  recorded.expect_acknowledged({4, 8, kNothingYet});
  EXPECT_EQ(recorded.receive(1, {1, 8, 0}), DropReason::stale);
  EXPECT_EQ(recorded.receive(0, {4, 8, -1}), DropReason::none);
  recorded.expect_acknowledged({4, 8, -1});
}

// Another receiver may need realizations that this one has committed.
TEST(Arrivals, PassByUncountedWhenAnAttemptBeginsBeforeWhatIsCommitted) {
  Recorded recorded;
  recorded.receive_batch(1, 0);
  recorded.receive_batch(1, 8);
  recorded.told();
  recorded.receive(0, {2, 0, -1});
  recorded.expect_acknowledged({2, 0, kNothingYet});
  recorded.receive(1, {2, 0, -1});
  recorded.expect_acknowledged({2, 0, -1});
  for (std::int64_t step = 0; step < 3; ++step) {
    for (std::size_t s = 0; s < kStreams; ++s) recorded.receive(s, {2, 0, step});
  }
  recorded.expect_acknowledged({2, 8, kNothingYet});
  recorded.receive_batch(2, 8);
  recorded.expect_acknowledged({2, 16, kNothingYet});
  EXPECT_EQ(recorded.arrivals().committed(), 16u);
  EXPECT_EQ(recorded.told().find("batch"), std::string::npos);
  recorded.receive_batch(2, 16);
  EXPECT_NE(recorded.told().find("batch 16 of 32 "), std::string::npos);
  EXPECT_TRUE(recorded.arrivals().complete());
}

TEST(Arrivals, PassByWhenEverythingIsCommitted) {
  Recorded recorded(20, 3);
  recorded.expect_acknowledged({3, 20, kNothingYet});
  recorded.receive_batch(4, 5);
  recorded.expect_acknowledged({4, 13, kNothingYet});
  recorded.receive_batch(4, 13);
  recorded.expect_acknowledged({4, 20, kNothingYet});
  EXPECT_EQ(recorded.told().find("batch"), std::string::npos);
}

TEST(Arrivals, RefuseAnAttemptWhoseBatchesDoNotMeetWhatIsCommitted) {
  Recorded recorded(8, 1);
  EXPECT_EQ(recorded.receive(0, {2, 16, -1}), DropReason::out_of_turn);
  EXPECT_EQ(recorded.receive(0, {2, 3, -1}), DropReason::out_of_turn);
  EXPECT_EQ(recorded.receive(0, {2, 0, -1}), DropReason::none);
  EXPECT_EQ(recorded.receive(0, {3, 8, -1}), DropReason::none);
}

// A receiver restarts in the middle of an attempt, and its links come up one after the other.
TEST(Arrivals, OfAStreamThatJoinsAnAttemptAtALaterBatchAreOutOfTurn) {
  Recorded recorded(8, 0);
  EXPECT_EQ(recorded.receive(0, {3, 8, -1}), DropReason::none);
  EXPECT_EQ(recorded.receive(1, {3, 16, -1}), DropReason::out_of_turn);
  recorded.expect_acknowledged({3, 8, kNothingYet});
  Recorded restarted(8, 3);
  EXPECT_EQ(restarted.receive(0, {3, 16, -1}), DropReason::out_of_turn);
  EXPECT_EQ(restarted.told(), "");
}

TEST(Arrivals, GoOnFromWhatIsFoundToBeCommitted) {
  Recorded recorded;
  recorded.arrivals().resume_at(8);
  EXPECT_EQ(recorded.arrivals().committed(), 8u);
  recorded.expect_acknowledged({0, 8, kNothingYet});
  recorded.receive_batch(1, 8);
  EXPECT_NE(recorded.told().find("batch 8 of 64 "), std::string::npos);
}

TEST(Arrivals, NameEveryStepOfTheAttempt) {
  Recorded recorded(5, 0);
  recorded.receive(0, {7, 5, -1});
  const auto expect = [&](std::int64_t count, const MessageId& expected) {
    const MessageId found = recorded.arrivals().id_of(count);
    EXPECT_EQ(std::tie(found.attempt, found.first_realization, found.step),
              std::tie(expected.attempt, expected.first_realization, expected.step))
        << count;
  };
  expect(0, {7, 5, -1});
  expect(3, {7, 5, 2});
  expect(4, {7, 13, -1});
  expect(7, {7, 13, 2});
  expect(8, {7, 20, -1});
}

TEST(Arrivals, KnowTheLatestTurnOfEachStreamInThePresentAttempt) {
  Recorded recorded;
  recorded.receive(0, {1, 0, -1});
  recorded.receive(0, {1, 0, 0});
  EXPECT_EQ(recorded.arrivals().latest(0)->step, 0);
  EXPECT_FALSE(recorded.arrivals().latest(1));
  recorded.receive(1, {2, 0, -1});
  EXPECT_FALSE(recorded.arrivals().latest()[0]);
  EXPECT_EQ(recorded.arrivals().latest()[1]->attempt, 2u);
}

TEST(Arrivals, OfAnEndlessRunAreAcknowledgedForEver) {
  Recorded recorded(0, 0, {1, 1, 0});
  for (std::int64_t step = -1; step < 100; ++step) {
    for (std::size_t s = 0; s < kStreams; ++s) recorded.receive(s, {1, 0, step});
    recorded.expect_acknowledged({1, 0, step});
  }
  EXPECT_FALSE(recorded.arrivals().complete());
}

TEST(Arrivals, CountAMessageOnlyWhenItsWorkIsDone) {
  Arrivals arrivals({2, 1, 1}, kStreams, 0, 0);
  const MessageDescriptor start{{1, 0, -1}, 1, true}, end{{1, 0, 0}, 1, true};
  for (std::size_t s = 0; s < kStreams; ++s) {
    EXPECT_EQ(arrivals.admit(s, start), DropReason::none);
    EXPECT_EQ(arrivals.admit(s, end), DropReason::none);
  }
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

TEST(Arrivals, CountNothingOfAnAttemptThatEndedWhileItsWorkWasDone) {
  Arrivals arrivals({2, 2, 1}, kStreams, 0, 0);
  const MessageDescriptor old{{1, 0, -1}, 2, true};
  EXPECT_EQ(arrivals.admit(0, old), DropReason::none);
  EXPECT_EQ(arrivals.admit(1, {{2, 0, -1}, 2, true}), DropReason::none);
  EXPECT_EQ(arrivals.attempt(), 2u);
  EXPECT_FALSE(arrivals.count(0, old));
  EXPECT_EQ(arrivals.messages(), 0u);
  EXPECT_FALSE(arrivals.latest(0));
}

TEST(Arrivals, KnowNoStreamBeyondTheLast) {
  Recorded recorded;
  EXPECT_THROW(recorded.receive(kStreams, {1, 0, -1}), std::out_of_range);
}

}  // namespace
}  // namespace platoon
