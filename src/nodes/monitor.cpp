#include "stochastic_platoon/graph/monitor.hpp"

#include "stochastic_platoon/graph/run_component.hpp"

namespace {

void run(const ros::NodeHandle& node, const platoon::Configuration& configuration) {
  platoon::Monitor monitor(node, configuration);
  platoon::spin();
  monitor.stop();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "monitor", 0, run);
}
