#include "stochastic_platoon/delivery/sequence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

namespace platoon {
namespace {

const BatchSchedule kSchedule{20, 8, 3};  // batches at 0, 8 and, of size 4, at 16; steps -1 .. 2

std::vector<double> positions(std::size_t count) {
  return std::vector<double>(count, 1.0);
}

Verdict receive(Sequence& sequence, const Turn& turn) {
  return sequence.receive(turn, positions(kSchedule.size(turn.first_realization)));
}

// Takes the turns of attempt `attempt` from step -1 of the batch at `first` up to `step`.
Sequence after(std::uint32_t attempt, std::uint64_t first, std::int64_t step) {
  Sequence sequence(kSchedule);
  for (std::int64_t k = kInitialStep; k <= step; ++k) {
    EXPECT_EQ(receive(sequence, {attempt, first, k}), Verdict::in_turn);
  }
  return sequence;
}

void expect_latest(const Sequence& sequence, const Turn& turn) {
  ASSERT_TRUE(sequence.latest());
  EXPECT_EQ(sequence.latest()->attempt, turn.attempt);
  EXPECT_EQ(sequence.latest()->first_realization, turn.first_realization);
  EXPECT_EQ(sequence.latest()->step, turn.step);
}

TEST(Sequence, TakesEveryStepOfEveryBatchInOrder) {
  Sequence sequence(kSchedule);
  EXPECT_FALSE(sequence.latest());
  for (const std::uint64_t first : {0, 8, 16}) {
    for (const std::int64_t step : {-1, 0, 1, 2}) {
      EXPECT_EQ(receive(sequence, {1, first, step}), Verdict::in_turn);
      expect_latest(sequence, {1, first, step});
    }
  }
  EXPECT_NE(sequence.receive({1, 20, -1}, positions(4)), Verdict::in_turn);
  EXPECT_NE(sequence.receive({1, 20, -1}, {}), Verdict::in_turn);
}

TEST(Sequence, MissedTheStartOfWhatBeginsInTheMiddle) {
  Sequence fresh(kSchedule);
  EXPECT_EQ(receive(fresh, {1, 0, 0}), Verdict::missed_start);
  EXPECT_FALSE(fresh.latest());
  Sequence sequence = after(1, 0, 1);
  EXPECT_EQ(receive(sequence, {2, 0, 2}), Verdict::missed_start);
  expect_latest(sequence, {1, 0, 1});
}

TEST(Sequence, FindsGapsAndDuplicatesOutOfTurn) {
  Sequence sequence = after(1, 0, 1);
  for (const Turn& turn :
       {Turn{1, 0, 1}, Turn{1, 0, 0}, Turn{1, 0, -1}, Turn{1, 0, 3}, Turn{1, 8, 2}, Turn{1, 8, -1}}) {
    EXPECT_EQ(receive(sequence, turn), Verdict::out_of_turn);
  }
  EXPECT_EQ(receive(sequence, {1, 0, 2}), Verdict::in_turn);
}

TEST(Sequence, FindsABatchThatIsNotDueOutOfTurn) {
  Sequence sequence = after(1, 0, 2);
  for (const Turn& turn : {Turn{1, 0, 3}, Turn{1, 0, -1}, Turn{1, 16, -1}, Turn{1, 8, 0}}) {
    EXPECT_EQ(receive(sequence, turn), Verdict::out_of_turn);
  }
  EXPECT_EQ(receive(sequence, {1, 8, -1}), Verdict::in_turn);
}

TEST(Sequence, TakesUpANewerAttemptAtItsInitialStepAtAnyBatch) {
  for (const std::uint64_t first : {0, 8, 16}) {
    Sequence sequence = after(3, 0, 1);
    EXPECT_EQ(receive(sequence, {7, first, -1}), Verdict::in_turn);
    EXPECT_EQ(receive(sequence, {7, first, 0}), Verdict::in_turn);
  }
}

TEST(Sequence, FindsAnOlderAttemptStale) {
  Sequence sequence = after(3, 0, 1);
  for (const std::int64_t step : {-1, 0, 2}) EXPECT_EQ(receive(sequence, {2, 0, step}), Verdict::stale);
  EXPECT_EQ(receive(sequence, {3, 0, 2}), Verdict::in_turn);
}

TEST(Sequence, RefusesAWrongBatchSizeAndTakesTheRightOneAfterIt) {
  Sequence sequence = after(1, 0, 1);
  for (const std::size_t size : {0, 1, 7, 9}) {
    EXPECT_EQ(sequence.receive({1, 0, 2}, positions(size)), Verdict::wrong_size);
  }
  EXPECT_EQ(receive(sequence, {1, 0, 2}), Verdict::in_turn);
  Sequence last = after(1, 8, 2);
  EXPECT_EQ(last.receive({1, 16, -1}, positions(8)), Verdict::wrong_size);
  EXPECT_EQ(last.receive({1, 16, -1}, positions(4)), Verdict::in_turn);
}

TEST(Sequence, RefusesRealizationsThereAreNot) {
  Sequence sequence(kSchedule);
  EXPECT_EQ(sequence.receive({1, 20, -1}, {}), Verdict::wrong_size);
  EXPECT_EQ(sequence.receive({1, 24, -1}, positions(8)), Verdict::wrong_size);
  EXPECT_FALSE(sequence.latest());
}

TEST(Sequence, RefusesAPositionThatIsNotFinite) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (std::size_t place = 0; place < 8; ++place) {
      Sequence sequence = after(1, 0, 1);
      std::vector<double> values = positions(8);
      values[place] = bad;
      EXPECT_EQ(sequence.receive({1, 0, 2}, values), Verdict::not_finite);
      EXPECT_EQ(receive(sequence, {1, 0, 2}), Verdict::in_turn);
    }
  }
}

TEST(Sequence, OfAnEndlessRunNeverEndsItsBatch) {
  Sequence sequence(BatchSchedule{1, 1, 0});
  for (std::int64_t step = -1; step < 1000; ++step) {
    EXPECT_EQ(sequence.receive({1, 0, step}, {0.5}), Verdict::in_turn);
  }
  EXPECT_EQ(sequence.receive({1, 0, -1}, {0.5}), Verdict::out_of_turn);
}

TEST(Sequence, GoesOnFromARealizationWithinABatch) {
  Sequence sequence(kSchedule);
  for (std::int64_t step = -1; step < 3; ++step) {
    EXPECT_EQ(sequence.receive({1, 5, step}, positions(8)), Verdict::in_turn);
  }
  EXPECT_EQ(sequence.receive({1, 13, -1}, positions(7)), Verdict::in_turn);
}

TEST(Verdict, HasAWordOfItsOwn) {
  std::set<std::string> words;
  for (std::size_t v = 0; v < kVerdicts; ++v) words.insert(to_string(static_cast<Verdict>(v)));
  EXPECT_EQ(words.size(), kVerdicts);
  EXPECT_EQ(words.count("unknown"), 0u);
}

TEST(AllFinite, IsTrueForEveryFiniteNumber) {
  using Limits = std::numeric_limits<double>;
  EXPECT_TRUE(all_finite({}));
  EXPECT_TRUE(
      all_finite({0.0, -0.0, Limits::max(), -Limits::max(), Limits::min(), Limits::denorm_min(), -1.5}));
}

TEST(AllFinite, IsFalseForOneThatIsNot) {
  using Limits = std::numeric_limits<double>;
  for (const double bad : {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(), -Limits::quiet_NaN(),
                           Limits::signaling_NaN()}) {
    EXPECT_FALSE(all_finite({bad}));
    EXPECT_FALSE(all_finite({1.0, 2.0, bad, 4.0}));
  }
}

}  // namespace
}  // namespace platoon
