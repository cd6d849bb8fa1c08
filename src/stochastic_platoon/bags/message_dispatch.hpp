#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <rosbag/message_instance.h>
#include <std_msgs/String.h>

#include <boost/make_shared.hpp>
#include <string>

#include "stochastic_platoon/bags/bag_reader.hpp"
#include "stochastic_platoon/messages/serialized.hpp"

namespace platoon {

/// What one topic of a bag is to a reader.
struct TopicReading {
  std::optional<PlatoonTopic> topic;  ///< none: foreign
  bool wanted = false;
};

/// Whether `content` wants a topic of this name and type. A platoon's name with another type is foreign.
TopicReading reading_of(const BagContent& content, const std::string& name, const std::string& type,
                        const std::string& md5);

/// The message of an open bag; `buffer` is for the bytes of one after the other. Throws BagError and what rosbag
/// throws.
template <typename Message>
boost::shared_ptr<Message> instantiated(const rosbag::MessageInstance& instance, std::string& buffer) {
  if (!instance.isType<Message>())
    throw BagError(instance.getTopic() + ": holds a message that cannot be read");
  buffer.resize(instance.size());
  auto* bytes = reinterpret_cast<std::uint8_t*>(buffer.data());
  ros::serialization::OStream written(bytes, static_cast<std::uint32_t>(buffer.size()));
  instance.write(written);
  if (!holds_its_arrays<Message>(buffer))
    throw BagError(instance.getTopic() + ": holds a message that is cut off");
  ros::serialization::IStream stream(bytes, static_cast<std::uint32_t>(buffer.size()));
  auto message = boost::make_shared<Message>();
  ros::serialization::deserialize(stream, *message);
  return message;
}

/// Hands a message to whom it is for. `get` makes a shared pointer to the message of the type it is given.
template <typename Get>
void dispatch(const BagContent& content, const PlatoonTopic& topic, const Get& get) {
  switch (topic.kind) {
    case PlatoonTopic::Kind::position:
      return content.position(topic, get(stochastic_platoon::Position()));
    case PlatoonTopic::Kind::predecessor_position:
      return content.predecessor_position(topic, get(stochastic_platoon::Position()));
    case PlatoonTopic::Kind::error_statistics:
      return content.error_statistics(topic, get(stochastic_platoon::ErrorStatistics()));
    case PlatoonTopic::Kind::configuration:
      return content.configuration(topic, get(std_msgs::String())->data);
  }
}

}  // namespace platoon
