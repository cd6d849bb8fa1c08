#pragma once

#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstdint>
#include <string>
#include <vector>

namespace platoon {

/// One vehicle on the road: x [m] along the road, 0 for the leader.
struct SceneVehicle {
  double x;
  double place;      ///< [m] desired position, by its tracking error; NaN: none
  double deviation;  ///< [m] standard deviation of its tracking error by theory; NaN: none
  bool closing;      ///< whether the gap in front of it closes
  std::string label;
};

/// The RViz markers of a platoon. `travelled`: distance that the leader has driven [m], which fixes the markings to the
/// road.
visualization_msgs::MarkerArray road_scene(const std::vector<SceneVehicle>& vehicles, double travelled,
                                           const ros::Time& time);

}  // namespace platoon
