#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/String.h>

#include <string>

#include "stochastic_platoon/bags/bag_reader.hpp"

namespace platoon {

/// What one topic of a bag is to a reader.
struct TopicReading {
  std::optional<PlatoonTopic> topic;  ///< none: foreign
  bool wanted = false;
};

/// Whether `content` wants a topic of this name and type. A platoon's name with another type is foreign.
TopicReading reading_of(const BagContent& content, const std::string& name, const std::string& type,
                        const std::string& md5);

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
