// Vehicle ~index of the present run as an external vehicle: the model's own vehicle behind platoon::ExternalVehicle, so
// that its run must have the bits of one without it. For a single batch of realizations from 0 on.

#include <ros/ros.h>
#include <stochastic_platoon/external_vehicle.hpp>

#include <optional>

#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "external_by_model");
  const auto index = static_cast<std::uint32_t>(ros::NodeHandle("~").param("index", 0));
  const ros::NodeHandle in_platoon("platoon");
  std::optional<platoon::FollowerVehicle> own;
  const platoon::ExternalVehicle vehicle(
      in_platoon, index,
      [&](std::vector<double>& position) {
        std::string text;
        in_platoon.getParam("configuration", text);
        const platoon::Configuration configuration = platoon::parse_configuration(text);
        own.emplace(configuration.model, platoon::WhiteNoise(configuration.run.seed), index);
        own->start(0, position.size(), position);
        const double place = platoon::vehicle_settings(in_platoon, index).initial_position;
        if (std::abs(position.front() - place) > 1e-9)
          ROS_FATAL("starts at %.12g, not at %.12g", position.front(), place);
      },
      [&](const std::vector<std::vector<double>>& received, std::vector<double>& position, std::vector<double>& input) {
        platoon::FollowerVehicle::Received all;
        for (const std::vector<double>& values : received) all.push_back(values.data());
        own->step(all, position.data(), input.data());
      });
  ros::spin();
}
