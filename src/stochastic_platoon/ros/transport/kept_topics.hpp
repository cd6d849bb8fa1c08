#pragma once

#include <ros/publisher.h>

namespace platoon {

/// Keeps a topic advertised until KeptTopics ends, over every change of the run, and returns its publisher. A component
/// that withdraws a topic and advertises it again for the next run loses rospy's subscribers if they notice the new
/// registration before the end of the old connection: rospy does not connect to an address that it still counts, and
/// does not repeat a connection that has ended. Needed for topics that a node in Python may subscribe to.
ros::Publisher kept(ros::Publisher publisher);

/// The lifetime of the topics of a process; one object.
class KeptTopics {
public:
  KeptTopics() = default;
  KeptTopics(const KeptTopics&) = delete;
  KeptTopics& operator=(const KeptTopics&) = delete;
  ~KeptTopics();
};

}  // namespace platoon
