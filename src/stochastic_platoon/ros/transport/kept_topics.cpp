#include "stochastic_platoon/ros/transport/kept_topics.hpp"

#include <map>
#include <mutex>
#include <string>
#include <utility>

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

ros::Publisher kept(ros::Publisher publisher) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  registry().topics[publisher.getTopic()] = publisher;
  return publisher;
}

KeptTopics::~KeptTopics() {
  std::map<std::string, ros::Publisher> topics;
  const std::lock_guard<std::mutex> lock(registry().mutex);
  topics.swap(registry().topics);
}

}  // namespace platoon
