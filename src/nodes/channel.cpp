#include "stochastic_platoon/graph/channel.hpp"

#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/receiving_thread.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "channel", 0, [](ros::NodeHandle node) {
    platoon::ReceivingThread receiving_thread;
    node.setCallbackQueue(&receiving_thread);
    const platoon::Configuration configuration = platoon::read_configuration(node);
    const platoon::Channel channel(node, configuration, 1,
                                   static_cast<std::uint32_t>(configuration.run.followers));
    ros::spin();
  });
}
