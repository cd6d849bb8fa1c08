#include "stochastic_platoon/ros/bags/message_digest.hpp"

namespace platoon {

std::uint64_t message_digest(const stochastic_platoon::Position& message, std::uint64_t seed) {
  constexpr std::size_t kFixed = 8 + 4 + 8 + 8 + 4;
  const std::uint32_t header = ros::serialization::serializationLength(message.header);
  std::vector<std::uint8_t> bytes(header + kFixed);
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  stream.next(message.header);
  stream.next(message.run);
  stream.next(message.attempt);
  stream.next(message.first_realization);
  stream.next(message.step);
  stream.next(static_cast<std::uint32_t>(message.position.size()));
  Xxhash64 hash(seed);
  hash.add(bytes.data(), bytes.size());
  hash.add(message.position.data(), message.position.size() * sizeof(double));
  return hash.value();
}

}  // namespace platoon
