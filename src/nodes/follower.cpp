// One follower. Parameters: ~index, i of vehicle_<i>, 1 or more; ~kept, whether it is to outlive launches (true). It
// outlives runs: without a run that has a vehicle of its index, it waits for one.

#include "stochastic_platoon/ros/nodes/follower.hpp"

#include "stochastic_platoon/ros/hosting/receiving_thread.hpp"
#include "stochastic_platoon/ros/hosting/run_component.hpp"

namespace {

std::uint32_t read_index() {
  int index = 0;
  const bool given = ros::NodeHandle("~").getParam("index", index);
  if (given && index >= 1) return static_cast<std::uint32_t>(index);
  throw platoon::ConfigurationError(
      {"~index: " + (given ? std::to_string(index) : std::string("missing")) + ": must be a whole number, 1 or more"});
}

// The present run, if this vehicle can take part in it.
std::optional<platoon::Configuration> present_run(const ros::NodeHandle& platoon, std::uint32_t index) {
  try {
    std::optional<platoon::Configuration> found = platoon::read_configuration(platoon);
    if (!found || index <= found->run.followers) return found;
    ROS_WARN_STREAM("~index: " << index << ": must be a whole number from 1 to " << found->run.followers
                               << ", the number of followers of the present run: waiting for another run");
  } catch (const platoon::ConfigurationError& error) {
    ROS_WARN_STREAM("vehicle_" << index << " waits for another run: " << error.what());
  }
  return std::nullopt;
}

void run_follower(ros::NodeHandle platoon) {
  const std::uint32_t index = read_index();
  platoon::Diagnostics diagnostics(platoon);
  platoon::ReceivingThread receiving_thread;
  platoon.setCallbackQueue(&receiving_thread);
  const platoon::Follower follower(
      platoon, present_run(platoon, index), index, ros::NodeHandle("~").param("kept", true), platoon::MessagePool(),
      [](const platoon::Configuration& joined) { platoon::keep_freed_memory(joined.run, 1); });
  diagnostics.add("follower", platoon::VitalSigns(follower.sources()));
  platoon::Superseded().spin();
}

}  // namespace

// No rosout: one publisher per vehicle would cost more than the platoon.
int follower_main(int argc, char** argv) {
  return platoon::run_node(
      argc, argv,
      {"follower",
       "One follower; platoon.launch and followers.launch start it. Parameters: _index:=I, 1 or more; _kept, whether it is to\n"
       "outlive launches (true).\nExample: rosrun stochastic_platoon follower __ns:=platoon __name:=vehicle_3 _index:=3",
       ros::init_options::NoRosout},
      run_follower);
}
