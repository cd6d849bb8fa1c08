#include "stochastic_platoon/run/delivery/signal_assembly.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <stdexcept>
#include <tuple>

#include "stochastic_platoon/math/model/signal.hpp"

namespace platoon {
namespace {

const BatchSchedule kSchedule{20, 8, 3};  // batches at 0, 8 and, of size 4, at 16; steps -1 .. 2
const Signal kError{true, 0.5, 1, -3.2};
constexpr std::size_t kFollowers = 2;

// A different position for each vehicle, realization and step.
double position(std::size_t vehicle, std::uint64_t realization, std::int64_t step) {
  return 1000.0 * static_cast<double>(vehicle) + 10.0 * static_cast<double>(realization) +
         0.37 * static_cast<double>(step * step);
}

double error(std::size_t follower, std::uint64_t realization, std::int64_t step) {
  return kError(position(follower - 1, realization, step),
                {position(follower, realization, step), position(follower, realization, step - 1)});
}

Positions positions(std::size_t vehicle, const MessageId& id, std::size_t count) {
  std::vector<double> values;
  for (std::size_t r = 0; r < count; ++r) values.push_back(position(vehicle, id.first_realization + r, id.step));
  return std::make_shared<const std::vector<double>>(values);
}

// An assembly that records and checks its outputs.
class Assembled {
public:
  explicit Assembled(const BatchSchedule& schedule = kSchedule, std::uint64_t first = 0, std::uint32_t attempt = 0)
      : schedule_(schedule), assembly_(schedule, kFollowers, first, attempt, Signal::kHighestOrder) {}

  DropReason receive(std::size_t vehicle, const MessageId& id) {
    const Positions message = positions(vehicle, id, schedule_.size(id.first_realization));
    sent_.push_back(message);
    const MessageDescriptor descriptor{id, message->size(), true};
    SignalAssembly::Receipt receipt = assembly_.receive(vehicle, descriptor, message);
    if (receipt.restarted) restart();
    for (const DueSignals& due : receipt.due) take_errors(due);
    receipt.due.clear();
    if (receipt.drop != DropReason::none) return receipt.drop;
    const std::optional<CompleteBatch> batch = assembly_.settle(vehicle, descriptor);
    if (batch) take_batch(*batch);
    return receipt.drop;
  }

  // Receives steps `from` to `to` of the batch, each from all vehicles.
  void receive_steps(std::uint32_t attempt, std::uint64_t first, std::int64_t from, std::int64_t to) {
    for (std::int64_t step = from; step <= to; ++step) {
      for (std::size_t i = 0; i <= kFollowers; ++i) {
        EXPECT_EQ(receive(i, {attempt, first, step}), DropReason::none) << i << ": " << first << ", " << step;
      }
    }
  }

  void expect_acknowledged(const MessageId& expected) const {
    const Acknowledgement found = assembly_.arrivals().acknowledgement();
    EXPECT_EQ(std::tie(found.attempt, found.first_realization, found.step),
              std::tie(expected.attempt, expected.first_realization, expected.step));
  }

  std::size_t positions_kept() const {
    return static_cast<std::size_t>(
        std::count_if(sent_.begin(), sent_.end(), [](const auto& message) { return !message.expired(); }));
  }

  SignalAssembly& assembly() { return assembly_; }
  std::size_t errors_told() const { return errors_told_; }
  int restarts() const { return restarts_; }
  const std::vector<CompleteBatch>& batches() const { return batches_; }

private:
  void take_errors(const DueSignals& due) {
    const std::size_t follower = due.follower;
    const MessageId& id = due.id;
    ++errors_told_;
    const auto last = last_told_.find(follower);
    if (last != last_told_.end()) {
      const MessageId& before = last->second;
      const bool next_step = id.first_realization == before.first_realization && id.step == before.step + 1;
      const bool next_batch = schedule_.is_last_step(before.step) && id.step == 0 &&
                              id.first_realization == schedule_.next(before.first_realization);
      EXPECT_TRUE(next_step || next_batch) << "out of order: follower " << follower;
    } else {
      EXPECT_EQ(id.step, 0);
    }
    last_told_[follower] = id;
    ASSERT_EQ(due.own[0]->size(), schedule_.size(id.first_realization));
    for (std::size_t r = 0; r < due.own[0]->size(); ++r) {
      EXPECT_DOUBLE_EQ(kError((*due.predecessor)[r], {(*due.own[0])[r], (*due.own[1])[r]}),
                       error(follower, id.first_realization + r, id.step))
          << "follower " << follower << ", realization " << id.first_realization + r << ", step " << id.step;
      for (std::int64_t j = 0; j <= Signal::kHighestOrder; ++j) {
        ASSERT_EQ((*due.own[static_cast<std::size_t>(j)])[r],
                  position(follower, id.first_realization + r, std::max(id.step - j, kInitialStep)));
      }
    }
    ++told_[id.first_realization];
  }

  void take_batch(const CompleteBatch& batch) {
    EXPECT_EQ(told_[batch.first_realization], kFollowers * static_cast<std::size_t>(schedule_.steps))
        << "all errors of a batch are told before it is complete";
    batches_.push_back(batch);
  }

  void restart() {
    ++restarts_;
    told_.clear();
    last_told_.clear();
  }

  BatchSchedule schedule_;
  std::map<std::uint64_t, std::size_t> told_;
  std::map<std::size_t, MessageId> last_told_;
  std::size_t errors_told_ = 0;
  int restarts_ = 0;
  std::vector<CompleteBatch> batches_;
  std::vector<std::weak_ptr<const std::vector<double>>> sent_;
  SignalAssembly assembly_;
};

std::vector<MessageId> all_ids(const BatchSchedule& schedule, std::uint32_t attempt, std::uint64_t first) {
  std::vector<MessageId> ids;
  for (; !schedule.is_complete(first); first = schedule.next(first)) {
    for (std::int64_t step = kInitialStep; step < schedule.steps; ++step) ids.push_back({attempt, first, step});
  }
  return ids;
}

void expect_whole_run(const Assembled& assembled, SignalAssembly& assembly) {
  EXPECT_TRUE(assembly.arrivals().complete());
  ASSERT_EQ(assembled.batches().size(), 3u);
  const std::uint64_t firsts[] = {0, 8, 16}, sizes[] = {8, 8, 4};
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_EQ(assembled.batches()[b].first_realization, firsts[b]);
    EXPECT_EQ(assembled.batches()[b].positions_received, (kFollowers + 1) * 4 * sizes[b]);
  }
}

TEST(SignalAssembly, FormsEveryErrorOfEveryBatch) {
  Assembled assembled;
  for (const std::uint64_t first : {0, 8, 16}) assembled.receive_steps(1, first, -1, 2);
  expect_whole_run(assembled, assembled.assembly());
  EXPECT_EQ(assembled.errors_told(), 3 * 3 * kFollowers);
}

// Batches overlap: vehicles are ahead of each other by random numbers of steps.
TEST(SignalAssembly, FormsEveryErrorInOrderHoweverTheVehiclesInterleave) {
  const std::vector<MessageId> ids = all_ids(kSchedule, 1, 0);
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 generator(seed);
    Assembled assembled;
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
    expect_whole_run(assembled, assembled.assembly());
  }
}

TEST(SignalAssembly, AcknowledgesWhatHasArrivedFromEveryVehicle) {
  Assembled assembled;
  assembled.expect_acknowledged({0, 0, kNothingYet});
  assembled.receive(0, {1, 0, -1});
  assembled.receive(2, {1, 0, -1});
  assembled.receive(0, {1, 0, 0});
  assembled.expect_acknowledged({1, 0, kNothingYet});
  assembled.receive(1, {1, 0, -1});
  assembled.expect_acknowledged({1, 0, -1});
  assembled.receive_steps(2, 0, -1, 1);
  assembled.expect_acknowledged({2, 0, 1});
  assembled.receive_steps(2, 0, 2, 2);
  assembled.expect_acknowledged({2, 8, kNothingYet});
}

TEST(SignalAssembly, LetsGoOfPositionsOnceTheirErrorsAreFormed) {
  Assembled assembled;
  for (const std::uint64_t first : {0, 8, 16}) {
    for (std::int64_t step = -1; step < 3; ++step) {
      assembled.receive_steps(1, first, step, step);
      EXPECT_LE(assembled.positions_kept(), kFollowers * Signal::kHighestOrder)
          << "of each follower, for its next signals";
    }
  }
}

TEST(SignalAssembly, KeepsNoMoreThanTheVehiclesAreApart) {
  const BatchSchedule schedule{1, 1, 0};
  Assembled assembled(schedule);
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

TEST(SignalAssembly, KeepsNothingOfWhatItRefuses) {
  Assembled assembled;
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

TEST(SignalAssembly, ForgetsTheUnfinishedBatchesWhenANewerAttemptBegins) {
  Assembled assembled;
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
  expect_whole_run(assembled, assembled.assembly());
}

TEST(SignalAssembly, CompletesABatchOnlyWhenAllOfItsErrorsAreDealtWith) {
  SignalAssembly assembly({2, 2, 1}, 1, 0, 0);
  const MessageDescriptor start{{1, 0, -1}, 2, true}, end{{1, 0, 0}, 2, true};
  for (std::size_t i = 0; i <= 1; ++i) {
    EXPECT_TRUE(assembly.receive(i, start, positions(i, start.id, 2)).due.empty());
    EXPECT_EQ(assembly.receive(i, end, positions(i, end.id, 2)).due.size(), i);  // that of this follower only
  }
  EXPECT_FALSE(assembly.settle(1, start));
  EXPECT_FALSE(assembly.settle(1, end));
  EXPECT_FALSE(assembly.settle(0, start));
  EXPECT_FALSE(assembly.arrivals().complete());
  EXPECT_TRUE(assembly.settle(0, end));
  EXPECT_TRUE(assembly.arrivals().complete());
}

TEST(SignalAssembly, RefusesAnAttemptThatBeginsWhereItCannotGoOn) {
  Assembled assembled;
  assembled.receive_steps(1, 0, -1, 2);
  EXPECT_EQ(assembled.receive(0, {2, 16, -1}), DropReason::out_of_turn);
  EXPECT_EQ(assembled.receive(0, {2, 5, -1}), DropReason::out_of_turn);
  EXPECT_EQ(assembled.restarts(), 1);
  assembled.expect_acknowledged({1, 8, kNothingYet});
  assembled.receive_steps(3, 8, -1, 2);
  EXPECT_EQ(assembled.restarts(), 2);
  EXPECT_EQ(assembled.batches().size(), 2u);
}

TEST(SignalAssembly, TellsNoErrorTwiceWhenAnAttemptBeginsBeforeWhatIsCommitted) {
  Assembled assembled;
  for (const std::uint64_t first : {0, 8}) assembled.receive_steps(1, first, -1, 2);
  const std::size_t told = assembled.errors_told();
  for (const std::uint64_t first : {0, 8}) assembled.receive_steps(2, first, -1, 2);
  EXPECT_EQ(assembled.errors_told(), told);
  EXPECT_EQ(assembled.batches().size(), 2u);
  EXPECT_LE(assembled.positions_kept(), kFollowers * Signal::kHighestOrder);
  assembled.receive_steps(2, 16, -1, 2);
  expect_whole_run(assembled, assembled.assembly());
  EXPECT_EQ(assembled.errors_told(), 3 * 3 * kFollowers);
}

TEST(SignalAssembly, GoesOnFromWhatWasCommittedBefore) {
  Assembled assembled(kSchedule, 5, 3);
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

TEST(SignalAssembly, IsCompleteWhenEverythingWasCommittedBefore) {
  Assembled assembled(kSchedule, 20, 3);
  EXPECT_TRUE(assembled.assembly().arrivals().complete());
  assembled.expect_acknowledged({3, 20, kNothingYet});
  EXPECT_NE(assembled.receive(0, {4, 20, -1}), DropReason::none);
}

// A restarted monitor knows attempt 3 from its checkpoint, up to realization 8. The leader has not noticed the
// restart and is at the batch of realization 16 in the same attempt, which is not the missing batch.
TEST(SignalAssembly, DoesNotTakeALaterBatchOfTheAttemptItWasRestartedIn) {
  Assembled assembled(BatchSchedule{40, 8, 3}, 8, 3);
  for (std::int64_t step = kInitialStep; step < 3; ++step) {
    for (std::size_t i = 0; i <= kFollowers; ++i) ASSERT_NE(assembled.receive(i, {3, 16, step}), DropReason::none);
  }
  EXPECT_TRUE(assembled.batches().empty());
  assembled.expect_acknowledged({3, 8, kNothingYet});
}

// The same with links that come up one after the other: the monitor receives vehicle 0 from the missing batch
// on, the others only from the next batch on.
TEST(SignalAssembly, DoesNotMixBatchesOfVehiclesThatAreHeardFromDifferentOnesOn) {
  Assembled assembled(BatchSchedule{40, 8, 3}, 8, 2);
  for (const std::uint64_t first : {8, 16}) {
    for (std::int64_t step = kInitialStep; step < 3; ++step) {
      EXPECT_EQ(assembled.receive(0, {3, first, step}), DropReason::none);
      if (first == 16) {
        ASSERT_NE(assembled.receive(1, {3, first, step}), DropReason::none);
        ASSERT_NE(assembled.receive(2, {3, first, step}), DropReason::none);
      }
    }
  }
  EXPECT_TRUE(assembled.batches().empty());
}

TEST(SignalAssembly, KnowsTheLatestMessageOfEachVehicleInThePresentAttempt) {
  Assembled assembled;
  assembled.receive_steps(1, 0, -1, 0);
  assembled.receive(0, {1, 0, 1});
  std::vector<std::optional<MessageId>> latest = assembled.assembly().arrivals().latest();
  ASSERT_EQ(latest.size(), kFollowers + 1);
  EXPECT_EQ(latest[0]->step, 1);
  EXPECT_EQ(latest[1]->step, 0);
  EXPECT_EQ(latest[2]->step, 0);
  assembled.receive(1, {2, 0, -1});
  latest = assembled.assembly().arrivals().latest();
  EXPECT_FALSE(latest[0]);
  EXPECT_EQ(latest[1]->step, -1);
  EXPECT_FALSE(latest[2]);
}

TEST(SignalAssembly, OfAnEndlessRunFormsErrorsAndAcknowledgesForEver) {
  Assembled assembled(BatchSchedule{1, 1, 0});
  assembled.receive_steps(1, 0, -1, 300);
  EXPECT_EQ(assembled.errors_told(), 301 * kFollowers);
  assembled.expect_acknowledged({1, 0, 300});
  EXPECT_TRUE(assembled.batches().empty());
  EXPECT_FALSE(assembled.assembly().arrivals().complete());
}

TEST(SignalAssembly, KnowsNoVehicleBeyondTheLast) {
  Assembled assembled;
  EXPECT_THROW(assembled.receive(kFollowers + 1, {1, 0, -1}), std::out_of_range);
}

}  // namespace
}  // namespace platoon
