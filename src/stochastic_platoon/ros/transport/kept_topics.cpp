#include "stochastic_platoon/ros/transport/kept_topics.hpp"

#include <ros/callback_queue.h>
#include <ros/init.h>

#include <map>
#include <mutex>
#include <string>

namespace platoon {

namespace {

struct Registry {
  std::mutex mutex;
  std::map<std::string, ros::Publisher> topics;
};

Registry& registry() {
  static Registry of_process;
  return of_process;
}

}  // namespace

ros::Publisher kept_publisher(ros::NodeHandle node, ros::AdvertiseOptions options) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  ros::Publisher& topic = registry().topics[node.resolveName(options.topic)];
  if (!topic) {
    options.callback_queue = ros::getGlobalCallbackQueue();  // components with queues of their own end earlier
    topic = node.advertise(options);
  }
  return topic;
}

KeptTopics::~KeptTopics() {
  std::map<std::string, ros::Publisher> topics;
  const std::lock_guard<std::mutex> lock(registry().mutex);
  topics.swap(registry().topics);
}

}  // namespace platoon
