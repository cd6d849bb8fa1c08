#pragma once

#include <ros/node_handle.h>
#include <std_msgs/Float64.h>
#include <std_srvs/Trigger.h>

#include <functional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/manoeuvre.hpp"

namespace platoon {

/// The leader's interface for orders (see Manoeuvre). Impossible orders are rejected with an explanation, and the run
/// continues.
///
/// Subscribes: leader/speed (std_msgs/Float64) [m/s]. Services (std_srvs/Trigger): leader/brake, leader/accelerate,
/// leader/sinusoid, and leader/cruise, which ends a manoeuvre.
class LeaderOrders {
public:
  /// `of_leader` returns the manoeuvre of the leader, or throws std::exception with the reason if it takes no orders.
  LeaderOrders(ros::NodeHandle platoon, std::function<Manoeuvre&()> of_leader);

private:
  /// Gives an order and returns a description of its effect. Throws std::invalid_argument for an impossible order.
  using Order = std::function<std::string(Manoeuvre&)>;

  void advertise(ros::NodeHandle platoon, const std::string& service, const Order& order);
  void receive_speed(const std_msgs::Float64::ConstPtr& message);

  std::function<Manoeuvre&()> manoeuvre_;
  std::vector<ros::ServiceServer> services_;
  ros::Subscriber speed_;
};

}  // namespace platoon
