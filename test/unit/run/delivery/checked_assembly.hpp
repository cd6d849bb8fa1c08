#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/run/delivery/signal_assembly.hpp"
#include "unit/run/delivery/message_ids.hpp"

namespace platoon {

inline const BatchSchedule kSchedule{20, 8, 3};  // batches at 0, 8 and, of size 4, at 16; steps -1 .. 2
inline const Signal kError{{1.0, 0}, 0.5, {-3.2, 1}};
constexpr std::size_t kFollowers = 2;

// A different position for each vehicle, realization and step.
inline double position(std::size_t vehicle, std::uint64_t realization, std::int64_t step) {
  return 1000.0 * static_cast<double>(vehicle) + 10.0 * static_cast<double>(realization) +
         0.37 * static_cast<double>(step * step);
}

inline double error(std::size_t follower, std::uint64_t realization, std::int64_t step) {
  return kError({position(follower - 1, realization, step)},
                {position(follower, realization, step), position(follower, realization, step - 1)});
}

inline Positions positions(std::size_t vehicle, const MessageId& id, std::size_t count) {
  std::vector<double> values;
  for (std::size_t r = 0; r < count; ++r) values.push_back(position(vehicle, id.first_realization + r, id.step));
  return std::make_shared<const std::vector<double>>(values);
}

/// An assembly that records and checks its outputs.
class CheckedAssembly {
public:
  explicit CheckedAssembly(const BatchSchedule& schedule = kSchedule, std::uint64_t first = 0,
                           std::uint32_t attempt = 0)
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
    EXPECT_EQ(assembly_.arrivals().acknowledgement(), expected);
  }

  std::size_t positions_kept() const {
    return static_cast<std::size_t>(
        std::count_if(sent_.begin(), sent_.end(), [](const auto& message) { return !message.expired(); }));
  }

  SignalAssembly& assembly() { return assembly_; }
  const SignalAssembly& assembly() const { return assembly_; }
  std::size_t errors_due() const { return errors_due_; }
  int restarts() const { return restarts_; }
  const std::vector<CompleteBatch>& batches() const { return batches_; }

private:
  void take_errors(const DueSignals& due) {
    const std::size_t follower = due.follower;
    const MessageId& id = due.id;
    ++errors_due_;
    const auto last = latest_.find(follower);
    if (last != latest_.end()) {
      const MessageId& before = last->second;
      const bool next_step = id.first_realization == before.first_realization && id.step == before.step + 1;
      const bool next_batch = schedule_.is_last_step(before.step) && id.step == 0 &&
                              id.first_realization == schedule_.next(before.first_realization);
      EXPECT_TRUE(next_step || next_batch) << "out of order: follower " << follower;
    } else {
      EXPECT_EQ(id.step, 0);
    }
    latest_[follower] = id;
    ASSERT_EQ(due.own[0]->size(), schedule_.size(id.first_realization));
    for (std::size_t r = 0; r < due.own[0]->size(); ++r) {
      EXPECT_DOUBLE_EQ(kError({(*due.ahead[0])[r]}, {(*due.own[0])[r], (*due.own[1])[r]}),
                       error(follower, id.first_realization + r, id.step))
          << "follower " << follower << ", realization " << id.first_realization + r << ", step " << id.step;
      for (std::int64_t j = 0; j <= Signal::kHighestOrder; ++j) {
        ASSERT_EQ((*due.own[static_cast<std::size_t>(j)])[r],
                  position(follower, id.first_realization + r, std::max(id.step - j, kInitialStep)));
        ASSERT_EQ((*due.ahead[static_cast<std::size_t>(j)])[r],
                  position(follower - 1, id.first_realization + r, std::max(id.step - j, kInitialStep)));
      }
    }
    ++due_[id.first_realization];
  }

  void take_batch(const CompleteBatch& batch) {
    EXPECT_EQ(due_[batch.first_realization], kFollowers * static_cast<std::size_t>(schedule_.steps))
        << "all errors of a batch are handed out before it is complete";
    batches_.push_back(batch);
  }

  void restart() {
    ++restarts_;
    due_.clear();
    latest_.clear();
  }

  BatchSchedule schedule_;
  std::map<std::uint64_t, std::size_t> due_;
  std::map<std::size_t, MessageId> latest_;
  std::size_t errors_due_ = 0;
  int restarts_ = 0;
  std::vector<CompleteBatch> batches_;
  std::vector<std::weak_ptr<const std::vector<double>>> sent_;
  SignalAssembly assembly_;
};

}  // namespace platoon
