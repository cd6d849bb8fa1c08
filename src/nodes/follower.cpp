#include "stochastic_platoon/graph/follower.hpp"

#include "stochastic_platoon/graph/receiving_thread.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

namespace {

// Private parameter ~index: i of vehicle_<i>, 1 .. N.
std::uint32_t read_index(std::size_t followers) {
  int index = 0;
  const bool given = ros::NodeHandle("~").getParam("index", index);
  if (given && index >= 1 && static_cast<std::size_t>(index) <= followers)
    return static_cast<std::uint32_t>(index);
  throw platoon::ConfigurationError({"~index: " + (given ? std::to_string(index) : std::string("missing")) +
                                     ": must be a whole number from 1 to " + std::to_string(followers) +
                                     ", the number of followers"});
}

void run(ros::NodeHandle node, const platoon::Configuration& configuration) {
  platoon::ReceivingThread receiving_thread;
  node.setCallbackQueue(&receiving_thread);
  const platoon::Follower follower(node, configuration, read_index(configuration.run.followers),
                                   platoon::MessagePool());
  platoon::spin();
}

}  // namespace

// No rosout: with one publisher per vehicle it would cost more than the platoon.
int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "follower", ros::init_options::NoRosout, run);
}
