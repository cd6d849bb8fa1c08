#include "stochastic_platoon/ros/observation/markers.hpp"

#include "stochastic_platoon/ros/hosting/run_component.hpp"

namespace {

void run_markers(const ros::NodeHandle& platoon, const platoon::Configuration& configuration,
                 platoon::Superseded& superseded) {
  const platoon::Markers markers(platoon, configuration, superseded.join());
  superseded.spin();
}

}  // namespace

int markers_main(int argc, char** argv) {
  return platoon::run_component(
      argc, argv,
      {"markers",
       "Draws the platoon in RViz: platoon.launch rviz:=true starts it.\nExample: rosrun stochastic_platoon markers __ns:=platoon"},
      run_markers);
}
