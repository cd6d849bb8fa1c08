#include "stochastic_platoon/ros/messages/position.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "stochastic_platoon/math/model/vector_clones.hpp"

namespace platoon {

using stochastic_platoon::Position;

PLATOON_VECTOR_CLONES
bool all_finite(const std::vector<double>& values) {
  // Integer arithmetic, so that the loop vectorises: only an exponent of all ones carries into the top bit.
  std::uint64_t carry = 0;
  for (const double value : values) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    carry |= (bits & 0x7ff0000000000000ULL) + 0x0010000000000000ULL;
  }
  return (carry >> 63) == 0;
}

MessageId id_of(const Position& message) {
  return {message.attempt, message.first_realization, message.step};
}

MessageDescriptor descriptor_of(const Position& message) {
  return {id_of(message), message.position.size(), all_finite(message.position)};
}

void set_id(std::uint64_t run, const MessageId& id, Position& message) {
  message.run = run;
  message.attempt = id.attempt;
  message.first_realization = id.first_realization;
  message.step = id.step;
}

Positions positions_of(const Position::ConstPtr& message) {
  return Positions(&message->position, [message](const std::vector<double>*) {});
}

ros::Duration platoon_period(double sample_period) {
  return ros::Duration().fromNSec(static_cast<std::int64_t>(std::llround(sample_period * 1e9)));
}

ros::Time platoon_time(std::uint64_t nanoseconds) {
  return ros::Time().fromNSec(std::min(nanoseconds, ros::TIME_MAX.toNSec()));
}

ros::Time later(const ros::Time& stamp, const ros::Duration& period) {
  return platoon_time(stamp.toNSec() + static_cast<std::uint64_t>(period.toNSec()));
}

}  // namespace platoon
