#pragma once

#include <ros/callback_queue.h>
#include <ros/forwards.h>
#include <ros/service_callback_helper.h>
#include <ros/subscription_callback_helper.h>
#include <std_srvs/TriggerResponse.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <random>
#include <string>
#include <vector>

namespace platoon::simulation {

using Action = std::function<void()>;

class World;
struct Connection;

/// A process with one ROS node. It ends with its object; what it has published stays on its way.
class Node {
public:
  Node(World& world, std::string name);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  World& world() const { return world_; }
  const std::string& name() const { return name_; }
  ros::CallbackQueue& queue() { return *queue_; }
  std::uint64_t number() const { return number_; }  ///< of all nodes ever started

private:
  World& world_;
  std::string name_;
  std::uint64_t number_;
  std::unique_ptr<ros::CallbackQueue> queue_;
};

/// A topic as a node publishes it.
struct SentTopic {
  Node* node;
  std::string topic;
  bool latch;
  boost::shared_ptr<ros::M_string> header;
  std::optional<ros::SerializedMessage> latched = {};  ///< the latest message of a latching topic
  std::vector<std::shared_ptr<Connection>> connections = {};
};

/// A topic as a node receives it.
struct ReceivedTopic {
  Node* node;
  std::string topic;
  ros::SubscriptionCallbackHelperPtr helper;
};

/// A service as a node offers it.
struct OfferedService {
  Node* node;
  ros::ServiceCallbackHelperPtr helper;
};

/// A connection of a node that sends a topic to one that receives it. Its messages arrive in their order, while it is
/// up.
struct Connection {
  std::weak_ptr<SentTopic> sent;
  std::weak_ptr<ReceivedTopic> received;
  bool is_up = false;
  bool is_local = false;         ///< within one process: up at once, and never cut
  std::uint64_t generation = 0;  ///< a cut loses what is on its way
  double latest = 0.0;           ///< [s] arrival of the latest message
  double slow_until = 0.0;       ///< [s]
};

/// The machines, the master and the network: one thread, one random sequence, virtual time. The classes of roscpp that
/// nodes use act on it, see roscpp.cpp, so that the nodes are those of the package, unchanged.
class World {
public:
  explicit World(std::uint64_t seed);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  static World* present();              ///< null outside of a simulation
  Node* node() const { return node_; }  ///< whose code is running; null for none

  double now() const { return now_; }  ///< [s]
  double uniform(double from, double to);
  bool happens(double probability) { return uniform(0.0, 1.0) < probability; }

  /// Runs `action` as code of the node, at once.
  void as(Node* node, const Action& action);
  /// Runs it after a time [s]; drops it if the node has ended by then. Null: as code of no node.
  void after(double seconds, Node* node, Action action);

  /// Executes events until `done` returns true or time reaches `end` [s]; returns whether `done` did.
  bool run_until(const std::function<bool()>& done, double end);

  /// Like SIGSTOP: delays all events of the node to the end of the pause.
  void pause(const Node& node, double seconds);

  void open(const std::shared_ptr<SentTopic>& sent);
  void close(const SentTopic& sent);
  void open(const std::shared_ptr<ReceivedTopic>& received);
  void publish(SentTopic& sent, const ros::SerializedMessage& message);
  std::size_t connections_to(const ReceivedTopic& received) const;
  std::size_t connections_of(const SentTopic& sent) const;

  std::vector<std::shared_ptr<Connection>> all_connections() const;
  void cut(const std::shared_ptr<Connection>& connection);

  /// The nodes that are registered as publishers, by topic.
  std::map<std::string, std::vector<std::string>> publishers() const;

  std::map<std::string, XmlRpc::XmlRpcValue> parameters;
  std::map<std::string, OfferedService> services;

  /// Calls a service of type std_srvs/Trigger and passes its answer on; drops the call if no node serves it or the node
  /// ends before.
  void call(const std::string& service, std::function<void(const std_srvs::TriggerResponse&)> answer);

  /// Called with every line that a node logs, as "vehicle_1: WARN text".
  std::function<void(const std::string& line)> log = {};
  /// Called with every message that is published: returns what is sent in its place, none to send nothing.
  std::function<std::optional<ros::SerializedMessage>(const SentTopic&, const ros::SerializedMessage&)> tamper = {};
  /// Called if a callback of a node throws.
  std::function<void(Node& node, const std::string& error)> died = {};

private:
  friend class Node;
  struct Event {
    double time;
    std::uint64_t order;
    std::uint64_t node;  ///< its number; 0 for none
    Action action;
  };
  struct Later {
    bool operator()(const Event& one, const Event& other) const {
      return one.time != other.time ? one.time > other.time : one.order > other.order;
    }
  };
  struct Topic {
    std::vector<std::weak_ptr<SentTopic>> sent = {};
    std::vector<std::weak_ptr<ReceivedTopic>> received = {};
  };

  void execute(Event event);
  void connect(const std::shared_ptr<SentTopic>& sent, const std::shared_ptr<ReceivedTopic>& received);
  void come_up(const std::shared_ptr<Connection>& connection, double seconds);
  void send(const std::shared_ptr<Connection>& connection, const ros::SerializedMessage& message);
  double delay(const Connection& connection);
  void set_time(double time);

  double now_;
  double slowness_;  ///< of the network: many faults strike within a run on a slow one
  std::mt19937_64 random_;
  std::uint64_t events_ = 0, nodes_ = 0;
  std::priority_queue<Event, std::vector<Event>, Later> queue_;
  std::map<std::uint64_t, Node*> living_;   ///< by number
  std::map<std::uint64_t, double> paused_;  ///< [s] end of the pause
  std::map<std::string, Topic> topics_;
  Node* node_ = nullptr;
};

}  // namespace platoon::simulation
