#pragma once

#include <functional>
#include <optional>
#include <string>

namespace platoon {

/// A node that publishes a topic.
struct TopicPublisher {
  std::string node, topic;
};

/// A responding publisher of one of the selected topics; none if no publisher or no master responds.
///
/// The master keeps the names of killed nodes, whose addresses other nodes may have by now. The node itself must
/// therefore list the topic, within a second. Call ros::init() before.
std::optional<TopicPublisher> live_publisher(const std::function<bool(const std::string& topic)>& selected);

}  // namespace platoon
