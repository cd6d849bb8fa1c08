#include "stochastic_platoon/run/delivery/message_pairs.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
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

using Steps = std::vector<std::pair<int, int>>;

Steps pairs_of(MessagePairs<Pointer>& pairs, std::uint64_t run) {
  Steps found;
  pairs.visit(run, [&found](const auto& position, const auto& input) {
    EXPECT_EQ(position->run, input->run);
    EXPECT_EQ(position->attempt, input->attempt);
    found.emplace_back(position->step, input->step);
  });
  return found;
}

TEST(MessagePairs, WaitForBothMessages) {
  MessagePairs<Pointer> pairs;
  pairs.add_position(message(1, 1, -1));
  pairs.add_position(message(1, 1, 0));
  EXPECT_EQ(pairs_of(pairs, 1), Steps());
  pairs.add_input(message(1, 1, -1));
  EXPECT_EQ(pairs_of(pairs, 1), (Steps{{-1, -1}}));
  pairs.add_input(message(1, 1, 0));
  EXPECT_EQ(pairs_of(pairs, 1), (Steps{{0, 0}}));
}

TEST(MessagePairs, OmitSingleMessagesOfAnOlderAttempt) {
  for (const bool positions_are_ahead : {true, false}) {
    MessagePairs<Pointer> pairs;
    const auto add = [&pairs](bool position, const Pointer& of) {
      position ? pairs.add_position(of) : pairs.add_input(of);
    };
    for (int step = -1; step < 3; ++step) add(positions_are_ahead, message(1, 1, step));
    add(!positions_are_ahead, message(1, 1, -1));
    add(!positions_are_ahead, message(1, 2, -1));
    EXPECT_EQ(pairs_of(pairs, 1), (Steps{{-1, -1}}));
    add(positions_are_ahead, message(1, 2, -1));
    EXPECT_EQ(pairs_of(pairs, 1), (Steps{{-1, -1}}));
  }
}

TEST(MessagePairs, OmitMessagesOfAnotherRun) {
  MessagePairs<Pointer> pairs;
  pairs.add_input(message(7, 9, 3));
  pairs.add_position(message(8, 1, -1));
  pairs.add_input(message(8, 1, -1));
  EXPECT_EQ(pairs_of(pairs, 8), (Steps{{-1, -1}}));
  pairs.add_position(message(7, 9, 4));
  pairs.add_input(message(8, 1, 0));
  pairs.add_position(message(8, 1, 0));
  EXPECT_EQ(pairs_of(pairs, 8), (Steps{{0, 0}}));
}

}  // namespace
}  // namespace platoon
