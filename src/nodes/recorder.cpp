// The recorder with the channels beside it: every position passes through the channels anyway, so that of the
// 2 N + 1 recorded topics only the last vehicle's crosses a socket for the recorder.

#include "stochastic_platoon/graph/recorder.hpp"

#include "stochastic_platoon/graph/all_channels.hpp"
#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "recorder", 0, [](const ros::NodeHandle& node) {
    const platoon::Configuration configuration = platoon::read_configuration(node);
    platoon::Recorder recorder(node, configuration);
    const platoon::AllChannels channels(node, configuration);
    platoon::spin();
    recorder.stop();
  });
}
