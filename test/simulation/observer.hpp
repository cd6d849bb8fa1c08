#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Progress.h>

#include <algorithm>
#include <map>
#include <string>

#include "simulation/process.hpp"

namespace platoon::simulation {

/// The node that ends a launch: waits until every receiver has finished, as until_complete does.
class Observer {
public:
  Observer(World& world, const Configuration& configuration)
      : node_(world, std::string(kNamespace) + "/until_complete"), run_(run_identity(configuration)) {
    for (const std::string& receiver : configuration.run.receivers()) finished_[receiver] = false;
    world.as(&node_, [this] {
      ros::NodeHandle platoon(kNamespace);
      progress_ = platoon.subscribe(kProgressTopic, 100, &Observer::receive, this);
    });
  }

  bool complete() const {
    return std::all_of(finished_.begin(), finished_.end(), [](const auto& entry) { return entry.second; });
  }

private:
  void receive(const stochastic_platoon::Progress::ConstPtr& message) {
    const auto found = finished_.find(message->receiver);
    if (message->run == run_ && found != finished_.end()) found->second = message->finished;
  }

  Node node_;
  std::uint64_t run_;
  std::map<std::string, bool> finished_;
  ros::Subscriber progress_;
};

}  // namespace platoon::simulation
