#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Snapshot.h>

#include <vector>

#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// The platoon for RViz: a road, a vehicle per position, dark blue for the first follower to dark red for the last as
/// in the paper's figures, its tracking error above it, and on the road the place that it should be at, plus and minus
/// two standard deviations by theory. Red between two vehicles whose gap closes. A spectator of one realization, that
/// costs the platoon one subscription.
///
/// Subscribes: snapshot (stochastic_platoon/Snapshot). Publishes: markers (visualization_msgs/MarkerArray) in the frame
/// "platoon", whose origin is the leader, and /tf: "platoon" -> "vehicle_0" .. "vehicle_N" and, where the string ends,
/// "platoon_tail".
class Markers {
public:
  /// `superseded` is called with a configuration that has taken the present one's place.
  Markers(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded);

private:
  void receive(const stochastic_platoon::Snapshot::ConstPtr& message);
  void publish_frames(const stochastic_platoon::Snapshot& snapshot, const ros::Time& time);

  RunMembership membership_;
  RunOptions run_;
  std::vector<double> variance_;  ///< [m^2] by theory, a cell for each of the run's; NaN where there is none
  double tail_ = 0.0;             ///< [m] behind the leader, smoothed
  ros::Publisher markers_;
  ros::Publisher frames_;
  ros::Subscriber snapshots_;
};

}  // namespace platoon
