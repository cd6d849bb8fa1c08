#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace platoon {

/// The address that the master has for a node's name; empty if it has none.
std::string address_of(const std::string& node);

/// The names of the nodes registered with the master as publishers of a topic, sorted, connected or not; empty if the
/// master does not answer.
std::vector<std::string> registered_publishers(const std::string& topic);

/// Those of these vehicles whose control inputs have no publisher registered with the master; none if the master does
/// not answer.
std::vector<std::size_t> mute_vehicles(std::vector<std::size_t> vehicles);

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
