#include "stochastic_platoon/ros/nodes/leader.hpp"

#include "stochastic_platoon/ros/hosting/run_component.hpp"

namespace {

void run_leader(const ros::NodeHandle& platoon, const platoon::Configuration& configuration,
                platoon::Superseded& superseded) {
  const platoon::Leader leader(platoon, configuration, superseded.join());
  platoon::Diagnostics diagnostics(platoon);
  diagnostics.add("leader", leader.status());
  superseded.spin();
}

}  // namespace

int leader_main(int argc, char** argv) {
  return platoon::run_component(
      argc, argv,
      {"leader",
       "Vehicle 0, the only clock of the platoon. platoon.launch starts it.\nExample: rosrun stochastic_platoon leader __ns:=platoon __name:=vehicle_0"},
      run_leader);
}
