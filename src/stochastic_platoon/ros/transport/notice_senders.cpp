#include "stochastic_platoon/ros/transport/notice_senders.hpp"

#include <ros/console.h>

#include <algorithm>
#include <vector>

#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/publishers.hpp"
#include "stochastic_platoon/run/io/clock.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

NoticeSenders::NoticeSenders(const ros::NodeHandle& platoon, const PlatoonModel& model)
    : name_space_(platoon.resolveName(kProgressTopic)), channel_topic_(received_topic(vehicle(model, 1), 1, 0)) {
  name_space_.resize(name_space_.rfind('/') + 1);
}

bool NoticeSenders::admits(const ros::MessageEvent<const stochastic_platoon::Progress>& event) {
  const std::string& component = event.getConstMessage()->receiver;
  const std::string& node = event.getPublisherName();
  if (node == rejected_ && now() < until_) return false;
  // Not resolveName(): the text is another node's and may be no name.
  const std::string topic = name_space_ + (component == "channel" ? channel_topic_ : component + "/position");
  const std::vector<std::string> publishers = registered_publishers(topic);
  const bool publishes = std::find(publishers.begin(), publishers.end(), node) != publishers.end();
  if (publishes && (publishers.size() == 1 || node.compare(0, name_space_.size(), name_space_) == 0)) return true;
  rejected_ = node;
  until_ = now() + 1.0;
  ROS_WARN_STREAM("progress: ignored a notice of \"" << printable(shortened(component)) << "\" from the node "
                                                     << printable(shortened(node)) << ", which is not the publisher of "
                                                     << printable(shortened(topic)));
  return false;
}

}  // namespace platoon
