#include "stochastic_platoon/ros/transport/live_publisher.hpp"

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpc.h>

#include <map>
#include <set>

namespace platoon {

namespace {

using XmlRpc::XmlRpcValue;

constexpr double kPatience = 1000.0;  // [ms]

std::set<std::string> published_by(const std::string& node) {
  XmlRpcValue request, response, address, answer;
  request[0] = ros::this_node::getName();
  request[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::master::execute("lookupNode", request, response, address, false)) return {};
  if (!ros::network::splitURI(address, host, port)) return {};
  XmlRpcValue caller;
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

std::optional<TopicPublisher> live_publisher(const std::function<bool(const std::string& topic)>& selected) {
  XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, false)) return std::nullopt;
  std::map<std::string, std::set<std::string>> published;  // by node
  for (int t = 0; t < state[0].size(); ++t) {
    const std::string topic = state[0][t][0];
    if (!selected(topic)) continue;
    for (int n = 0; n < state[0][t][1].size(); ++n) {
      const std::string node = state[0][t][1][n];
      const auto entry = published.find(node) != published.end() ? published.find(node)
                                                                 : published.emplace(node, published_by(node)).first;
      if (entry->second.count(topic) > 0) return TopicPublisher{node, topic};
    }
  }
  return std::nullopt;
}

}  // namespace platoon
