#pragma once

#include <ros/serialization.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <string>
#include <vector>

#include "stochastic_platoon/run/io/xxhash64.hpp"

namespace platoon {

// The terms of the sum that msg/Checksum.msg defines.

/// The seed of a message's digest: its topic by `xxhash64(topic)`, and its recorded time [ns].
inline std::uint64_t digest_seed(std::uint64_t topic, std::uint64_t time) {
  return topic + time;
}

/// Digest of a message as ROS serializes it.
template <typename Message>
std::uint64_t message_digest(const Message& message, std::uint64_t seed) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  Xxhash64 hash(seed);
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

/// The same, without a copy of its positions.
std::uint64_t message_digest(const stochastic_platoon::Position& message, std::uint64_t seed);

}  // namespace platoon
