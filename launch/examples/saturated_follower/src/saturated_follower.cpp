// The paper's vehicle behind an actuator that saturates, abs(u) <= limit: no theory speaks of it. Parameters: ~index
// (i of vehicle_<i>), ~limit [m per sample period squared], ~headway [sample periods].

#include <ros/ros.h>
#include <stochastic_platoon/external_vehicle.hpp>

#include <algorithm>
#include <vector>

namespace {

/// G(z) = 1 / (z - 1)^2 behind K(z) = 1.35 z / (z + 0.89) / (1 + h), for a batch of realizations.
struct Dynamics {
  double limit, headway;
  std::vector<double> y, y_before, u, demanded;

  void start(std::vector<double>& position) {
    y = y_before = position;  // zero: it stands behind a leader without standstill distance
    u = demanded = position;
  }

  void move(const std::vector<double>& received, std::vector<double>& position) {
    for (std::size_t r = 0; r < received.size(); ++r) {
      const double error = received[r] - y[r] - headway * (y[r] - y_before[r]);
      const double next = 2.0 * y[r] - y_before[r] + u[r];
      demanded[r] = -0.89 * demanded[r] + 1.35 / (1.0 + headway) * error;
      u[r] = std::clamp(demanded[r], -limit, limit);
      y_before[r] = y[r];
      position[r] = y[r] = next;
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "saturated_follower");  // not anonymous: within a run the topic is this name's
  const ros::NodeHandle own("~");
  const int index = own.param("index", 0);
  if (index < 1) {
    ROS_FATAL("~index: %d: must be the number of the vehicle, 1 or more", index);
    return 1;
  }
  Dynamics dynamics{own.param("limit", 1.0), own.param("headway", 3.2), {}, {}, {}, {}};
  const platoon::ExternalVehicle vehicle(
      ros::NodeHandle("platoon"), static_cast<std::size_t>(index),
      [&](std::vector<double>& position) { dynamics.start(position); },
      [&](const std::vector<double>& received, std::vector<double>& position) { dynamics.move(received, position); });
  ros::spin();
}
