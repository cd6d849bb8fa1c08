// The recorder with the channels beside it: every position passes through the channels anyway, so that of the
// 2 N + 1 recorded topics only the last vehicle's crosses a socket for the recorder.

#include "stochastic_platoon/graph/recorder.hpp"

#include "stochastic_platoon/graph/channel.hpp"
#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/receiving_thread.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "recorder", 0, [](const ros::NodeHandle& node) {
    const platoon::Configuration configuration = platoon::read_configuration(node);
    platoon::Recorder recorder(node, configuration);
    platoon::ReceivingThread receiving_thread;
    ros::NodeHandle channel_node(node);
    channel_node.setCallbackQueue(&receiving_thread);
    const platoon::Channel channel(channel_node, configuration, 1,
                                   static_cast<std::uint32_t>(configuration.run.followers));
    ros::spin();
    recorder.stop();
  });
}
