#pragma once

#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstdint>
#include <string>
#include <vector>

namespace platoon {

/// One vehicle on the road: x [m] along it, the leader's being 0.
struct SceneVehicle {
  double x;
  double place;      ///< [m] where it should be by its tracking error; NaN: of no such place
  double deviation;  ///< [m] of its tracking error by theory; NaN where there is none
  bool closing;      ///< whether the gap in front of it closes
  std::string label;
};

/// What RViz is to show of a platoon. `travelled` is how far the leader has come [m]: the road's markings stand still.
visualization_msgs::MarkerArray road_scene(const std::vector<SceneVehicle>& vehicles, double travelled,
                                           const ros::Time& time);

}  // namespace platoon
