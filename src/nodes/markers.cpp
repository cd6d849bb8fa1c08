#include "stochastic_platoon/graph/markers.hpp"

#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "markers", 0, [](const ros::NodeHandle& node) {
    const platoon::Markers markers(node, platoon::read_configuration(node));
    platoon::spin();
  });
}
