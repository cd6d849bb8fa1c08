#include "stochastic_platoon/ros/messages/message_pool.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace platoon {
namespace {

using stochastic_platoon::Position;

TEST(MessagePool, GivesNoMessageThatIsStillHeld) {
  MessagePool pool;
  const Position::Ptr one = pool.take();
  const Position::ConstPtr other = pool.take();
  EXPECT_NE(one.get(), other.get());
  EXPECT_NE(pool.take().get(), one.get());
}

TEST(MessagePool, UsesAReleasedMessageAgainWithItsArray) {
  MessagePool pool;
  Position::Ptr message = pool.take();
  message->position.assign(1000, 1.0);
  const Position* address = message.get();
  message.reset();
  message = pool.take();
  EXPECT_EQ(message.get(), address);
  EXPECT_EQ(message->position.capacity(), 1000u);
}

TEST(MessagePool, HoldsAsManyAsWereInFlightAtOnce) {
  MessagePool pool;
  std::set<const Position*> messages;
  for (int round = 0; round < 10; ++round) {
    std::vector<Position::Ptr> in_flight;
    for (int j = 0; j < 7; ++j) in_flight.push_back(pool.take());
    for (const Position::Ptr& message : in_flight) messages.insert(message.get());
  }
  EXPECT_EQ(messages.size(), 7u);
}

TEST(MessagePool, SharesItsMessagesWithItsCopies) {
  MessagePool pool;
  MessagePool copy = pool;
  const Position* address = copy.take().get();
  EXPECT_EQ(pool.take().get(), address);
}

}  // namespace
}  // namespace platoon
