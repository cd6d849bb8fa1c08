#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <string>

namespace platoon {

/// The publisher of a topic that KeptTopics keeps; advertises the topic in the first call.
ros::Publisher kept_publisher(ros::NodeHandle node, ros::AdvertiseOptions options);

/// Advertises a topic that stays advertised until KeptTopics ends, over every change of the run. A component that
/// withdraws a topic and advertises it again for the next run loses rospy's subscribers if they notice the new
/// registration before the end of the old connection: rospy does not connect to an address that it still counts, and
/// does not repeat a connection that has ended. Needed for topics that a node in Python may subscribe to.
template <typename Message>
ros::Publisher advertise_kept(const ros::NodeHandle& node, const std::string& topic, std::uint32_t queue_size,
                              bool latch = false) {
  ros::AdvertiseOptions options = ros::AdvertiseOptions::create<Message>(topic, queue_size, {}, {}, {}, nullptr);
  options.latch = latch;
  return kept_publisher(node, options);
}

/// The lifetime of the kept topics of a process; one object.
class KeptTopics {
public:
  KeptTopics() = default;
  KeptTopics(const KeptTopics&) = delete;
  KeptTopics& operator=(const KeptTopics&) = delete;
  ~KeptTopics();
};

}  // namespace platoon
