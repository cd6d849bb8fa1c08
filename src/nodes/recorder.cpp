// The recorder with the channels beside it: every position passes through the channels anyway, so that of the
// 2 N + 1 recorded topics only the last vehicle's crosses a socket for the recorder.

#include "stochastic_platoon/graph/recorder.hpp"

#include "stochastic_platoon/graph/all_channels.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

namespace {

void run(const ros::NodeHandle& node, const platoon::Configuration& configuration) {
  platoon::Recorder recorder(node, configuration);
  const platoon::AllChannels channels(node, configuration);
  platoon::spin();
  recorder.stop();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "recorder", 0, run);
}
