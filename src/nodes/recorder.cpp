#include "stochastic_platoon/graph/recorder.hpp"

#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "recorder", 0, [](const ros::NodeHandle& node) {
    platoon::Recorder recorder(node, platoon::read_configuration(node));
    ros::spin();
    recorder.stop();
  });
}
