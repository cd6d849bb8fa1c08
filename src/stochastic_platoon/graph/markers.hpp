#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <vector>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/graph/run_membership.hpp"
#include "stochastic_platoon/model/tracking_error.hpp"

namespace platoon {

/// The platoon for RViz: a box per vehicle at its position behind the leader, dark blue for the first
/// follower to dark red for the last as in the paper's figures, with its tracking error beside it. Shows the
/// first realization of the latest messages; a spectator, that may miss some.
///
/// Subscribes: vehicle_<i>/position (stochastic_platoon/Position). Publishes: markers
/// (visualization_msgs/MarkerArray) in the frame "platoon".
class Markers {
public:
  /// `superseded` is called with a configuration that has taken the present one's place.
  Markers(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded);

private:
  struct Vehicle {
    double position = 0.0;  ///< [m]
    double before = 0.0;    ///< [m] one step earlier
    bool seen = false;
  };
  void receive(std::size_t vehicle, const stochastic_platoon::Position::ConstPtr& message);
  void publish() const;

  RunMembership membership_;
  std::vector<TrackingError> error_;  ///< of every follower
  std::vector<Vehicle> vehicles_;
  ros::Publisher markers_;
  std::vector<ros::Subscriber> positions_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
