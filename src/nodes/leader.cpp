#include "stochastic_platoon/graph/leader.hpp"

#include "stochastic_platoon/graph/run_component.hpp"

namespace {

void run(const ros::NodeHandle& node, const platoon::Configuration& configuration) {
  const platoon::Leader leader(node, configuration);
  platoon::spin();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "leader", 0, run);
}
