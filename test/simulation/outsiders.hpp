#pragma once

#include <ros/node_handle.h>
#include <std_srvs/TriggerResponse.h>
#include <stochastic_platoon/Progress.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "simulation/process.hpp"

namespace platoon::simulation {

/// The node that ends a launch: waits until every receiver has finished, as until_complete does.
class Observer {
public:
  Observer(World& world, const Configuration& configuration);

  bool complete() const;
  /// Whether the monitor has reported, after a time [s], that it has received this step of an endless run.
  bool has(std::uint64_t run, std::int64_t step, double since) const {
    return latest_.run == run && latest_.step >= step && heard_ > since;
  }

private:
  void receive(const stochastic_platoon::Progress::ConstPtr& message);

  Node node_;
  std::uint64_t run_;
  std::map<std::string, bool> finished_;
  stochastic_platoon::Progress latest_;  ///< of the monitor's reports
  double heard_ = 0.0;                   ///< [s] its arrival
  ros::Subscriber progress_;
};

/// The person at a running platoon, and the node that transmits the orders.
class Operator {
public:
  /// Called when a service has answered.
  using Answered = std::function<void(const std::string& service, const std_srvs::TriggerResponse& response)>;

  Operator(World& world, Answered answered);

  /// Calls change_run with a random headway, variance of noise, or loss.
  void change_run(std::uint32_t which, double extent);

  /// Calls one of the leader's services, or publishes a speed for it. Returns what.
  std::string drive(std::uint32_t which, double extent);

private:
  void call(const std::string& service);

  World& world_;
  Node node_;
  Answered answered_;
  ros::Publisher speed_;
};

/// A node that publishes positions of another run on the platoon's topics.
class Stranger {
public:
  explicit Stranger(World& world) : world_(world), node_(world, "/stranger") {}

  void publish(const Configuration& configuration, std::uint32_t which, double extent);

private:
  World& world_;
  Node node_;
  std::map<std::string, ros::Publisher> publishers_;
};

}  // namespace platoon::simulation
