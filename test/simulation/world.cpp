#include "simulation/world.hpp"

#include <ros/serialization.h>
#include <ros/time.h>
#include <std_srvs/TriggerRequest.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <exception>
#include <utility>

#include "simulation/uniform.hpp"

namespace platoon::simulation {

namespace {

World* the_world = nullptr;
double latest_time = 1000.0;  // [s] of the latest world: statics of the code under test must not see time run back

// The global callback queue of a node: its entries are events of the world.
class NodeQueue : public ros::CallbackQueue {
public:
  explicit NodeQueue(Node& node) : node_(node) {}
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override {
    entries_.push_back({callback, owner});
    node_.world().after(node_.world().uniform(0.0, 1e-4), &node_, [this] { take(); });
  }
  void removeByID(std::uint64_t owner) override {
    for (Entry& entry : entries_) {
      if (entry.owner == owner) entry.callback.reset();
    }
  }

private:
  struct Entry {
    ros::CallbackInterfacePtr callback;
    std::uint64_t owner;
  };
  void take() {
    const Entry entry = entries_.front();
    entries_.pop_front();
    if (entry.callback) entry.callback->call();
  }

  Node& node_;
  std::deque<Entry> entries_;
};

template <typename T>
void remove_ended(std::vector<std::weak_ptr<T>>& all) {
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& each) { return each.expired(); }), all.end());
}

}  // namespace

Node::Node(World& world, std::string name) : world_(world), name_(std::move(name)), number_(++world.nodes_) {
  queue_ = std::make_unique<NodeQueue>(*this);
  world_.living_[number_] = this;
}

Node::~Node() {
  world_.living_.erase(number_);
  world_.paused_.erase(number_);
}

World::World(std::uint64_t seed) : now_(latest_time + 1000.0), slowness_(1.0), random_(seed) {
  the_world = this;
  set_time(now_);
  slowness_ = happens(0.5) ? 1.0 : uniform(5.0, 30.0);
}

World::~World() {
  latest_time = now_;
  the_world = nullptr;
}

World* World::present() {
  return the_world;
}

double World::uniform(double from, double to) {
  return from + (to - from) * simulation::uniform(random_);
}

void World::set_time(double time) {
  now_ = time;
  ros::Time::setNow(ros::Time(time));
}

void World::as(Node* node, const Action& action) {
  Node* const before = std::exchange(node_, node);
  try {
    action();
  } catch (...) {
    node_ = before;
    throw;
  }
  node_ = before;
}

void World::after(double seconds, Node* node, Action action) {
  queue_.push({now_ + seconds, ++events_, node != nullptr ? node->number() : 0, std::move(action)});
}

void World::execute(Event event) {
  if (event.node == 0) return event.action();
  const auto found = living_.find(event.node);
  if (found == living_.end()) return;
  const auto pause = paused_.find(event.node);
  if (pause != paused_.end() && pause->second > now_) {
    event.time = pause->second;
    event.order = ++events_;  // delayed events keep their order
    return queue_.push(std::move(event));
  }
  Node& node = *found->second;
  try {
    as(&node, event.action);
  } catch (const std::exception& error) {
    died(node, error.what());
  }
}

bool World::run_until(const std::function<bool()>& done, double end) {
  while (!done()) {
    if (queue_.empty() || queue_.top().time > end) {
      set_time(end);
      return done();
    }
    Event event = queue_.top();
    queue_.pop();
    if (event.time > now_) set_time(event.time);
    execute(std::move(event));
  }
  return true;
}

void World::pause(const Node& node, double seconds) {
  double& until = paused_[node.number()];
  until = std::max(until, now_ + seconds);
}

// A network in one room, or a slower one; each is congested at times.
double World::delay(const Connection& connection) {
  if (connection.is_local) return uniform(0.0, 1e-4);
  if (connection.slow_until > now_) return uniform(0.0, 0.5);
  return happens(0.01) ? uniform(0.0, 0.05) : slowness_ * uniform(1e-5, 1e-3);
}

void World::come_up(const std::shared_ptr<Connection>& connection, double seconds) {
  after(seconds, nullptr, [this, connection, generation = connection->generation] {
    const auto sent = connection->sent.lock();
    if (connection->generation != generation || !sent || connection->received.expired()) return;
    connection->is_up = true;
    if (sent->latched) send(connection, *sent->latched);
  });
}

void World::connect(const std::shared_ptr<SentTopic>& sent, const std::shared_ptr<ReceivedTopic>& received) {
  const auto connection = std::make_shared<Connection>();
  connection->sent = sent;
  connection->received = received;
  sent->connections.push_back(connection);
  connection->is_local = sent->node == received->node;
  if (!connection->is_local) return come_up(connection, happens(0.1) ? uniform(0.0, 1.0) : uniform(0.001, 0.05));
  connection->is_up = true;
  if (sent->latched) send(connection, *sent->latched);
}

void World::open(const std::shared_ptr<SentTopic>& sent) {
  Topic& topic = topics_[sent->topic];
  remove_ended(topic.sent);
  remove_ended(topic.received);
  topic.sent.push_back(sent);
  for (const auto& received : topic.received) connect(sent, received.lock());
}

// Some of what is on its way arrives, as from the buffers of a killed process.
void World::close(const SentTopic& sent) {
  for (const auto& connection : sent.connections) {
    if (!connection->is_local && happens(0.5)) cut(connection);
  }
}

void World::open(const std::shared_ptr<ReceivedTopic>& received) {
  Topic& topic = topics_[received->topic];
  remove_ended(topic.sent);
  remove_ended(topic.received);
  topic.received.push_back(received);
  for (const auto& sent : topic.sent) connect(sent.lock(), received);
}

void World::publish(SentTopic& sent, const ros::SerializedMessage& original) {
  const std::optional<ros::SerializedMessage> message = tamper ? tamper(sent, original) : original;
  if (!message) return;
  if (sent.latch) sent.latched = *message;
  auto& all = sent.connections;
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& each) { return each->received.expired(); }),
            all.end());
  for (const auto& connection : all) {
    if (connection->is_up) send(connection, *message);
  }
}

void World::send(const std::shared_ptr<Connection>& connection, const ros::SerializedMessage& message) {
  const std::shared_ptr<ReceivedTopic> received = connection->received.lock();
  connection->latest = std::max(connection->latest, now_ + delay(*connection));
  const auto header = connection->sent.lock()->header;
  const auto arrive = [connection, generation = connection->generation, message, header] {
    const std::shared_ptr<ReceivedTopic> receiver = connection->received.lock();
    if (!receiver || connection->generation != generation) return;
    ros::VoidConstPtr content = message.message;
    if (!content) {
      ros::SubscriptionCallbackHelperDeserializeParams bytes;
      bytes.buffer = message.message_start;
      bytes.length = static_cast<std::uint32_t>(message.num_bytes - 4);
      bytes.connection_header = header;
      content = receiver->helper->deserialize(bytes);
    }
    ros::SubscriptionCallbackHelperCallParams call;
    call.event = ros::MessageEvent<void const>(content, header, ros::Time::now(), true,
                                               ros::MessageEvent<void const>::CreateFunction());
    receiver->helper->call(call);
  };
  after(connection->latest - now_, received->node, arrive);
}

std::size_t World::connections_to(const ReceivedTopic& received) const {
  const auto topic = topics_.find(received.topic);
  if (topic == topics_.end()) return 0;
  std::size_t count = 0;
  for (const auto& each : topic->second.sent) {
    const auto sent = each.lock();
    if (!sent) continue;
    for (const auto& connection : sent->connections) {
      if (connection->is_up && connection->received.lock().get() == &received) ++count;
    }
  }
  return count;
}

std::size_t World::connections_of(const SentTopic& sent) const {
  return static_cast<std::size_t>(std::count_if(sent.connections.begin(), sent.connections.end(), [](const auto& each) {
    return each->is_up && !each->received.expired();
  }));
}

std::vector<std::shared_ptr<Connection>> World::all_connections() const {
  std::vector<std::shared_ptr<Connection>> all;
  for (const auto& [name, topic] : topics_) {
    for (const auto& each : topic.sent) {
      const auto sent = each.lock();
      if (!sent) continue;
      for (const auto& connection : sent->connections) {
        if (connection->is_up && !connection->is_local && !connection->received.expired()) all.push_back(connection);
      }
    }
  }
  return all;
}

void World::cut(const std::shared_ptr<Connection>& connection) {
  ++connection->generation;
  connection->is_up = false;
  connection->latest = now_;
  come_up(connection, uniform(0.001, 0.5));
}

void World::call(const std::string& service, std::function<void(const std_srvs::TriggerResponse&)> answer) {
  const auto found = services.find(service);
  if (found == services.end()) return;
  after(uniform(1e-4, 0.01), found->second.node, [helper = found->second.helper, answer = std::move(answer)] {
    ros::ServiceCallbackHelperCallParams call;
    call.request = ros::serialization::serializeMessage(std_srvs::TriggerRequest());
    call.connection_header = boost::make_shared<ros::M_string>();
    helper->call(call);
    // One byte for success and four for the length precede the content.
    ros::serialization::IStream content(call.response.buf.get() + 5,
                                        static_cast<std::uint32_t>(call.response.num_bytes - 5));
    std_srvs::TriggerResponse response;
    ros::serialization::deserialize(content, response);
    answer(response);
  });
}

std::map<std::string, std::vector<std::string>> World::publishers() const {
  std::map<std::string, std::vector<std::string>> names;
  for (const auto& [name, topic] : topics_) {
    for (const auto& each : topic.sent) {
      if (const auto sent = each.lock()) names[name].push_back(sent->node->name());
    }
  }
  return names;
}

}  // namespace platoon::simulation
