#include "stochastic_platoon/graph/all_channels.hpp"
#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "channel", 0, [](const ros::NodeHandle& node) {
    const platoon::AllChannels channels(node, platoon::read_configuration(node));
    platoon::spin();
  });
}
