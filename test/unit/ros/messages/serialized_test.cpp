#include "stochastic_platoon/ros/messages/serialized.hpp"

#include <gtest/gtest.h>
#include <std_msgs/String.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <string>

namespace platoon {
namespace {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

template <typename Message>
std::string serialized(const Message& message) {
  std::string bytes(ros::serialization::serializationLength(message), '\0');
  ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(&bytes[0]),
                                     static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

template <typename Message>
bool holds(const std::string& bytes) {
  return holds_its_arrays(ros::message_traits::datatype<Message>(), bytes);
}

// Accepts the whole message, rejects every truncation of it and every length with an additional bit.
template <typename Message>
void expect_arrays_held(const Message& message) {
  const std::string whole = serialized(message);
  EXPECT_TRUE(holds<Message>(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_FALSE(holds<Message>(whole.substr(0, size))) << size;
}

Position position() {
  Position message;
  message.header.frame_id = "platoon";
  message.position = {1.0, 2.0, 3.0};
  return message;
}

TEST(HoldsItsArrays, IsSoOfWholeMessagesOnly) {
  expect_arrays_held(position());
  expect_arrays_held(Position());
  ErrorStatistics statistics;
  statistics.mean = statistics.variance = {1.0, 2.0};
  statistics.theoretical_variance = {3.0};
  expect_arrays_held(statistics);
}

TEST(HoldsItsArrays, IsNotSoWhereALengthHasAWrongBit) {
  std::string bytes = serialized(position());
  const std::size_t length = bytes.size() - 3 * sizeof(double) - 4;
  for (const std::size_t place : {length, length + 3}) {
    bytes[place] = static_cast<char>(bytes[place] ^ 0x40);
    EXPECT_FALSE(holds<Position>(bytes));
    bytes[place] = static_cast<char>(bytes[place] ^ 0x40);
  }
  bytes[12 + 3] = 0x40;  // of frame_id
  EXPECT_FALSE(holds<Position>(bytes));
}

TEST(HoldsItsArrays, IsSoOfAMessageWithoutArrays) {
  EXPECT_TRUE(holds<std_msgs::String>(""));
}

}  // namespace
}  // namespace platoon
