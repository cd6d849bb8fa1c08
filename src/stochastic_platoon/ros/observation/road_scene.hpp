#pragma once

#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace platoon {

/// One vehicle on the road: its front is at x [m] along the road, 0 for the leader.
struct SceneVehicle {
  double x;
  double length;     ///< [m]; 0: a point, drawn with a length of its own
  double place;      ///< [m] desired position, by its tracking error; NaN: none
  double deviation;  ///< [m] standard deviation of its tracking error by theory; NaN: none
  bool closing;      ///< whether the gap in front of it closes
  std::string label;
  std::vector<std::size_t> hears = {};  ///< vehicles further ahead than its predecessor, drawn as arcs from there
};

/// Whether a gap [m] is below half of its desired value, by the tracking error [m].
bool is_closing(double gap, double error);

/// The RViz markers of a platoon. `travelled`: distance that the leader has driven [m], which fixes the markings to the
/// road.
visualization_msgs::MarkerArray road_scene(const std::vector<SceneVehicle>& vehicles, double travelled,
                                           const ros::Time& time);

}  // namespace platoon
