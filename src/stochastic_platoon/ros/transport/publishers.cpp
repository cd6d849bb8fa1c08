#include "stochastic_platoon/ros/transport/publishers.hpp"

#include <ros/master.h>
#include <ros/names.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpc.h>

#include <algorithm>
#include <map>
#include <set>

#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon {

namespace {

using XmlRpc::XmlRpcValue;

constexpr double kPatience = 1000.0;  // [ms]

// The nodes registered with the master as publishers, by topic; empty if the master does not answer.
std::map<std::string, std::vector<std::string>> registered() {
  XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  std::map<std::string, std::vector<std::string>> publishers;
  if (!ros::master::execute("getSystemState", request, response, state, false)) return publishers;
  for (int t = 0; t < state[0].size(); ++t) {
    for (int n = 0; n < state[0][t][1].size(); ++n) publishers[state[0][t][0]].push_back(state[0][t][1][n]);
  }
  return publishers;
}

// The topics that the node itself lists as published; empty if it does not answer.
std::set<std::string> published_by(const std::string& node) {
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(address_of(node), host, port)) return {};
  XmlRpcValue caller, answer;
  caller[0] = ros::this_node::getName();
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  if (!client.executeNonBlock("getPublications", caller)) return {};
  XmlRpc::XmlRpcDispatch dispatch;
  dispatch.addSource(&client, XmlRpc::XmlRpcDispatch::WritableEvent | XmlRpc::XmlRpcDispatch::Exception);
  dispatch.work(kPatience);
  std::set<std::string> topics;
  if (!client.executeCheckDone(answer) || answer.getType() != XmlRpcValue::TypeArray || answer.size() != 3) return {};
  for (int t = 0; t < answer[2].size(); ++t) topics.insert(answer[2][t][0]);
  return topics;
}

}  // namespace

std::string address_of(const std::string& node) {
  XmlRpcValue request, response, address;
  request[0] = ros::this_node::getName();
  request[1] = node;
  if (!ros::master::execute("lookupNode", request, response, address, false)) return "";
  return address;
}

std::vector<std::string> registered_publishers(const std::string& topic) {
  std::vector<std::string> names = registered()[topic];
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::size_t> mute_vehicles(std::vector<std::size_t> vehicles) {
  const auto published = registered();
  if (published.empty()) return {};
  const auto speaks = [&published](std::size_t i) { return published.count(ros::names::resolve(input_topic(i))) > 0; };
  vehicles.erase(std::remove_if(vehicles.begin(), vehicles.end(), speaks), vehicles.end());
  return vehicles;
}

std::optional<TopicPublisher> live_publisher(const std::function<bool(const std::string& topic)>& selected) {
  std::map<std::string, std::set<std::string>> published;  // by node
  for (const auto& [topic, nodes] : registered()) {
    if (!selected(topic)) continue;
    for (const std::string& node : nodes) {
      const auto known = published.find(node);
      const auto entry = known != published.end() ? known : published.emplace(node, published_by(node)).first;
      if (entry->second.count(topic) > 0) return TopicPublisher{node, topic};
    }
  }
  return std::nullopt;
}

}  // namespace platoon
