#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>
#include <stochastic_platoon/Progress.h>

#include <map>
#include <optional>
#include <set>
#include <string>

#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/ros/messages/message_pool.hpp"
#include "stochastic_platoon/ros/observation/diagnostics.hpp"
#include "stochastic_platoon/ros/orders/leader_orders.hpp"
#include "stochastic_platoon/ros/transport/notice_senders.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/sole_publisher.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/credit.hpp"

namespace platoon {

/// Vehicle 0 as a ROS component: the closed loop behind the virtual leader, and the platoon's only clock. It publishes
/// a step when the receivers' progress gives it credit, at most `rate` steps per second, and repeats a batch that
/// stalls. It may outlive runs of the same pace.
///
/// In an endless run it executes orders: see LeaderOrders. A manoeuvre ends with its attempt.
///
/// Subscribes: progress (stochastic_platoon/Progress) and the topic of LeaderOrders. Publishes: vehicle_0/position
/// and, to a vehicle_1 with a radio, vehicle_0/input (stochastic_platoon/Position).
class Leader {
public:
  /// `superseded` is called with the configuration that replaces the present one, if batch size, rate or receivers
  /// differ, or if the string has radios now or had some before.
  Leader(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded);

  /// Status: messages published, and credit.
  Diagnostics::Fill status() const;

private:
  bool begin(const Configuration& configuration);
  Manoeuvre& manoeuvre();
  using ProgressEvent = ros::MessageEvent<const stochastic_platoon::Progress>;
  void receive(const ProgressEvent& event);
  void receive_notice(const ProgressEvent& event);
  void watch();
  void publish_allowed();
  bool publish_one();
  void send(const ros::Publisher& topic, const MessageId& id, double value);

  /// State within one run.
  struct RunState {
    Credit credit;
    LeaderVehicle vehicle;
    ros::Duration period;
    bool waits_for_observers;
    std::map<std::string, SolePublisher> reporters;  ///< by receiver
    std::set<std::string> holding = {};              ///< receivers that report BLOCKED
    ros::Time stamp = {};                            ///< of the latest step published; zero before the first
    std::optional<double> begin = {};                ///< [s] earliest time of a step
  };

  ros::NodeHandle platoon_;
  RunOptions run_;
  BatchSchedule schedule_;
  bool paced_;
  RunMembership::Join superseded_;
  RunMembership membership_;
  std::optional<RunState> run_state_;
  NoticeSenders notice_senders_;
  MessagePool messages_;
  MessageCounter published_;
  RelaxedAtomic<std::int64_t> window_, unacknowledged_;  ///< steps
  ros::Publisher position_;
  std::optional<ros::Publisher> input_;  ///< to a vehicle_1 with a radio
  ros::Subscriber progress_;
  ros::SteadyTimer stall_timer_;
  ros::SteadyTimer pace_timer_;
  LeaderOrders orders_;
};

}  // namespace platoon
