#include "stochastic_platoon/run/delivery/message_sets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace platoon {
namespace {

struct Message {
  std::uint64_t run;
  std::uint32_t attempt;
  int step;
};

using Pointer = std::shared_ptr<const Message>;

Pointer message(std::uint64_t run, std::uint32_t attempt, int step) {
  return std::make_shared<const Message>(Message{run, attempt, step});
}

using Steps = std::vector<std::vector<int>>;

Steps steps_of(MessageSets<Pointer>& sets, std::uint64_t run) {
  Steps found;
  sets.visit(run, [&found](const std::vector<Pointer>& set) {
    std::vector<int> steps;
    for (const Pointer& of : set) {
      EXPECT_EQ(of->run, set.front()->run);
      EXPECT_EQ(of->attempt, set.front()->attempt);
      steps.push_back(of->step);
    }
    found.push_back(steps);
  });
  return found;
}

TEST(MessageSets, WaitForAllMessages) {
  MessageSets<Pointer> sets(3);
  sets.add(0, message(1, 1, -1));
  sets.add(0, message(1, 1, 0));
  sets.add(2, message(1, 1, -1));
  EXPECT_EQ(steps_of(sets, 1), Steps());
  sets.add(1, message(1, 1, -1));
  EXPECT_EQ(steps_of(sets, 1), (Steps{{-1, -1, -1}}));
  sets.add(1, message(1, 1, 0));
  sets.add(2, message(1, 1, 0));
  EXPECT_EQ(steps_of(sets, 1), (Steps{{0, 0, 0}}));
}

TEST(MessageSets, ConsistOfOneMessageForOneTopic) {
  MessageSets<Pointer> sets(1);
  sets.add(0, message(1, 1, -1));
  sets.add(0, message(1, 2, -1));
  EXPECT_EQ(steps_of(sets, 1), (Steps{{-1}, {-1}}));
}

TEST(MessageSets, KeepTwoAttemptsWhileATopicIsSilent) {
  MessageSets<Pointer> sets(2);
  std::vector<std::weak_ptr<const Message>> added;
  for (std::uint32_t attempt = 1; attempt <= 50; ++attempt) {
    for (int step = -1; step < 3; ++step) {
      const Pointer of = message(1, attempt, step);
      added.emplace_back(of);
      sets.add(0, of);
    }
    EXPECT_EQ(steps_of(sets, 1), Steps());
  }
  EXPECT_EQ(std::count_if(added.begin(), added.end(), [](const auto& of) { return !of.expired(); }), 8);
  for (int step = -1; step < 3; ++step) sets.add(1, message(1, 50, step));
  EXPECT_EQ(steps_of(sets, 1), (Steps{{-1, -1}, {0, 0}, {1, 1}, {2, 2}}));
}

TEST(MessageSets, OmitSingleMessagesOfAnOlderAttempt) {
  for (const std::size_t ahead : {0, 1, 2}) {
    MessageSets<Pointer> sets(3);
    const auto add_to_others = [&](const Pointer& of) {
      for (const std::size_t topic : {0, 1, 2}) {
        if (topic != ahead) sets.add(topic, of);
      }
    };
    for (int step = -1; step < 3; ++step) sets.add(ahead, message(1, 1, step));
    add_to_others(message(1, 1, -1));
    add_to_others(message(1, 2, -1));
    EXPECT_EQ(steps_of(sets, 1), (Steps{{-1, -1, -1}}));
    sets.add(ahead, message(1, 2, -1));
    EXPECT_EQ(steps_of(sets, 1), (Steps{{-1, -1, -1}}));
  }
}

TEST(MessageSets, OmitMessagesOfAnotherRun) {
  MessageSets<Pointer> sets(2);
  sets.add(1, message(7, 9, 3));
  sets.add(0, message(8, 1, -1));
  sets.add(1, message(8, 1, -1));
  EXPECT_EQ(steps_of(sets, 8), (Steps{{-1, -1}}));
  sets.add(0, message(7, 9, 4));
  sets.add(1, message(8, 1, 0));
  sets.add(0, message(8, 1, 0));
  EXPECT_EQ(steps_of(sets, 8), (Steps{{0, 0}}));
}

}  // namespace
}  // namespace platoon
