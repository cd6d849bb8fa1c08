// The part of roscpp that the nodes use, within a simulation::World. The linker prefers these definitions to those of
// libroscpp and librosconsole, so that the sources of the package run unchanged, without a master, sockets and threads.

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/master.h>
#include <ros/node_handle.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <boost/make_shared.hpp>
#include <cstdarg>
#include <cstdio>
#include <map>
#include <sstream>
#include <string>

#include "simulation/world.hpp"
#include "stochastic_platoon/ros/transport/kept_topics.hpp"

using platoon::simulation::Node;
using platoon::simulation::ReceivedTopic;
using platoon::simulation::SentTopic;
using platoon::simulation::World;

namespace {

World& world() {
  return *World::present();
}

Node* running() {
  return World::present() != nullptr ? World::present()->node() : nullptr;
}

struct PeriodicCall {
  Node* node;
  double period;
  ros::SteadyTimerCallback callback;
};

// What stands behind the handles of roscpp, by the address of their implementation.
std::map<const void*, std::shared_ptr<SentTopic>> publications;
std::map<const void*, std::shared_ptr<ReceivedTopic>> subscriptions;
std::map<const void*, std::shared_ptr<PeriodicCall>> timers;
std::map<const void*, const Node*> services;

void run_timer(const std::weak_ptr<PeriodicCall>& weak) {
  const std::shared_ptr<PeriodicCall> timer = weak.lock();
  if (!timer) return;
  world().after(timer->period, timer->node, [weak] { run_timer(weak); });
  timer->callback(ros::SteadyTimerEvent());
}

std::string absolute_name(const std::string& name_space, const std::string& name) {
  return name.empty() ? name_space : name.front() == '/' ? name : name_space + "/" + name;
}

void log(ros::console::Level level, const std::string& text) {
  if (level < ros::console::levels::Info || World::present() == nullptr || !world().log) return;
  const char* const names[] = {"DEBUG", "INFO", "WARN", "ERROR", "FATAL"};
  world().log((running() != nullptr ? running()->name() : "nobody") + ": " + names[level] + " " + text);
}

}  // namespace

namespace ros {

NodeHandle::NodeHandle(const std::string& ns, const M_string&)
    : namespace_(ns), callback_queue_(nullptr), collection_(nullptr), ok_(true) {}
NodeHandle::NodeHandle(const NodeHandle& other)
    : namespace_(other.namespace_), callback_queue_(nullptr), collection_(nullptr), ok_(true) {}
NodeHandle::~NodeHandle() {}
NodeHandle& NodeHandle::operator=(const NodeHandle& other) {
  namespace_ = other.namespace_;
  return *this;
}
void NodeHandle::setCallbackQueue(CallbackQueueInterface*) {}
std::string NodeHandle::resolveName(const std::string& name, bool) const {
  return absolute_name(namespace_, name);
}

Publisher NodeHandle::advertise(AdvertiseOptions& options) {
  Publisher publisher;
  publisher.impl_ = boost::make_shared<Publisher::Impl>();
  Publisher::Impl& impl = *publisher.impl_;
  impl.topic_ = resolveName(options.topic, true);
  impl.md5sum_ = options.md5sum;
  impl.datatype_ = options.datatype;
  impl.latch_ = options.latch;
  const auto header = boost::make_shared<M_string>();
  (*header)["callerid"] = running()->name();
  (*header)["topic"] = impl.topic_;
  const auto publication = std::make_shared<SentTopic>(SentTopic{running(), impl.topic_, impl.latch_, header});
  publications[&impl] = publication;
  world().open(publication);
  return publisher;
}

Publisher::Impl::~Impl() {
  unadvertise();
}
void Publisher::Impl::unadvertise() {
  const auto found = publications.find(this);
  if (found == publications.end()) return;
  const std::shared_ptr<SentTopic> publication = found->second;
  publications.erase(found);
  unadvertised_ = true;
  if (World::present() != nullptr) world().close(*publication);
}
void Publisher::publish(const boost::function<SerializedMessage()>& serialized, SerializedMessage& message) const {
  const auto found = publications.find(impl_.get());
  if (found == publications.end()) return;
  world().publish(*found->second, message.message ? message : serialized());
}
std::uint32_t Publisher::getNumSubscribers() const {
  const auto found = publications.find(impl_.get());
  return found == publications.end() ? 0 : static_cast<std::uint32_t>(world().connections_of(*found->second));
}

Subscriber NodeHandle::subscribe(SubscribeOptions& options) {
  Subscriber subscriber;
  subscriber.impl_ = boost::make_shared<Subscriber::Impl>();
  Subscriber::Impl& impl = *subscriber.impl_;
  impl.topic_ = resolveName(options.topic, true);
  const auto subscription = std::make_shared<ReceivedTopic>(ReceivedTopic{running(), impl.topic_, options.helper});
  subscriptions[&impl] = subscription;
  world().open(subscription);
  return subscriber;
}

Subscriber::Impl::~Impl() {
  unsubscribe();
}
void Subscriber::Impl::unsubscribe() {
  subscriptions.erase(this);
  unsubscribed_ = true;
}
std::uint32_t Subscriber::getNumPublishers() const {
  const auto found = subscriptions.find(impl_.get());
  return found == subscriptions.end() ? 0 : static_cast<std::uint32_t>(world().connections_to(*found->second));
}

SteadyTimer NodeHandle::createSteadyTimer(SteadyTimerOptions& options) const {
  SteadyTimer timer;
  timer.impl_ = boost::make_shared<SteadyTimer::Impl>();
  const auto behind = std::make_shared<PeriodicCall>(PeriodicCall{running(), options.period.toSec(), options.callback});
  timers[timer.impl_.get()] = behind;
  const std::weak_ptr<PeriodicCall> weak = behind;
  world().after(behind->period, behind->node, [weak] { run_timer(weak); });
  return timer;
}
SteadyTimer NodeHandle::createSteadyTimer(WallDuration period, const SteadyTimerCallback& callback, bool oneshot,
                                          bool autostart) const {
  SteadyTimerOptions options(period, callback, nullptr, oneshot, autostart);
  return createSteadyTimer(options);
}
SteadyTimer::Impl::~Impl() {
  stop();
}
void SteadyTimer::Impl::stop() {
  timers.erase(this);
}

ServiceServer NodeHandle::advertiseService(AdvertiseServiceOptions& options) {
  ServiceServer server;
  server.impl_ = boost::make_shared<ServiceServer::Impl>();
  ServiceServer::Impl& impl = *server.impl_;
  impl.service_ = resolveName(options.service, true);
  world().services[impl.service_] = {running(), options.helper};
  services[&impl] = running();
  return server;
}

ServiceServer::Impl::Impl() : unadvertised_(false) {}
ServiceServer::Impl::~Impl() {
  unadvertise();
}
void ServiceServer::Impl::unadvertise() {
  const auto found = services.find(this);
  if (found == services.end()) return;
  unadvertised_ = true;
  if (World::present() != nullptr) {
    const auto offered = world().services.find(service_);
    if (offered != world().services.end() && offered->second.node == found->second) world().services.erase(offered);
  }
  services.erase(found);
}

CallbackQueue* getGlobalCallbackQueue() {
  static CallbackQueue nobodys;
  return running() != nullptr ? &running()->queue() : &nobodys;
}

namespace this_node {

const std::string& getName() {
  static std::string name;
  name = running() != nullptr ? running()->name() : "/nobody";
  return name;
}
const std::string& getNamespace() {
  static const std::string name = "/platoon";
  return name;
}

}  // namespace this_node

namespace master {

// The parameters' own functions are those of roscpp.
bool execute(const std::string& method, const XmlRpc::XmlRpcValue& request, XmlRpc::XmlRpcValue&,
             XmlRpc::XmlRpcValue& payload, bool) {
  auto& parameters = world().parameters;
  const auto key = [&request]() -> const std::string& { return request[1]; };
  if (method == "setParam") return parameters[key()] = request[2], true;
  if (method == "deleteParam") return parameters.erase(key()) > 0;
  if (method == "hasParam") return payload = parameters.count(key()) > 0, true;
  if (method == "getParam") {
    const auto found = parameters.find(key());
    if (found != parameters.end()) payload = found->second;
    return found != parameters.end();
  }
  if (method != "getSystemState") return false;
  payload = XmlRpc::XmlRpcValue();
  payload[0].setSize(0);
  int t = 0;
  for (const auto& [topic, names] : world().publishers()) {
    payload[0][t][0] = topic;
    payload[0][t][1].setSize(0);
    for (std::size_t n = 0; n < names.size(); ++n) payload[0][t][1][static_cast<int>(n)] = names[n];
    ++t;
  }
  return true;
}

}  // namespace master

namespace console {

void print(FilterBase*, void*, Level level, const std::stringstream& text, const char*, int, const char*) {
  log(level, text.str());
}
void print(FilterBase*, void*, Level level, const char*, int, const char*, const char* format, ...) {
  char text[2000];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  log(level, text);
}

}  // namespace console

}  // namespace ros

namespace platoon {

// A process keeps its publishers; here all nodes share one process.
ros::Publisher kept_publisher(ros::NodeHandle node, ros::AdvertiseOptions options) {
  return node.advertise(options);
}

KeptTopics::~KeptTopics() = default;

}  // namespace platoon
