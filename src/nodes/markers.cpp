#include "stochastic_platoon/graph/markers.hpp"

#include "stochastic_platoon/graph/run_component.hpp"

namespace {

void run(const ros::NodeHandle& node, const platoon::Configuration& configuration) {
  const platoon::Markers markers(node, configuration);
  platoon::spin();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "markers", 0, run);
}
