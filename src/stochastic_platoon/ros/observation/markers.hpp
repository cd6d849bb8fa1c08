#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Snapshot.h>

#include <vector>

#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// Shows one realization of the platoon in RViz: a road and the vehicles, dark blue for the first follower to dark red
/// for the last as in the paper's figures. The front of each vehicle is at its position; points are drawn 3 m long. It
/// has its tracking error above it, and on the road its desired position plus and minus two standard deviations by
/// theory. A closing gap between two vehicles is red. A new viewer first deletes what an earlier run has left. Costs
/// the platoon one subscription.
///
/// Subscribes: snapshot (stochastic_platoon/Snapshot). Publishes: markers (visualization_msgs/MarkerArray) in the frame
/// "platoon", whose origin is the leader, and /tf: "platoon" -> "vehicle_0" .. "vehicle_N", at their fronts, and, at
/// the end of the string, "platoon_tail".
class Markers {
public:
  /// `superseded` is called with the configuration that replaces the present one.
  Markers(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded);

private:
  void receive(const stochastic_platoon::Snapshot::ConstPtr& message);
  void publish_frames(const stochastic_platoon::Snapshot& snapshot, const ros::Time& time);

  RunMembership membership_;
  RunOptions run_;
  std::vector<double> variance_;                       ///< [m^2] by theory, one per cell of the run; NaN without theory
  std::vector<double> lengths_;                        ///< [m] of vehicles 0 .. N
  std::vector<std::vector<std::size_t>> far_sources_;  ///< per vehicle, those that it hears across others
  double tail_ = 0.0;                                  ///< [m] behind the leader, smoothed
  ros::Publisher markers_;
  ros::Publisher frames_;
  ros::Subscriber snapshots_;
};

}  // namespace platoon
