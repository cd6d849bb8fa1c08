#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <string>

namespace platoon {

/// Keeps a topic advertised until KeptTopics ends, over every change of the run. The callback queue of `options` is the
/// global one, as components with queues of their own end before.
void keep_advertised(ros::NodeHandle node, ros::AdvertiseOptions options);

/// Advertises a topic that stays advertised when its publisher ends. A component that withdraws a topic and advertises
/// it again for the next run loses rospy's subscribers if they notice the new registration before the end of the old
/// connection: rospy does not connect to an address that it still counts, and does not repeat a connection that has
/// ended. Needed for topics that a node in Python may subscribe to.
template <typename Message>
ros::Publisher advertise_kept(ros::NodeHandle node, const std::string& topic, std::uint32_t queue_size,
                              bool latch = false) {
  ros::AdvertiseOptions options = ros::AdvertiseOptions::create<Message>(topic, queue_size, {}, {}, {}, nullptr);
  options.latch = latch;
  keep_advertised(node, options);
  return node.advertise<Message>(topic, queue_size, latch);
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
