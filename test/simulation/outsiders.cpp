#include "simulation/outsiders.hpp"

#include <std_msgs/Float64.h>
#include <stochastic_platoon/Position.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <limits>
#include <utility>

#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon::simulation {

using stochastic_platoon::Progress;

Observer::Observer(World& world, const Configuration& configuration)
    : node_(world, std::string(kNamespace) + "/until_complete"), run_(run_identity(configuration)) {
  for (const std::string& receiver : configuration.run.receivers()) finished_[receiver] = false;
  world.as(&node_, [this] {
    progress_ = ros::NodeHandle(kNamespace).subscribe(kProgressTopic, 100, &Observer::receive, this);
  });
}

bool Observer::complete() const {
  return std::all_of(finished_.begin(), finished_.end(), [](const auto& entry) { return entry.second; });
}

void Observer::receive(const Progress::ConstPtr& message) {
  if (message->receiver == "monitor" && message->notice == Progress::NONE) {
    latest_ = *message;
    heard_ = node_.world().now();
  }
  const auto found = finished_.find(message->receiver);
  if (message->run == run_ && found != finished_.end()) found->second = message->finished;
}

Operator::Operator(World& world, Answered answered)
    : world_(world), node_(world, "/operator"), answered_(std::move(answered)) {
  world.as(&node_, [this] { speed_ = ros::NodeHandle(kNamespace).advertise<std_msgs::Float64>("leader/speed", 10); });
}

void Operator::call(const std::string& service) {
  world_.call(std::string(kNamespace) + "/" + service,
              [this, service](const std_srvs::TriggerResponse& response) { answered_(service, response); });
}

void Operator::change_run(std::uint32_t which, double extent) {
  XmlRpc::XmlRpcValue values;
  if (which % 4 < 2) {
    values["headway"] = 2.0 + 2.0 * extent;
  } else if (which % 4 == 2) {
    values["noise_variance"] = extent;
  } else {
    values["loss"] = 0.4 * extent;
  }
  world_.parameters[std::string(kNamespace) + "/" + kChangeRunService] = values;
  call(kChangeRunService);
}

std::string Operator::drive(std::uint32_t which, double extent) {
  const char* const services[] = {"leader/brake", "leader/accelerate", "leader/sinusoid", "leader/cruise"};
  if (which % 5 < 4) {
    call(services[which % 5]);
    return services[which % 5];
  }
  std_msgs::Float64 speed;
  speed.data = extent < 0.1 ? std::numeric_limits<double>::quiet_NaN() : 60.0 * extent - 10.0;
  world_.as(&node_, [&] { speed_.publish(speed); });
  return "leader/speed";
}

void Stranger::publish(const Configuration& configuration, std::uint32_t which, double extent) {
  const auto vehicle = static_cast<std::uint32_t>(which % (configuration.run.followers + 1));
  const bool received = extent < 0.5 && vehicle > 0;
  const std::string topic = received ? predecessor_position_topic(vehicle) : position_topic(vehicle);
  stochastic_platoon::Position message;
  message.run = 1 + which;
  message.step = -1;
  message.position.assign(configuration.run.batch, 0.0);
  world_.as(&node_, [&] {
    ros::Publisher& publisher = publishers_[topic];
    if (!publisher) publisher = ros::NodeHandle(kNamespace).advertise<stochastic_platoon::Position>(topic, 0);
    publisher.publish(message);
  });
}

}  // namespace platoon::simulation
