#include "stochastic_platoon/graph/all_channels.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

namespace {

void run(const ros::NodeHandle& node, const platoon::Configuration& configuration) {
  const platoon::AllChannels channels(node, configuration);
  platoon::spin();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "channel", 0, run);
}
