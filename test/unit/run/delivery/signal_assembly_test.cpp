#include "stochastic_platoon/run/delivery/signal_assembly.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "unit/run/delivery/checked_assembly.hpp"

namespace platoon {
namespace {

std::vector<MessageId> all_ids(const BatchSchedule& schedule, std::uint32_t attempt, std::uint64_t first) {
  std::vector<MessageId> ids;
  for (; !schedule.is_complete(first); first = schedule.next(first)) {
    for (std::int64_t step = kInitialStep; step < schedule.steps; ++step) ids.push_back({attempt, first, step});
  }
  return ids;
}

void expect_whole_run(const CheckedAssembly& assembled) {
  EXPECT_TRUE(assembled.assembly().arrivals().complete());
  ASSERT_EQ(assembled.batches().size(), 3u);
  const std::uint64_t firsts[] = {0, 8, 16}, sizes[] = {8, 8, 4};
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_EQ(assembled.batches()[b].first_realization, firsts[b]);
    EXPECT_EQ(assembled.batches()[b].positions_received, (kFollowers + 1) * 4 * sizes[b]);
  }
}

TEST(SignalAssembly, FormsEveryErrorOfEveryBatch) {
  CheckedAssembly assembled;
  for (const std::uint64_t first : {0, 8, 16}) assembled.receive_steps(1, first, -1, 2);
  expect_whole_run(assembled);
  EXPECT_EQ(assembled.errors_due(), 3 * 3 * kFollowers);
}

// Batches overlap: vehicles are ahead of each other by random numbers of steps.
TEST(SignalAssembly, FormsEveryErrorInOrderForAnyOrderOfTheVehicles) {
  const std::vector<MessageId> ids = all_ids(kSchedule, 1, 0);
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 generator(seed);
    CheckedAssembly assembled;
    std::vector<std::size_t> next(kFollowers + 1, 0);
    const unsigned favourite = generator() % 4;  // 3: none
    for (std::size_t left = ids.size() * next.size(); left > 0;) {
      const std::size_t vehicle = generator() % 3 == 0 && favourite < 3 ? favourite : generator() % 3;
      if (next[vehicle] == ids.size()) continue;
      ASSERT_EQ(assembled.receive(vehicle, ids[next[vehicle]++]), DropReason::none);
      --left;
      const std::size_t slowest = *std::min_element(next.begin(), next.end());
      const MessageId& last = ids[slowest == 0 ? 0 : slowest - 1];
      if (slowest == 0) {
        assembled.expect_acknowledged({1, 0, kNothingYet});
      } else if (kSchedule.is_last_step(last.step)) {
        assembled.expect_acknowledged({1, kSchedule.next(last.first_realization), kNothingYet});
      } else {
        assembled.expect_acknowledged(last);
      }
    }
    expect_whole_run(assembled);
  }
}

TEST(SignalAssembly, ReleasesPositionsOnceTheirErrorsAreFormed) {
  CheckedAssembly assembled;
  for (const std::uint64_t first : {0, 8, 16}) {
    for (std::int64_t step = -1; step < 3; ++step) {
      assembled.receive_steps(1, first, step, step);
      EXPECT_LE(assembled.positions_kept(), (kFollowers + 1) * Signal::kHighestOrder)
          << "of each vehicle, for the next signals";
    }
  }
}

TEST(SignalAssembly, KeepsNoMorePositionsThanTheVehiclesAreApart) {
  const BatchSchedule schedule{1, 1, 0};
  CheckedAssembly assembled(schedule);
  constexpr std::int64_t kApart = 10;
  for (std::int64_t step = -1; step < 500; ++step) {
    assembled.receive(0, {1, 0, step});
    for (std::size_t i = 1; i <= kFollowers; ++i) {
      const std::int64_t late = step - kApart * static_cast<std::int64_t>(i) / 2;
      if (late >= -1) assembled.receive(i, {1, 0, late});
    }
    ASSERT_LE(assembled.positions_kept(), static_cast<std::size_t>(kApart + 2) * (kFollowers + 1));
  }
}

TEST(SignalAssembly, KeepsNothingOfDroppedMessages) {
  CheckedAssembly assembled;
  assembled.receive_steps(1, 0, -1, 0);
  const std::size_t kept = assembled.positions_kept();
  for (std::size_t i = 0; i <= kFollowers; ++i) {
    EXPECT_EQ(assembled.receive(i, {1, 0, 2}), DropReason::out_of_turn);
    EXPECT_EQ(assembled.receive(i, {1, 0, 0}), DropReason::out_of_turn);
    EXPECT_EQ(assembled.receive(i, {0, 0, 1}), DropReason::stale);
    EXPECT_EQ(assembled.receive(i, {2, 0, 1}), DropReason::missed_start);
    EXPECT_EQ(assembled.assembly().receive(i, {{1, 0, 1}, 7, true}, positions(i, {1, 0, 1}, 7)).drop,
              DropReason::wrong_size);
  }
  EXPECT_EQ(assembled.positions_kept(), kept);
  EXPECT_EQ(assembled.restarts(), 1);
  assembled.expect_acknowledged({1, 0, 0});
  assembled.receive_steps(1, 0, 1, 2);
  EXPECT_EQ(assembled.batches().size(), 1u);
}

TEST(SignalAssembly, DiscardsUnfinishedBatchesWhenANewerAttemptBegins) {
  CheckedAssembly assembled;
  assembled.receive_steps(1, 0, -1, 2);
  assembled.receive_steps(1, 8, -1, 1);
  assembled.receive(0, {1, 8, 2});
  EXPECT_EQ(assembled.restarts(), 1);
  EXPECT_EQ(assembled.receive(1, {2, 8, -1}), DropReason::none);
  EXPECT_EQ(assembled.restarts(), 2);
  EXPECT_EQ(assembled.positions_kept(), 1u);
  assembled.expect_acknowledged({2, 8, kNothingYet});
  for (std::size_t i = 0; i <= kFollowers; ++i) EXPECT_EQ(assembled.receive(i, {1, 8, 2}), DropReason::stale);
  EXPECT_EQ(assembled.receive(0, {2, 8, -1}), DropReason::none);
  EXPECT_EQ(assembled.receive(2, {2, 8, -1}), DropReason::none);
  assembled.receive_steps(2, 8, 0, 2);
  assembled.receive_steps(2, 16, -1, 2);
  expect_whole_run(assembled);
}

TEST(SignalAssembly, FormsNoErrorOfACommittedBatchAgain) {
  CheckedAssembly assembled;
  for (const std::uint64_t first : {0, 8}) assembled.receive_steps(1, first, -1, 2);
  const std::size_t before = assembled.errors_due();
  for (const std::uint64_t first : {0, 8}) assembled.receive_steps(2, first, -1, 2);
  EXPECT_EQ(assembled.errors_due(), before);
  EXPECT_EQ(assembled.batches().size(), 2u);
  EXPECT_LE(assembled.positions_kept(), (kFollowers + 1) * Signal::kHighestOrder);
  assembled.receive_steps(2, 16, -1, 2);
  expect_whole_run(assembled);
  EXPECT_EQ(assembled.errors_due(), 3 * 3 * kFollowers);
}

TEST(SignalAssembly, ContinuesBehindTheCommittedRealizations) {
  CheckedAssembly assembled(kSchedule, 5, 3);
  EXPECT_EQ(assembled.assembly().arrivals().committed(), 5u);
  assembled.expect_acknowledged({3, 5, kNothingYet});
  EXPECT_EQ(assembled.receive(0, {2, 5, -1}), DropReason::stale);
  EXPECT_EQ(assembled.receive(0, {4, 0, -1}), DropReason::out_of_turn);
  assembled.receive_steps(4, 5, -1, 2);
  assembled.expect_acknowledged({4, 13, kNothingYet});
  assembled.receive_steps(4, 13, -1, 2);
  EXPECT_TRUE(assembled.assembly().arrivals().complete());
  EXPECT_EQ(assembled.assembly().arrivals().committed(), 20u);
  ASSERT_EQ(assembled.batches().size(), 2u);
  EXPECT_EQ(assembled.batches()[1].positions_received, 3u * 4u * 7u);
}

TEST(SignalAssembly, FormsErrorsOfAnEndlessRunWithoutEnd) {
  CheckedAssembly assembled(BatchSchedule{1, 1, 0});
  assembled.receive_steps(1, 0, -1, 300);
  EXPECT_EQ(assembled.errors_due(), 301 * kFollowers);
  assembled.expect_acknowledged({1, 0, 300});
  EXPECT_TRUE(assembled.batches().empty());
  EXPECT_FALSE(assembled.assembly().arrivals().complete());
}

}  // namespace
}  // namespace platoon
