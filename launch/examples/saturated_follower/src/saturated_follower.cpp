// The paper's vehicle with an actuator that saturates, abs(u) <= limit; there is no theory for it. Parameters: ~index
// (i of vehicle_<i>), ~limit [m per sample period squared]. Headway and standstill distance are those of the run.

#include <ros/ros.h>
#include <stochastic_platoon/external_vehicle.hpp>

#include <algorithm>
#include <vector>

namespace {

/// G(z) = 1 / (z - 1)^2 behind K(z) = 1.35 z / (z + 0.89) / (1 + h), for a batch of realizations.
struct Dynamics {
  double limit;
  platoon::VehicleSettings of_run;
  std::vector<double> y, y_before, u, demanded;

  void start(const platoon::VehicleSettings& settings, std::vector<double>& position) {
    of_run = settings;
    position.assign(position.size(), settings.initial_position);
    y = y_before = position;
    for (double& before : y_before) before -= settings.initial_speed * settings.sample_period;
    u.assign(position.size(), 0.0);
    demanded = u;
  }

  void move(const std::vector<double>& received, std::vector<double>& position) {
    const double headway = of_run.headway;
    for (std::size_t r = 0; r < received.size(); ++r) {
      const double error = received[r] - y[r] - of_run.standstill_distance - headway * (y[r] - y_before[r]);
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
  ros::init(argc, argv, "saturated_follower");  // not anonymous: within a run the topic belongs to this name
  const ros::NodeHandle own("~");
  const int index = own.param("index", 0);
  if (index < 1) {
    ROS_FATAL("~index: %d: must be the number of the vehicle, 1 or more", index);
    return 1;
  }
  const auto number = static_cast<std::size_t>(index);
  const ros::NodeHandle in_platoon("platoon");
  Dynamics dynamics{own.param("limit", 1.0), {}, {}, {}, {}, {}};
  const platoon::ExternalVehicle vehicle(
      in_platoon, number,
      [&](std::vector<double>& position) { dynamics.start(platoon::vehicle_settings(in_platoon, number), position); },
      [&](const std::vector<double>& received, std::vector<double>& position) { dynamics.move(received, position); });
  ros::spin();
}
