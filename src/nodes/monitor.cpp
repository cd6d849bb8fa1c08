#include "stochastic_platoon/graph/monitor.hpp"

#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "monitor", 0, [](const ros::NodeHandle& node) {
    platoon::Monitor monitor(node, platoon::read_configuration(node));
    platoon::spin();
    monitor.stop();
  });
}
